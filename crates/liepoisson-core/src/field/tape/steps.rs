//! The steps by which a tape extends its series, as data: which rule, and which series and registers it reads and writes.

use super::graph::{Affine, Function};

/// Where the coefficients of a node are: all orders, if sums of products read them, or the current one alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slot {
    /// Number of the series, or of the single register.
    pub(super) index: usize,
    pub(super) is_series: bool,
}

/// `constant + sum c_i x_i` with its operands in slots. A sum without a constant begins with its first term; if one has the coefficient 1,
/// it is the first.
#[derive(Clone, Debug)]
pub(super) struct Form {
    pub(super) constant: f64,
    pub(super) terms: Vec<(Slot, f64)>,
}

impl Form {
    pub(super) fn new(form: &Affine, slots: &[Slot]) -> Form {
        Form { constant: form.constant, ..Form::linear(form, slots) }
    }

    /// The form without its constant.
    pub(super) fn linear(form: &Affine, slots: &[Slot]) -> Form {
        let mut terms: Vec<(Slot, f64)> = form.terms.iter().map(|&(node, c)| (slots[node], c)).collect();
        if let Some(first) = terms.iter().position(|&(_, c)| c == 1.0) {
            terms[..=first].rotate_right(1);
        }
        Form { constant: 0.0, terms }
    }
}

/// Sums of products to be formed before an order is completed. Numbers of series; results go to single registers, two
/// for each product (orders `k` and `k + 1`).
#[derive(Clone, Debug)]
pub(super) struct Convolution {
    pub(super) kind: Kind,
    pub(super) left: usize,
    pub(super) right: [usize; 2],
    pub(super) sums: usize,
    pub(super) tangent: Option<Tangent>,
}

/// The part of a convolution that belongs to tangent vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tangent {
    pub(super) left: usize,
    /// Not used by the kinds in which the tangent part multiplies the right series of the state.
    pub(super) right: usize,
    pub(super) sums: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// `l r`; tangent part `l dr + dl r`.
    Product,
    /// `l l`; tangent part `l dl`.
    Square,
    /// `l r`; tangent part `dl r`.
    Single,
    /// `l r` for two right series; tangent part `dl r`.
    Pair,
}

/// How one coefficient of the state follows. Plain indices are series, except `sums` and `inverse` (single registers).
#[derive(Clone, Debug)]
pub(super) enum Step {
    Component {
        from: usize,
        to: Slot,
    },
    Affine {
        form: Form,
        to: Slot,
    },
    Product {
        a: usize,
        b: usize,
        sums: usize,
        to: Slot,
    },
    Square {
        a: usize,
        sums: usize,
        to: Slot,
    },
    Quotient {
        a: Option<Slot>,
        b: usize,
        sums: usize,
        inverse: usize,
        to: usize,
    },
    Sqrt {
        a: Slot,
        sums: usize,
        inverse: usize,
        to: usize,
    },
    /// The series of `j a_j`.
    Weigh {
        a: Slot,
        to: usize,
    },
    Integral {
        function: Function,
        a: Slot,
        weighted: usize,
        derivative: usize,
        factor: f64,
        sums: usize,
        to: Slot,
    },
    Pair {
        a: Slot,
        hyperbolic: bool,
        weighted: usize,
        first: usize,
        second: usize,
        sums: usize,
    },
    /// `weighted` is the series of `j z_j`.
    DividedIntegral {
        function: Function,
        a: Slot,
        factor: f64,
        divisor: usize,
        weighted: usize,
        sums: usize,
        inverse: usize,
        to: Slot,
    },
}

/// How one coefficient of a tangent vector follows: `d` marks what belongs to the tangent vector.
#[derive(Clone, Debug)]
pub(super) enum TangentStep {
    Component {
        from: usize,
        to: Slot,
    },
    Affine {
        form: Form,
        to: Slot,
    },
    Product {
        a: usize,
        b: usize,
        da: usize,
        db: usize,
        sums: usize,
        to: Slot,
    },
    Square {
        a: usize,
        da: usize,
        sums: usize,
        to: Slot,
    },
    Quotient {
        da: Option<Slot>,
        b: usize,
        z: usize,
        db: usize,
        sums: usize,
        inverse: usize,
        to: usize,
    },
    Sqrt {
        da: Slot,
        z: usize,
        sums: usize,
        inverse: usize,
        to: usize,
    },
    /// `dz = factor w da`
    Integral {
        w: usize,
        da: usize,
        factor: f64,
        sums: usize,
        to: Slot,
    },
    /// `d dz = factor da`
    DividedIntegral {
        da: Slot,
        factor: f64,
        divisor: usize,
        sums: usize,
        inverse: usize,
        to: usize,
    },
}

/// A form for the state and the first tangent vector, which lacks the constant.
#[derive(Clone, Debug)]
pub(super) struct JointForm {
    pub(super) constant: f64,
    pub(super) terms: Vec<([Slot; 2], f64)>,
}

impl JointForm {
    pub(super) fn new(form: &Form, tangent: &Form) -> JointForm {
        let terms = form.terms.iter().zip(&tangent.terms);
        JointForm { constant: form.constant, terms: terms.map(|(&(a, c), &(da, _))| ([a, da], c)).collect() }
    }
}

/// What is done for one node. Plain indices are series, except `sums` and `inverse` (single registers); `[a, da]` are
/// numbers for the state and for the tangent vector.
#[derive(Clone, Debug)]
pub(super) enum Joint {
    Component {
        from: usize,
        to: [Slot; 2],
    },
    Affine {
        form: JointForm,
        to: [Slot; 2],
    },
    Product {
        a: [usize; 2],
        b: [usize; 2],
        sums: [usize; 2],
        to: [Slot; 2],
    },
    Square {
        a: [usize; 2],
        sums: [usize; 2],
        to: [Slot; 2],
    },
    Quotient {
        a: Option<[Slot; 2]>,
        b: [usize; 2],
        z: [usize; 2],
        sums: [usize; 2],
        inverse: usize,
    },
    Pair {
        hyperbolic: bool,
        weighted: usize,
        da: usize,
        first: usize,
        second: usize,
        to: [Option<Slot>; 2],
        sums: [usize; 2],
    },
    Sqrt {
        a: [Slot; 2],
        z: [usize; 2],
        sums: [usize; 2],
        inverse: usize,
    },
    /// The series of `j a_j`.
    Weigh {
        a: Slot,
        to: usize,
    },
    /// A step of the state alone.
    State(usize),
    /// A step of the tangent vector alone.
    Tangent(usize),
}

impl Joint {
    /// A step of the state, which is number `index`.
    pub(super) fn of_state(index: usize, step: &Step) -> Joint {
        match *step {
            Step::Weigh { a, to } => Joint::Weigh { a, to },
            _ => Joint::State(index),
        }
    }

    /// Both steps of a node as one, if there is a rule for that.
    pub(super) fn of(step: &Step, tangent_steps: &[TangentStep]) -> Option<Joint> {
        Some(match (step, tangent_steps) {
            (&Step::Component { from, to }, &[TangentStep::Component { to: dto, .. }]) => {
                Joint::Component { from, to: [to, dto] }
            }
            (Step::Affine { form, to }, [TangentStep::Affine { form: tangent, to: dto }]) => {
                Joint::Affine { form: JointForm::new(form, tangent), to: [*to, *dto] }
            }
            (&Step::Product { a, b, sums, to }, &[TangentStep::Product { da, db, sums: dsums, to: dto, .. }]) => {
                Joint::Product { a: [a, da], b: [b, db], sums: [sums, dsums], to: [to, dto] }
            }
            (&Step::Square { a, sums, to }, &[TangentStep::Square { da, sums: dsums, to: dto, .. }]) => {
                Joint::Square { a: [a, da], sums: [sums, dsums], to: [to, dto] }
            }
            (
                &Step::Quotient { a, b, sums, inverse, to },
                &[TangentStep::Quotient { da, db, sums: dsums, to: dto, .. }],
            ) => {
                let a = a.zip(da).map(|(a, da)| [a, da]);
                Joint::Quotient { a, b: [b, db], z: [to, dto], sums: [sums, dsums], inverse }
            }
            (&Step::Sqrt { a, sums, inverse, to }, &[TangentStep::Sqrt { da, sums: dsums, to: dto, .. }]) => {
                Joint::Sqrt { a: [a, da], z: [to, dto], sums: [sums, dsums], inverse }
            }
            (
                &Step::Pair { hyperbolic, weighted, first, second, sums, .. },
                &[TangentStep::Integral { da, sums: dsums, to, w, .. }, ref rest @ ..],
            ) => {
                // the tangent part of the first, that of the second, or both; it reads the other one
                let (to, dsums) = match rest {
                    &[TangentStep::Integral { to: other, .. }] => ([Some(to), Some(other)], dsums),
                    _ if w == second => ([Some(to), None], dsums),
                    _ => ([None, Some(to)], dsums - 2),
                };
                Joint::Pair { hyperbolic, weighted, da, first, second, to, sums: [sums, dsums] }
            }
            _ => return None,
        })
    }
}
