//! Elementary functions with the same bits on every processor, by the names that NumPy has for them.
//!
//! A system's own library takes other ways on processors with fused multiply-add, and each system has another one.

/// A function of one variable.
pub fn of_one(name: &str) -> Option<fn(f64) -> f64> {
    Some(match name {
        "exp" => libm::exp,
        "exp2" => libm::exp2,
        "expm1" => libm::expm1,
        "log" => libm::log,
        "log2" => libm::log2,
        "log10" => libm::log10,
        "log1p" => libm::log1p,
        "sin" => libm::sin,
        "cos" => libm::cos,
        "tan" => libm::tan,
        "arcsin" => libm::asin,
        "arccos" => libm::acos,
        "arctan" => libm::atan,
        "sinh" => libm::sinh,
        "cosh" => libm::cosh,
        "tanh" => libm::tanh,
        "arcsinh" => libm::asinh,
        "arccosh" => libm::acosh,
        "arctanh" => libm::atanh,
        "cbrt" => libm::cbrt,
        _ => return None,
    })
}

/// A function of two variables.
pub fn of_two(name: &str) -> Option<fn(f64, f64) -> f64> {
    Some(match name {
        "arctan2" => libm::atan2,
        "hypot" => libm::hypot,
        "power" => libm::pow,
        _ => return None,
    })
}
