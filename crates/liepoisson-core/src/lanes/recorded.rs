//! A register that holds no numbers: operations with it are written down, so that one source also says what compiled code does.

use super::sealed::Sealed;
use super::{Body, Lane};
use std::cell::RefCell;
use std::collections::HashMap;

/// What a recorded register stands for: the number of an operation.
pub(crate) type Value = u32;

/// One operation on registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Operation {
    /// What this register of the memory held before.
    Memory(usize),
    /// The number with these bits in every lane.
    Constant(u64),
    Add(Value, Value),
    Sub(Value, Value),
    Mul(Value, Value),
    Div(Value, Value),
    Sqrt(Value),
    Abs(Value),
    /// The code is left where the first is larger than the second in any lane.
    Limit(Value, Value),
    /// `a b + c`
    MulAdd(Value, Value, Value),
    /// `c - a b`
    NegMulAdd(Value, Value, Value),
    /// `2^a`, as [`Lane::power_of_two`] has it, and some number of NaN.
    PowerOfTwo(Value),
    /// A function of a register, with two results; what it is only the caller knows.
    Call([u64; 2], Value),
    /// The loop of this number.
    Loop(usize),
    /// A result of a call or a loop.
    Result(Value, usize),
}

impl Operation {
    /// The same operation on other registers; loops have theirs in [`Loop`].
    pub(crate) fn map(self, mut to: impl FnMut(Value) -> Value) -> Operation {
        match self {
            Operation::Memory(_) | Operation::Constant(_) | Operation::Loop(_) => self,
            Operation::Add(a, b) => Operation::Add(to(a), to(b)),
            Operation::Sub(a, b) => Operation::Sub(to(a), to(b)),
            Operation::Mul(a, b) => Operation::Mul(to(a), to(b)),
            Operation::Div(a, b) => Operation::Div(to(a), to(b)),
            Operation::Sqrt(a) => Operation::Sqrt(to(a)),
            Operation::Abs(a) => Operation::Abs(to(a)),
            Operation::Limit(a, b) => Operation::Limit(to(a), to(b)),
            Operation::MulAdd(a, b, c) => Operation::MulAdd(to(a), to(b), to(c)),
            Operation::NegMulAdd(a, b, c) => Operation::NegMulAdd(to(a), to(b), to(c)),
            Operation::PowerOfTwo(a) => Operation::PowerOfTwo(to(a)),
            Operation::Call(function, a) => Operation::Call(function, to(a)),
            Operation::Result(a, result) => Operation::Result(to(a), result),
        }
    }
}

/// A loop that adds products to sums.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Loop {
    pub(crate) sums: Vec<Value>,
    pub(crate) left: Vec<Value>,
    pub(crate) right: Vec<Value>,
    pub(crate) terms: Terms,
    pub(crate) count: usize,
}

/// What a loop adds to which sums.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Terms {
    /// See [`Lane::record_products`].
    OfTwoOrders { skips: bool },
    /// See [`Lane::record_sums`].
    OfOneOrder { products: Vec<[usize; 3]>, step: usize },
}

impl Loop {
    /// From the first coefficients that so many terms read, of left series to those behind and of right ones to those before: how
    /// many registers there are to the last.
    pub(crate) fn reach(&self, count: usize) -> [usize; 2] {
        match self.terms {
            Terms::OfTwoOrders { .. } => [count.saturating_sub(1), count],
            Terms::OfOneOrder { step, .. } => [step * count.saturating_sub(1); 2],
        }
    }

    /// How many registers lie between a coefficient and the next.
    pub(crate) fn step(&self) -> usize {
        match self.terms {
            Terms::OfTwoOrders { .. } => 1,
            Terms::OfOneOrder { step, .. } => step,
        }
    }
}

/// What a piece of code does with its memory, in the order in which it was asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Trace {
    /// Registers of the memory: the first values, from which the operations are counted on.
    pub(crate) registers: usize,
    pub(crate) operations: Vec<Operation>,
    pub(crate) loops: Vec<Loop>,
    /// What each register of the memory holds in the end.
    pub(crate) memory: Vec<Value>,
}

/// The same, with what is computed twice in it once.
#[derive(Clone, Debug)]
pub(crate) struct Recording {
    /// The first ones are the registers of the memory.
    pub(crate) operations: Vec<Operation>,
    pub(crate) loops: Vec<Loop>,
    /// What each register of the memory holds in the end.
    pub(crate) memory: Vec<Value>,
}

impl Trace {
    pub(crate) fn recording(&self) -> Recording {
        let mut operations: Vec<Operation> = (0..self.registers).map(Operation::Memory).collect();
        let mut numbers: Vec<Value> = (0..self.registers as Value).collect();
        let mut known: HashMap<Operation, Value> = HashMap::new();
        for &operation in &self.operations {
            let operation = operation.map(|value| numbers[value as usize]);
            let next = operations.len() as Value;
            let value = *known.entry(operation).or_insert(next);
            if value == next {
                operations.push(operation);
            }
            numbers.push(value);
        }
        let of = |values: &[Value]| values.iter().map(|&value| numbers[value as usize]).collect::<Vec<_>>();
        let loops = self.loops.iter().map(|one| Loop {
            sums: of(&one.sums),
            left: of(&one.left),
            right: of(&one.right),
            terms: one.terms.clone(),
            count: one.count,
        });
        Recording { operations, loops: loops.collect(), memory: of(&self.memory) }
    }
}

impl Recording {
    /// Joins loops over the terms of one order, as far as a loop with all of their sums does with so many registers.
    pub(crate) fn join_loops(&mut self, registers: usize) {
        // the loop that others may join, as an operation; of each result where it is now
        let (mut first, mut moved): (Option<usize>, HashMap<Value, (Value, usize)>) = (None, HashMap::new());
        for at in 0..self.operations.len() {
            match self.operations[at] {
                Operation::Loop(number) => {
                    let joined = first.and_then(|first: usize| {
                        let Operation::Loop(of_first) = self.operations[first] else { return None };
                        let joined = self.loops[of_first].joined(&self.loops[number], first as Value, registers)?;
                        let n_sums = std::mem::replace(&mut self.loops[of_first], joined).sums.len();
                        Some((first as Value, n_sums))
                    });
                    match joined {
                        Some(joined) => drop(moved.insert(at as Value, joined)),
                        None => first = Some(at),
                    }
                }
                Operation::Result(of, number) => {
                    if let Some(&(of, n_before)) = moved.get(&of) {
                        self.operations[at] = Operation::Result(of, n_before + number);
                    }
                }
                _ => {}
            }
        }
    }
}

impl Loop {
    /// This loop, which is the operation `at`, with the sums of a later one; none where that needs what is computed later, or more registers.
    fn joined(&self, other: &Loop, at: Value, registers: usize) -> Option<Loop> {
        let (Terms::OfOneOrder { products, step }, Terms::OfOneOrder { products: others, step: other_step }) =
            (&self.terms, &other.terms)
        else {
            return None;
        };
        let is_earlier = other.sums.iter().chain(&other.left).chain(&other.right).all(|&value| value < at);
        if !is_earlier || (step, self.count) != (other_step, other.count) {
            return None;
        }
        let place = |values: &mut Vec<Value>, value: Value| {
            values.iter().position(|&known| known == value).unwrap_or_else(|| {
                values.push(value);
                values.len() - 1
            })
        };
        let (mut left, mut right, mut products) = (self.left.clone(), self.right.clone(), products.clone());
        for &[sum, a, b] in others {
            let [a, b] = [place(&mut left, other.left[a]), place(&mut right, other.right[b])];
            products.push([self.sums.len() + sum, a, b]);
        }
        let sums = [&self.sums[..], &other.sums].concat();
        // all sums, the right factors, and one left factor
        let fits = sums.len() + right.len() < registers;
        fits.then_some(Loop {
            sums,
            left,
            right,
            terms: Terms::OfOneOrder { products, step: *step },
            count: self.count,
        })
    }
}

thread_local! {
    static TRACE: RefCell<Trace> = RefCell::default();
}

/// A register whose operations are recorded; [`Recorded::record`] is what gives them a meaning.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Recorded(f64);

impl Recorded {
    /// What `code` does with memory of so many registers.
    pub(crate) fn trace(registers: usize, code: impl FnOnce(&mut [Recorded])) -> Trace {
        TRACE.replace(Trace { registers, ..Trace::default() });
        let mut memory: Vec<Recorded> = (0..registers).map(Recorded::of).collect();
        code(&mut memory);
        let memory = memory.into_iter().map(Recorded::value).collect();
        Trace { memory, ..TRACE.take() }
    }

    fn of(value: usize) -> Recorded {
        Recorded(f64::from_bits(value as u64))
    }

    fn value(self) -> Value {
        self.0.to_bits() as Value
    }

    /// Whether it is this number in every lane.
    fn is(self, number: f64) -> bool {
        let constant = Operation::Constant(number.to_bits());
        TRACE.with_borrow(|trace| {
            let at = (self.value() as usize).checked_sub(trace.registers);
            at.is_some_and(|at| trace.operations[at] == constant)
        })
    }
}

fn put(operation: Operation) -> Recorded {
    TRACE.with_borrow_mut(|trace| {
        trace.operations.push(operation);
        Recorded::of(trace.registers + trace.operations.len() - 1)
    })
}

impl Sealed for Recorded {}

impl Lane for Recorded {
    type Number = f64;
    const WIDTH: usize = 1;
    const REGISTERS: usize = 16;
    const IS_RECORDED: bool = true;

    fn splat(x: f64) -> Self {
        put(Operation::Constant(x.to_bits()))
    }

    fn add(self, other: Self) -> Self {
        put(Operation::Add(self.value(), other.value()))
    }

    fn sub(self, other: Self) -> Self {
        put(Operation::Sub(self.value(), other.value()))
    }

    // a factor of one changes nothing, and with one of -1 a fused operation rounds as a sum does

    fn mul(self, other: Self) -> Self {
        if other.is(1.0) {
            return self;
        }
        put(Operation::Mul(self.value(), other.value()))
    }

    fn mul_add(self, factor: Self, addend: Self) -> Self {
        if factor.is(1.0) {
            return addend.add(self);
        }
        if factor.is(-1.0) {
            return addend.sub(self);
        }
        put(Operation::MulAdd(self.value(), factor.value(), addend.value()))
    }

    fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
        if factor.is(1.0) {
            return addend.sub(self);
        }
        put(Operation::NegMulAdd(self.value(), factor.value(), addend.value()))
    }

    fn abs(self) -> Self {
        put(Operation::Abs(self.value()))
    }

    fn outline<B: Body>(body: B) {
        body.run();
    }

    fn div(self, other: Self) -> Self {
        put(Operation::Div(self.value(), other.value()))
    }

    fn sqrt(self) -> Self {
        put(Operation::Sqrt(self.value()))
    }

    fn power_of_two(self) -> Self {
        put(Operation::PowerOfTwo(self.value())).add(self.mul(Recorded::splat(0.0)))
    }

    fn as_scalars(&self) -> &[f64] {
        unreachable!("a recorded register holds no numbers")
    }

    fn as_scalars_mut(&mut self) -> &mut [f64] {
        unreachable!("a recorded register holds no numbers")
    }

    fn record_call(function: [u64; 2], x: Self) -> Option<[Self; 2]> {
        let call = put(Operation::Call(function, x.value())).value();
        Some([0, 1].map(|result| put(Operation::Result(call, result))))
    }

    fn record_limit(self, most: Self) -> bool {
        put(Operation::Limit(self.value(), most.value()));
        true
    }

    fn record_products(sums: &mut [Self], left: &[Self], right: &[Self], skips: bool, count: usize) -> bool {
        put_loop(sums, left, right, Terms::OfTwoOrders { skips }, count);
        true
    }

    fn record_sums(
        sums: &mut [Self],
        left: &[Self],
        right: &[Self],
        products: Vec<[usize; 3]>,
        step: usize,
        count: usize,
    ) -> bool {
        put_loop(sums, left, right, Terms::OfOneOrder { products, step }, count);
        true
    }
}

fn put_loop(sums: &mut [Recorded], left: &[Recorded], right: &[Recorded], terms: Terms, count: usize) {
    let values = |registers: &[Recorded]| registers.iter().map(|register| register.value()).collect();
    let recorded = Loop { sums: values(sums), left: values(left), right: values(right), terms, count };
    let number = TRACE.with_borrow_mut(|trace| {
        trace.loops.push(recorded);
        trace.loops.len() - 1
    });
    let products = put(Operation::Loop(number)).value();
    for (result, sum) in sums.iter_mut().enumerate() {
        *sum = put(Operation::Result(products, result));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_is_recorded_as_its_operations_and_what_it_leaves() {
        let recording = Recorded::trace(3, |memory| {
            memory[2] = memory[0].mul_add(memory[1], Recorded::splat(0.5)).div(memory[0]);
            memory[1] = memory[0].mul_add(memory[1], Recorded::splat(0.5));
        })
        .recording();
        let done = &recording.operations[3..];
        assert_eq!(done, [Operation::Constant(0.5_f64.to_bits()), Operation::MulAdd(0, 1, 3), Operation::Div(4, 0)]);
        assert_eq!(recording.memory, [0, 4, 5]);
    }
}
