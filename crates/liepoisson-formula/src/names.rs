//! Names that formulas keep for themselves, and hints for those that others use.

/// Functions of one scalar.
pub(super) const ELEMENTARY: [&str; 12] =
    ["sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "asin", "acos", "atan"];

/// Functions of vectors and matrices.
pub(super) const OF_MATRICES: [&str; 7] = ["dot", "cross", "norm", "diag", "inv", "transpose", "trace"];

/// The angle of a pair, which jumps: for functions of sections and figures, not for Hamiltonians.
pub(super) const ANGLE: &str = "atan2";

/// The one constant.
pub(super) const PI: &str = "pi";

/// Characters of the longest name.
pub(super) const MAX_NAME: usize = 100;

const NOT_SMOOTH: &str = " abs fabs sign sgn min max floor ceil ceiling round trunc int frac fract mod fmod heaviside step theta \
                          piecewise where if relu delta dirac diracdelta ";

const GREEK: [&str; 25] = [
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu", "xi",
    "omicron", "pi", "rho", "sigma", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega",
];

/// All functions, as a message lists them.
pub(super) fn functions() -> impl Iterator<Item = &'static str> {
    OF_MATRICES.into_iter().chain(ELEMENTARY).chain([ANGLE])
}

/// Whether formulas keep the name for themselves.
pub(super) fn is_reserved(name: &str) -> bool {
    name == PI || functions().any(|function| function == name)
}

/// Whether a name is that of a function without derivatives.
pub(super) fn is_not_smooth(name: &str) -> bool {
    NOT_SMOOTH.contains(&format!(" {} ", name.to_lowercase()))
}

/// Whether a text consists of letters, digits and `_` of ASCII, and does not begin with a digit.
pub(super) fn is_identifier(name: &str) -> bool {
    let is_letter = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_';
    name.bytes().all(is_letter) && name.bytes().next().is_some_and(|first| !first.is_ascii_digit())
}

/// What to write for a function of another name.
pub(super) fn function_instead(name: &str) -> Option<&'static str> {
    Some(match name.to_lowercase().as_str() {
        "ln" => "log(x)",
        "pow" => "x^y",
        "arcsin" => "asin(x)",
        "arccos" => "acos(x)",
        "arctan" => "atan(x)",
        "sec" => "1/cos(x)",
        "csc" => "1/sin(x)",
        "cot" => "cos(x)/sin(x)",
        "inverse" => "inv(M)",
        _ => return None,
    })
}

/// What is said of a constant that formulas do not have.
pub(super) fn constant_instead(name: &str) -> Option<&'static str> {
    Some(match name {
        "e" | "E" => "Euler's number is exp(1)",
        "Pi" | "PI" => "The constant is pi",
        "oo" | "inf" => "Formulas are finite",
        "i" | "I" | "j" => "Formulas are real",
        _ => return None,
    })
}

/// What to write for a character that has no meaning.
pub(super) fn character_instead(character: char) -> String {
    for (first, is_capital) in [('α', false), ('Α', true)] {
        let index = (character as usize).wrapping_sub(first as usize);
        if let Some(&name) = GREEK.get(index) {
            let (head, tail) = name.split_at(1);
            let head = if is_capital { head.to_uppercase() } else { head.to_owned() };
            return format!("Names are written in ASCII: {head}{tail}");
        }
    }
    match character {
        '.' => "A dot is no operator here: a component is l[1], a scalar product dot(u, v)",
        '=' => "Write one expression, without '='",
        '\'' | '"' => "Text in quotes has no place in a formula",
        '·' | '⋅' => "Write * between numbers and dot(u, v) for vectors",
        '×' => "Write * between numbers and cross(u, v) for vectors",
        '∧' => "Write cross(u, v)",
        '−' | '–' => "Write the minus sign as -",
        '²' => "Write ^2",
        '³' => "Write ^3",
        '√' => "Write sqrt(x)",
        '|' => "Write norm(v) or dot(v, v) for the length of a vector",
        '{' | '}' => "Use ( and )",
        '\\' => "Write names without a backslash: alpha, sqrt(x)",
        'ϵ' => "Write epsilon",
        'ϑ' => "Write theta",
        'ϕ' => "Write phi",
        'ℓ' => "Write l",
        _ => "Use numbers, names, + - * / ^, brackets and functions",
    }
    .to_owned()
}

/// A text in quotes, as Python writes it.
pub(super) fn quoted(text: &str) -> String {
    let quote = if text.contains('\'') && !text.contains('"') { '"' } else { '\'' };
    let mut shown = String::from(quote);
    for character in text.chars() {
        match character {
            '\n' => shown.push_str("\\n"),
            '\t' => shown.push_str("\\t"),
            '\r' => shown.push_str("\\r"),
            '\\' => shown.push_str("\\\\"),
            _ if character == quote => shown.extend(['\\', quote]),
            _ if (character as u32) < 0x20 || character as u32 == 0x7f => {
                shown.push_str(&format!("\\x{:02x}", character as u32));
            }
            _ => shown.push(character),
        }
    }
    shown.push(quote);
    shown
}
