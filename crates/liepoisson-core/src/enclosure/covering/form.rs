//! What a certificate must look like, and what is true of its system exactly.

use super::{Certificate, Check, Place, Refusal, Settings};
use crate::enclosure::chart::Frame;
use crate::enclosure::interval::Interval;
use crate::enclosure::matrix::IntervalVector;
use crate::enclosure::polynomial::{Sign, commutes};
use crate::enclosure::rational::Rational;

fn require(is_so: bool, check: Check, place: Place, wanted: &'static str) -> Result<(), Refusal> {
    if is_so { Ok(()) } else { Err(Refusal::new(check, place, wanted)) }
}

/// Shapes and finite numbers.
pub(super) fn shapes(certificate: &Certificate, settings: &Settings) -> Result<(), Refusal> {
    let everywhere = |is_so, wanted| require(is_so, Check::Form, Place::Everywhere, wanted);
    let (n, n_constants) = (certificate.field.len(), certificate.constants.len());
    let polynomials = certificate.field.iter().chain(&certificate.constants);
    everywhere(
        n > 0 && polynomials.into_iter().all(|polynomial| polynomial.n_variables() == n),
        "polynomials of as many variables as there are rates of change",
    )?;
    everywhere(certificate.level.len() == n_constants, "a value for each constant of motion")?;
    let signs = std::iter::once(&certificate.symmetry).chain(&certificate.reversers);
    everywhere(signs.into_iter().all(|signs| signs.len() == n), "a sign for each component")?;
    let n_unstable = certificate.n_unstable;
    everywhere(
        n_unstable > 0 && n > n_unstable + 1 + n_constants,
        "unstable and stable directions, the flow, and constants, as many as components together",
    )?;
    let is_positive = |value: f64| value > 0.0 && value.is_finite();
    everywhere(
        is_positive(settings.step) && is_positive(settings.reach) && is_positive(settings.near),
        "a positive step, reach and time near the middle set",
    )?;
    everywhere(settings.small > 0.0 && settings.small < 1.0, "a factor of the smaller sets between 0 and 1")?;
    everywhere((2..=64).contains(&settings.order), "an order from 2 to 64")?;
    everywhere(settings.level_radius >= Rational::ZERO, "a radius of levels that is not negative")?;
    everywhere(!certificate.sets.is_empty(), "sets")?;
    for (number, set) in certificate.sets.iter().enumerate() {
        let of_set = |is_so, wanted| require(is_so, Check::Form, Place::Set(number), wanted);
        let is_square = set.frame.n_rows() == n && set.frame.n_columns() == n;
        of_set(set.center.len() == n && is_square, "a center and a square frame")?;
        let mut numbers = set.center.iter().chain(set.frame.entries());
        of_set(numbers.all(|number| number.is_finite()), "finite numbers")?;
    }
    Ok(())
}

/// Identities of polynomials with rational coefficients.
pub(super) fn identities(certificate: &Certificate) -> Result<(), Refusal> {
    let everywhere = |is_so, check, wanted| require(is_so, check, Place::Everywhere, wanted);
    let field = &certificate.field;
    for constant in &certificate.constants {
        let is_constant = constant.along(field).is_some_and(|derivative| derivative.is_zero());
        everywhere(is_constant, Check::Constants, "functions that are constant along orbits")?;
    }
    let keeps = |signs: &[Sign]| certificate.constants.iter().all(|constant| constant.with_signs(signs) == *constant);
    let symmetry = &certificate.symmetry;
    everywhere(
        commutes(field, symmetry, false) && keeps(symmetry) && symmetry.contains(&Sign::Minus),
        Check::Symmetry,
        "a reflection that maps orbits to orbits on the same level",
    )?;
    let is_reverser = |signs: &Vec<Sign>| commutes(field, signs, true) && keeps(signs);
    everywhere(
        !certificate.reversers.is_empty() && certificate.reversers.iter().all(is_reverser),
        Check::Reversers,
        "reflections that map orbits to orbits run backwards on the same level",
    )
}

/// The frames of the sets.
pub(super) fn frames(certificate: &Certificate) -> Result<Vec<Frame>, Refusal> {
    let n_constants = certificate.constants.len();
    let frame = |(number, set): (usize, &super::CoveringSet)| {
        Frame::new(&set.center, set.frame.clone(), certificate.n_unstable, n_constants)
            .map_err(|failure| Refusal::failed(Check::Frame, Place::Set(number), failure))
    };
    certificate.sets.iter().enumerate().map(frame).collect()
}

/// Enclosures of the values of the constants, with a radius; the first one is moved by `shift`.
pub(super) fn level(certificate: &Certificate, radius: Rational, shift: Rational) -> Result<IntervalVector, Refusal> {
    let radius = radius.enclosure().hi();
    let value = |(number, value): (usize, &Rational)| {
        let value = if number == 0 { value.plus(shift) } else { Some(*value) };
        value.map(|value| value.enclosure() + Interval::symmetric(radius))
    };
    let values: Option<IntervalVector> = certificate.level.iter().enumerate().map(value).collect();
    values.ok_or(Refusal::new(Check::Form, Place::Everywhere, "values of the constants of at most 38 digits"))
}
