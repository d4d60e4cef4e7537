//! How far a function of the state can be from its value at one place, and how far errors of the state move it.
//!
//! Let `x = x_0 + u` with `|u| <= rho`, in any norm for which `|f g| <= |f| |g|` and `|1| = 1`: the largest value on an
//! interval, or the sum of the sizes of the terms of a power series. A function `g` with the power series `sum g_k u^k`
//! about `x_0` is then within `G(rho) = sum_{k>0} |g_k| rho^k` of `g(x_0)`, and a change of `x` by `delta` moves it by at
//! most `G'(rho + delta) delta`. Both are infinite, or no number, unless the series converges.

use super::functions::Functions;
use super::instruction::Instruction;

/// What is known of a function near a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    /// Its value there.
    pub value: f64,
    /// Its difference from the value, at most.
    pub rest: f64,
    /// Its own error, at most.
    pub error: f64,
}

/// How far every number of a series that is computed is from the exact result of its operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounding {
    /// As a fraction of its size.
    pub unit: f64,
    /// Besides, as numbers below the smallest and beyond the largest have no digits; zero: neither is looked at.
    pub floor: f64,
}

impl From<f64> for Rounding {
    fn from(unit: f64) -> Rounding {
        Rounding { unit, floor: 0.0 }
    }
}

impl Rounding {
    /// That of sums of products in a series of so many orders, whose step has a length.
    pub fn of_series(unit: f64, n_orders: usize, length: f64) -> Rounding {
        let (least, n) = (f64::from_bits(1), n_orders as f64);
        Rounding { unit, floor: n.powi(3) * least * length.abs().max(1.0).powi(n_orders as i32) }
    }
}

impl Functions {
    /// Encloses the first function where every component is within `rest` of that of `state`, and known up to `error`.
    /// Every number is also wrong through round-off. `work` is memory that calls share.
    pub fn enclosure(
        &self,
        state: &[f64],
        rest: f64,
        error: f64,
        rounding: impl Into<Rounding>,
        work: &mut Vec<Enclosure>,
    ) -> Enclosure {
        self.enclosure_by(state, |_| (rest, error), rounding, work)
    }

    /// The same with a `rest` and an `error` for each component.
    pub fn enclosure_by(
        &self,
        state: &[f64],
        by_component: impl Fn(usize) -> (f64, f64),
        rounding: impl Into<Rounding>,
        work: &mut Vec<Enclosure>,
    ) -> Enclosure {
        enclose(self.instructions(), state, by_component, rounding.into(), work);
        work[self.outputs()[0]]
    }
}

/// Encloses all registers, given `rest` and `error` of each component.
#[inline(always)]
pub(super) fn enclose(
    instructions: &[Instruction],
    state: &[f64],
    by_component: impl Fn(usize) -> (f64, f64),
    rounding: Rounding,
    work: &mut Vec<Enclosure>,
) {
    let unit = rounding.unit;
    let rounded = |Enclosure { value, rest, error }: Enclosure| {
        // a bound that is no number is none; of no harm unless the output depends on it
        let rest = if rest >= 0.0 { rest } else { f64::INFINITY };
        let error = error + unit * (value.abs() + rest);
        Enclosure { value, rest, error: if error >= 0.0 { error } else { f64::INFINITY } }
    };
    work.clear();
    work.extend(state.iter().enumerate().map(|(i, &value)| {
        let (rest, error) = by_component(i);
        rounded(Enclosure { value, rest, error })
    }));
    for instruction in instructions {
        let mut found = instruction.enclosure(work);
        if rounding.floor > 0.0 {
            found = instruction.at_the_ends_of_range(work, found, rounding.floor);
        }
        work.push(rounded(found));
    }
}

impl Instruction {
    fn enclosure(&self, of: &[Enclosure]) -> Enclosure {
        match *self {
            Instruction::Linear { ref terms, constant } => {
                let start = Enclosure { value: constant, rest: 0.0, error: 0.0 };
                terms.iter().fold(start, |sum, &(register, c)| {
                    let a = of[register];
                    Enclosure {
                        value: sum.value + c * a.value,
                        rest: sum.rest + c.abs() * a.rest,
                        error: sum.error + c.abs() * a.error,
                    }
                })
            }
            Instruction::Product(a, b) => product(of[a], of[b]),
            Instruction::Quotient(a, b) => product(of[a], reciprocal(of[b])),
            Instruction::Power(a, p) => power(of[a], p),
            Instruction::Sqrt(a) => power(of[a], 0.5),
            Instruction::Exp(a) => {
                let x = of[a].value;
                of[a].through(libm::exp(x), |r| growth(x, r), |r| libm::exp(x + r))
            }
            Instruction::Log(a) => {
                let x = of[a].value;
                of[a].within(x).through(libm::log(x), |r| -libm::log1p(-r / x), |r| 1.0 / (x - r))
            }
            Instruction::Sin(a) => of[a].circular(libm::sin(of[a].value), libm::cos(of[a].value)),
            Instruction::Cos(a) => of[a].circular(libm::cos(of[a].value), libm::sin(of[a].value)),
            Instruction::Sinh(a) => of[a].circular(libm::sinh(of[a].value), libm::cosh(of[a].value)),
            Instruction::Cosh(a) => of[a].circular(libm::cosh(of[a].value), libm::sinh(of[a].value)),
            Instruction::Tanh(a) => tanh(of[a]),
            Instruction::Asin(a) => of[a].arc(libm::asin(of[a].value)),
            Instruction::Acos(a) => of[a].arc(libm::acos(of[a].value)),
            Instruction::Atan(a) => {
                // atan' = Im 1/(x - i): the coefficient k of atan is at most 1/(k R^k), with the distance R from x to i
                let distance = libm::hypot(1.0, of[a].value);
                of[a].within(distance).through(
                    libm::atan(of[a].value),
                    |r| -libm::log1p(-r / distance),
                    |r| 1.0 / (distance - r),
                )
            }
        }
    }
}

/// The logarithm of a number that is beyond the largest by more than sums and round-off take away.
const BEYOND: f64 = 711.0;

/// A number that is beyond the range on all of the interval: infinite, and within nothing of it.
const INFINITE: Enclosure = Enclosure { value: f64::INFINITY, rest: 0.0, error: 0.0 };

impl Instruction {
    /// What it is as it is computed, where its numbers leave the range: one that is too small is wrong by `floor`, and the error
    /// goes on through the recursion of its series; one that is too large is known to be so on all of the interval, or not known.
    fn at_the_ends_of_range(&self, of: &[Enclosure], found: Enclosure, floor: f64) -> Enclosure {
        let with = |error: f64| Enclosure { error: found.error + error, ..found };
        let is_zero = |a: usize| of[a].value == 0.0 && of[a].rest == 0.0 && of[a].error == 0.0;
        match *self {
            Instruction::Linear { ref terms, .. } => {
                let lowers = |&(a, c): &(usize, f64)| of[a].value.is_infinite() && c.abs() < 1.0;
                if found.value.is_infinite() && terms.iter().any(lowers) {
                    return Enclosure { rest: f64::INFINITY, ..found };
                }
                if terms.iter().all(|&(a, _)| is_zero(a)) { found } else { with(floor) }
            }
            Instruction::Product(a, b) if is_zero(a) || is_zero(b) => found,
            Instruction::Quotient(a, _) if is_zero(a) => found,
            Instruction::Quotient(a, b) => {
                let (size, x) = (of[a].value.abs() + of[a].rest, of[b].value.abs());
                if x == f64::INFINITY {
                    let is_known = of[b].rest == 0.0 && size.is_finite();
                    return if is_known { with(f64::MIN_POSITIVE * (size + of[a].error)) } else { with(f64::NAN) };
                }
                // the noise of the product and of the sums, divided
                with(floor * (1.0 + (1.0 + x) / (x - of[b].rest - of[b].error)))
            }
            Instruction::Exp(a) => {
                let (x, reached) = (of[a].value, of[a].rest + of[a].error);
                if x - reached > BEYOND {
                    INFINITE
                } else if found.value == 0.0 {
                    with(floor + libm::exp(x + reached)) // no term of the series is left
                } else {
                    with(floor * libm::exp(2.0 * reached))
                }
            }
            Instruction::Sinh(a) | Instruction::Cosh(a) if of[a].value.abs() - of[a].rest - of[a].error > BEYOND => {
                Enclosure { value: found.value, ..INFINITE }
            }
            Instruction::Power(a, p) if !(0.0..=64.0).contains(&p) || p.fract() != 0.0 => {
                let share = (of[a].rest + of[a].error) / of[a].value.abs();
                with(floor * libm::pow(1.0 - share, -2.0 * p.abs()))
            }
            Instruction::Sqrt(a) | Instruction::Power(a, _) if is_zero(a) => found,
            Instruction::Sin(a) | Instruction::Sinh(a) | Instruction::Tanh(a) if is_zero(a) => found,
            Instruction::Asin(a) | Instruction::Atan(a) if is_zero(a) => found,
            _ => with(floor),
        }
    }
}

impl Enclosure {
    /// That of a function of this one, from its value and bounds of its `G` and `G'`.
    fn through(self, value: f64, rest: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64) -> Enclosure {
        let reached = self.rest + self.error;
        // infinity times zero is zero here: what is known exactly is not moved
        let error = if self.error == 0.0 { 0.0 } else { slope(reached) * self.error };
        Enclosure { value, rest: rest(self.rest), error }
    }

    /// Itself if a power series with this radius converges on all of it, and nothing known otherwise.
    fn within(self, radius: f64) -> Enclosure {
        if self.rest + self.error < radius { self } else { Enclosure { rest: f64::NAN, error: f64::NAN, ..self } }
    }

    /// A sine or cosine, also hyperbolic, from its value and that of its sister: the coefficient `k` of its series is one or
    /// the other, over `k!`.
    fn circular(self, value: f64, sister: f64) -> Enclosure {
        let (f, g) = (value.abs(), sister.abs());
        // cosh r - 1 = 2 sinh(r/2)^2, which does not cancel
        let bend = |r: f64| 2.0 * libm::sinh(r / 2.0).powi(2);
        self.through(value, |r| f * bend(r) + g * libm::sinh(r), |r| f * libm::sinh(r) + g * libm::cosh(r))
    }

    /// An arc sine or cosine, from its value: `1/sqrt((1 - x)(1 + x))` is its derivative, up to the sign.
    fn arc(self, value: f64) -> Enclosure {
        let slope = |r: f64| 1.0 / ((1.0 - self.value - r) * (1.0 + self.value - r)).sqrt();
        self.within(1.0 - self.value.abs()).through(value, |r| r * slope(r), slope)
    }
}

/// `exp(x + r) - exp(x)`, also where `exp(x)` is zero and `exp(r)` infinite.
fn growth(x: f64, r: f64) -> f64 {
    -libm::exp(x + r) * libm::expm1(-r)
}

fn product(a: Enclosure, b: Enclosure) -> Enclosure {
    let (size_a, size_b) = (a.value.abs() + a.rest, b.value.abs() + b.rest);
    Enclosure {
        value: a.value * b.value,
        rest: a.value.abs() * b.rest + a.rest * b.value.abs() + a.rest * b.rest,
        error: size_a * b.error + size_b * a.error + a.error * b.error,
    }
}

fn reciprocal(a: Enclosure) -> Enclosure {
    let x = a.value.abs();
    if x == f64::INFINITY {
        return Enclosure { value: 0.0, rest: 0.0, error: 0.0 }; // a number beyond the range divides to zero
    }
    a.within(x).through(1.0 / a.value, |r| r / (x * (x - r)), |r| 1.0 / (x - r).powi(2))
}

fn power(a: Enclosure, p: f64) -> Enclosure {
    let value = libm::pow(a.value, p);
    if (0.0..=64.0).contains(&p) && p.fract() == 0.0 {
        // ((x + r)^p - x^p)' <= p (x + r)^(p - 1)
        let slope = |r: f64| if p == 0.0 { 0.0 } else { p * libm::pow(a.value.abs() + r, p - 1.0) };
        return a.through(value, |r| r * slope(r), slope);
    }
    // |binomial(p, k)| is at most that of (1 - u)^(-|p|)
    let x = a.value.abs();
    let slope = |r: f64| value.abs() * p.abs() / x * libm::pow(1.0 - r / x, -p.abs() - 1.0);
    a.within(x).through(value, |r| r * slope(r), slope)
}

/// `tanh x = sign(x) (2/(1 + q) - 1)` with `q = exp(-2|x|)`, small where the function is flat.
fn tanh(a: Enclosure) -> Enclosure {
    let log_q = -2.0 * a.value.abs();
    let q = libm::exp(log_q);
    let decay = a.through(1.0 + q, |r| growth(log_q, 2.0 * r), |r| 2.0 * libm::exp(log_q + 2.0 * r));
    let Enclosure { rest, error, .. } = reciprocal(decay);
    Enclosure { value: libm::tanh(a.value), rest: 2.0 * rest, error: 2.0 * error }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Every function of one variable, and places where it is looked at.
    fn functions() -> Vec<(Vec<Instruction>, [f64; 3])> {
        type Unary = fn(usize) -> Instruction;
        let unary: [(Unary, [f64; 3]); 11] = [
            (Instruction::Sqrt, [0.3, 1.0, 7.0]),
            (Instruction::Exp, [-5.0, 0.0, 2.0]),
            (Instruction::Log, [0.3, 1.0, 7.0]),
            (Instruction::Sin, [-1.0, 0.0, 8.0]),
            (Instruction::Cos, [-1.0, 0.0, 8.0]),
            (Instruction::Sinh, [-2.0, 0.0, 1.0]),
            (Instruction::Cosh, [-2.0, 0.0, 1.0]),
            (Instruction::Tanh, [-6.0, 0.0, 1.0]),
            (Instruction::Asin, [-0.9, 0.0, 0.4]),
            (Instruction::Acos, [-0.9, 0.0, 0.4]),
            (Instruction::Atan, [-3.0, 0.0, 0.7]),
        ];
        let powers = [(3.0, -0.5), (0.0, 0.4), (-2.0, -0.7), (1.5, 0.8), (100.0, 1.1), (-0.3, 2.0)];
        let one = Instruction::Linear { terms: vec![(0, 2.0)], constant: 1.0 };
        unary
            .into_iter()
            .map(|(make, places)| (vec![make(0)], places))
            .chain(powers.map(|(p, place)| (vec![Instruction::Power(0, p)], [place; 3])))
            .chain([
                (vec![Instruction::Product(0, 0)], [-1.0, 0.0, 2.0]),
                (vec![one, Instruction::Quotient(0, 1)], [-1.0, 0.0, 2.0]),
            ])
            .collect()
    }

    /// The coefficients of the function of `x_0 + t`, to order 24.
    fn series(function: &Functions, place: f64) -> Vec<f64> {
        let mut state = vec![0.0; 25];
        (state[0], state[1]) = (place, 1.0);
        let mut series = vec![0.0; 25];
        function.series(&state, &mut vec![], &mut series);
        series
    }

    proptest! {
        /// In the norm of the sizes of the terms: the bound holds, and is no more than a few times too large.
        #[test]
        fn the_terms_of_a_series_add_up_to_less(which in 0_usize..19, place in 0_usize..3, radius in 1e-3_f64..0.09) {
            let (instructions, places) = functions().swap_remove(which);
            let output = instructions.len();
            let function = Functions::new(1, instructions, vec![output]).unwrap();
            let place = places[place];
            let found = function.enclosure(&[place], radius, 0.0, 0.0, &mut vec![]);
            let series = series(&function, place);
            let terms: f64 = (1..25).map(|k| series[k].abs() * radius.powi(k as i32)).sum();
            prop_assert!((found.value - series[0]).abs() <= 1e-14 * series[0].abs());
            prop_assert!(terms <= found.rest * (1.0 + 1e-12), "{terms:e} {found:?}");
            // the series of a power and of a quotient are bounded without regard to signs, that of 100 coarsely
            let is_coarse = function.instructions()[0] == Instruction::Power(0, 100.0);
            prop_assert!(is_coarse || found.rest <= 10.0 * terms + 1e-300, "{terms:e} {found:?}");
        }

        /// As largest values: a function of a state that is wrong is within the error.
        #[test]
        fn errors_of_the_state_move_the_function_by_less(
            which in 0_usize..19, place in 0_usize..3, at in -0.05_f64..0.05, by in -0.03_f64..0.03,
        ) {
            let (instructions, places) = functions().swap_remove(which);
            let output = instructions.len();
            let function = Functions::new(1, instructions, vec![output]).unwrap();
            let place = places[place];
            let found = function.enclosure(&[place], at.abs(), by.abs(), 0.0, &mut vec![]);
            let value = |x: f64| series(&function, x)[0];
            let moved = (value(place + at + by) - value(place + at)).abs();
            prop_assert!(moved <= found.error * (1.0 + 1e-9) + 1e-14 * value(place).abs(), "{moved:e} {found:?}");
        }
    }

    #[test]
    fn beyond_the_radius_of_convergence_nothing_is_known() {
        for (instruction, place, radius) in [
            (Instruction::Log(0), 0.5, 0.5),
            (Instruction::Sqrt(0), 0.5, 0.5),
            (Instruction::Quotient(0, 0), -0.5, 0.5),
            (Instruction::Asin(0), 0.75, 0.25),
            (Instruction::Atan(0), 0.0, 1.0),
        ] {
            let function = Functions::new(1, vec![instruction], vec![1]).unwrap();
            let rest = |rho: f64| function.enclosure(&[place], rho, 0.0, 0.0, &mut vec![]).rest;
            assert!(rest(0.99 * radius).is_finite());
            assert_eq!(rest(radius), f64::INFINITY);
        }
    }

    #[test]
    fn an_exponential_that_is_zero_to_all_digits_stays_so_nearby() {
        for (instruction, value) in [(Instruction::Exp(0), 0.0), (Instruction::Tanh(0), -1.0)] {
            let function = Functions::new(1, vec![instruction], vec![1]).unwrap();
            let found = function.enclosure(&[-2000.0], 1000.0, 1.0, 0.0, &mut vec![]);
            assert_eq!(found, Enclosure { value, rest: 0.0, error: 0.0 });
        }
    }

    #[test]
    fn round_off_counts_for_every_operation() {
        // x - x is zero, and not known to be
        let difference = Instruction::Linear { terms: vec![(0, 1.0), (0, -1.0)], constant: 0.0 };
        let function = Functions::new(1, vec![difference], vec![1]).unwrap();
        let found = function.enclosure(&[3.0], 0.0, 0.0, 1e-16, &mut vec![]);
        assert_eq!(found, Enclosure { value: 0.0, rest: 0.0, error: 6e-16 });
    }
}
