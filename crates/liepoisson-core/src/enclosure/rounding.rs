//! Sums, products, quotients and square roots of doubles, rounded down and up, with the rounding mode left at nearest.
//!
//! The error of a sum is itself a double (Knuth), and so is that of a product (Dekker), unless it is near the smallest
//! numbers; the remainders of a quotient and of a square root follow from it. Their sign says on which side of the exact
//! result the rounded one lies. So an exact result is kept, and any other is moved by one unit, rarely by two, and only where
//! it must be. Where the error is not known a result is always moved. Nothing branches, since which way it goes is chance.
//!
//! Dekker's product needs no fused multiply-add: where the processor has none that the compiler may use, as in a program
//! for all x86-64, calling one in software was measured to take four times as long.
//!
//! What overflows is infinite or NaN; NaN stays NaN.
//!
//! # References
//! - D. E. Knuth, *The Art of Computer Programming* 2, 3rd ed. 1997, 4.2.2, theorem B.
//! - T. J. Dekker, *A floating-point technique for extending the available precision*, Numerische Mathematik 18 (1971) 224.
//! - S. M. Rump, P. Zimmermann, S. Boldo, G. Melquiond, *Computing predecessor and successor in rounding to nearest*,
//!   BIT 49 (2009) 419, algorithm 1.
//! - S. Boldo, *Pitfalls of a full floating-point proof: example on the formal proof of the Veltkamp/Dekker algorithms*,
//!   IJCAR 2006 (exact where `ulp(a) ulp(b)` is not below the smallest number, and nothing overflows).

/// `2^-960`: errors and remainders of products, quotients and roots above it are above the smallest numbers.
pub(super) const SMALL: f64 = f64::from_bits((1023 - 960) << 52);

/// What is missing from the rounded `sum`: `a + b - sum`, without error. NaN where `sum` is infinite.
#[inline(always)]
pub(super) fn missing_from_sum(a: f64, b: f64, sum: f64) -> f64 {
    let added = sum - a;
    (a - (sum - added)) + (b - added)
}

/// More than half the distance to the next number: `r - e` and `r + e`, rounded, lie beyond `r`.
#[inline(always)]
pub(super) fn unit(result: f64) -> f64 {
    const HALF: f64 = 0.5 * f64::EPSILON * (1.0 + f64::EPSILON);
    result.abs() * HALF + f64::MIN_POSITIVE
}

/// The sign of what is missing from a result decides; what is not known is moved.
#[inline(always)]
fn down(result: f64, missing: f64) -> f64 {
    let moved = result - unit(result);
    if missing >= 0.0 { result } else { moved }
}

#[inline(always)]
fn up(result: f64, missing: f64) -> f64 {
    let moved = result + unit(result);
    if missing <= 0.0 { result } else { moved }
}

/// A number that is not above `a + b`.
#[inline(always)]
pub fn add_down(a: f64, b: f64) -> f64 {
    let sum = a + b;
    down(sum, missing_from_sum(a, b, sum))
}

/// A number that is not below `a + b`.
#[inline(always)]
pub fn add_up(a: f64, b: f64) -> f64 {
    let sum = a + b;
    up(sum, missing_from_sum(a, b, sum))
}

/// A number as a sum of two of at most 26 digits (Veltkamp); NaN where it is too large for that.
#[inline(always)]
fn halves(a: f64) -> (f64, f64) {
    let scaled = 134_217_729.0 * a; // 2^27 + 1
    let high = scaled - (scaled - a);
    (high, a - high)
}

/// What is missing from the rounded `product`, `a b - product`, without error, if the product is above [`SMALL`] or a factor
/// is zero.
#[inline(always)]
pub(super) fn missing_from_any_product(a: f64, b: f64, product: f64) -> f64 {
    let ((a, a_low), (b, b_low)) = (halves(a), halves(b));
    (((a * b - product) + a * b_low) + a_low * b) + a_low * b_low
}

/// What is missing from the rounded `product`; NaN where that is not known.
#[inline(always)]
fn missing_from_product(a: f64, b: f64, product: f64) -> f64 {
    let is_known = (product.abs() > SMALL) | (a == 0.0) | (b == 0.0);
    let missing = missing_from_any_product(a, b, product);
    if is_known { missing } else { f64::NAN }
}

/// A number that is not above `a b`.
#[inline(always)]
pub fn mul_down(a: f64, b: f64) -> f64 {
    let product = a * b;
    down(product, missing_from_product(a, b, product))
}

/// A number that is not below `a b`.
#[inline(always)]
pub fn mul_up(a: f64, b: f64) -> f64 {
    let product = a * b;
    up(product, missing_from_product(a, b, product))
}

/// The sign of what is missing from the rounded `quotient`; NaN where that is not known.
#[inline(always)]
fn missing_from_quotient(a: f64, b: f64, quotient: f64) -> f64 {
    if quotient.abs() > SMALL && a.abs() > SMALL {
        let product = quotient * b;
        let remainder = (a - product) - missing_from_product(quotient, b, product);
        if b > 0.0 { remainder } else { -remainder }
    } else if a == 0.0 && quotient == 0.0 {
        0.0
    } else {
        f64::NAN
    }
}

/// A number that is not above `a / b`.
#[inline(always)]
pub fn div_down(a: f64, b: f64) -> f64 {
    let quotient = a / b;
    down(quotient, missing_from_quotient(a, b, quotient))
}

/// A number that is not below `a / b`.
#[inline(always)]
pub fn div_up(a: f64, b: f64) -> f64 {
    let quotient = a / b;
    up(quotient, missing_from_quotient(a, b, quotient))
}

#[inline(always)]
fn missing_from_root(a: f64, root: f64) -> f64 {
    match a {
        a if a > SMALL => {
            let square = root * root;
            (a - square) - missing_from_product(root, root, square)
        }
        0.0 => 0.0,
        _ => f64::NAN,
    }
}

/// A number that is not above the square root of `a`.
pub fn sqrt_down(a: f64) -> f64 {
    let root = a.sqrt();
    down(root, missing_from_root(a, root)).max(if a >= 0.0 { 0.0 } else { f64::NAN })
}

/// A number that is not below the square root of `a`.
pub fn sqrt_up(a: f64) -> f64 {
    let root = a.sqrt();
    up(root, missing_from_root(a, root))
}
