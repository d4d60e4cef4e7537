//! Coefficients of the splitting methods, as published.

/// The compositions that there are, by order.
pub(super) const ORDERS: [usize; 4] = [2, 4, 6, 8];

/// One stage of a composition: what happens between two flows of the outermost split term.
///
/// With the first-order map `chi_h = phi1_h o ... o phim_h` of the flows of m split terms and its adjoint `chi*_h`, a method is
/// `chi_{d_s h} o chi*_{c_s h} o ... o chi_{d_1 h} o chi*_{c_1 h}`. In stage k the flows of the inner split terms are passed
/// inwards with the time `c_k h`, the innermost one takes `(c_k + d_k) h` at once, and they are passed outwards with the
/// time `d_k h`; then the outermost one takes `(d_k + c_{k+1}) h`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    /// `c_k`
    pub inwards: f64,
    /// `c_k + d_k`, the coefficient of the innermost split term.
    pub innermost: f64,
    /// `d_k`
    pub outwards: f64,
    /// `d_k + c_{k+1}`, the coefficient of the outermost split term after the stage; in the last stage `d_k`.
    pub outermost: f64,
}

/// A symmetric composition of flows: the outermost split term for the time `first h`, then stage after stage.
#[derive(Clone, Debug, PartialEq)]
pub struct Scheme {
    /// Coefficient of the first flow, of the outermost split term.
    pub first: f64,
    /// The stages.
    pub stages: Vec<Stage>,
}

/// Strang (1968), SIAM J. Numer. Anal. 5, 506.
const STRANG: [&[f64]; 2] = [&[0.5], &[1.0]];

/// Blanes and Moan (2002), J. Comput. Appl. Math. 142, 313: S6 of order 4.
const BLANES_MOAN_4: [&[f64]; 2] = [
    &[0.079_203_696_431_195_7, 0.353_172_906_049_774, -0.042_065_080_357_719_5],
    &[0.209_515_106_613_362, -0.143_851_773_179_818],
];

/// Blanes and Moan (2002): S10 of order 6.
const BLANES_MOAN_6: [&[f64]; 2] = [
    &[
        0.050_262_764_400_392_2,
        0.413_514_300_428_344,
        0.045_079_889_794_397_7,
        -0.188_054_853_819_569,
        0.541_960_678_450_780,
    ],
    &[0.148_816_447_901_042, -0.132_385_865_767_784, 0.067_307_604_692_185, 0.432_666_402_578_175],
];

/// Kahan and Li (1997), Math. Comp. 66, 1089: the first nine of 17 symmetric steps of order two, for order 8.
#[expect(clippy::excessive_precision, reason = "the digits are those of the paper")]
const KAHAN_LI_8: [f64; 9] = [
    0.130_202_483_088_890_087_808_817_63,
    0.561_162_981_775_108_384_561_964_41,
    -0.389_474_962_644_847_286_408_078_60,
    0.158_841_906_555_155_600_896_210_75,
    -0.395_903_894_133_237_577_336_231_54,
    0.184_539_640_978_315_707_091_832_54,
    0.258_374_387_686_322_047_293_979_11,
    0.295_011_723_609_310_298_870_966_24,
    -0.605_508_533_830_034_511_698_921_08,
];

impl Scheme {
    /// The method of one of the [`ORDERS`].
    pub(super) fn of_order(order: usize) -> Scheme {
        match order {
            2 => Scheme::from_flows(STRANG[0].to_vec(), STRANG[1].to_vec()),
            4 => Scheme::from_halves(BLANES_MOAN_4),
            6 => Scheme::from_halves(BLANES_MOAN_6),
            _ => Scheme::from_symmetric_steps(&KAHAN_LI_8),
        }
    }

    /// The palindrome of which `outer` and `inner` give the first half, without the last coefficient of either.
    ///
    /// With s inner flows, s even, both sequences are symmetric and add up to one; `outer` has one in the middle.
    fn from_halves([outer, inner]: [&[f64]; 2]) -> Scheme {
        let middle = 1.0 - 2.0 * outer.iter().sum::<f64>();
        let last = 0.5 - inner.iter().sum::<f64>();
        let outer: Vec<f64> = outer.iter().copied().chain([middle]).collect();
        let inner: Vec<f64> = inner.iter().copied().chain([last]).collect();
        Scheme::from_flows(outer, [inner.clone(), inner.into_iter().rev().collect()].concat())
    }

    /// Steps of order two, `phi_outer(g h/2) o phi_inner(g h) o phi_outer(g h/2)`, of which all up to the middle are given.
    fn from_symmetric_steps(first_half: &[f64]) -> Scheme {
        let steps: Vec<f64> = first_half.iter().chain(first_half.iter().rev().skip(1)).copied().collect();
        let outer = (0..first_half.len()).map(|k| if k == 0 { steps[0] } else { steps[k - 1] + steps[k] } / 2.0);
        Scheme::from_flows(outer.collect(), steps)
    }

    /// The scheme with the first half of the flows of the outer split term, and all of the inner one.
    fn from_flows(outer: Vec<f64>, inner: Vec<f64>) -> Scheme {
        let outer_at = |k: usize| outer[k.min(inner.len() - k)];
        let mut inwards = outer[0];
        let stages = inner.iter().enumerate().map(|(k, &innermost)| {
            let outwards = innermost - inwards;
            let stage = Stage { inwards, innermost, outwards, outermost: outer_at(k + 1) };
            inwards = stage.outermost - outwards;
            stage
        });
        Scheme { first: outer[0], stages: stages.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(terms: impl Iterator<Item = f64>) -> f64 {
        terms.sum()
    }

    /// With `c` and `d` the times of the adjoint and of the map itself: `sum (c + d) = 1`, and for order three
    /// `sum (d^2 - c^2) = 0`, `sum (c^3 + d^3) = 0` and so on; the linear and the palindromic ones are checked here, the
    /// others by the measured order.
    #[test]
    fn schemes_are_consistent_palindromes() {
        for order in ORDERS {
            let Scheme { first, stages } = Scheme::of_order(order);
            let n = stages.len();
            assert!((sum(stages.iter().map(|s| s.innermost)) - 1.0).abs() < 4e-16 * n as f64, "order {order}");
            assert!((first + sum(stages.iter().map(|s| s.outermost)) - 1.0).abs() < 4e-16 * n as f64, "order {order}");
            assert!((stages[n - 1].outwards - first).abs() < 4e-16 * n as f64, "order {order}");
            for k in 0..n {
                assert!((stages[k].inwards - stages[n - 1 - k].outwards).abs() < 4e-16 * n as f64, "order {order}");
                assert_eq!(stages[k].innermost, stages[n - 1 - k].innermost);
            }
        }
    }
}
