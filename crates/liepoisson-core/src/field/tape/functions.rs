//! Functions of the state as a tape: along a solution their power series follow from that of the state.

use super::drive;
use super::frame::Frame;
use super::graph::{Affine, Graph};
use super::instruction::{Instruction, check};
use super::program::Program;
use crate::error::Error;
use crate::lanes::{Body, Simd, Task, Wide, as_single_registers, dispatch};
use std::marker::PhantomData;

/// Functions on phase space, such as those that define a surface of section.
#[derive(Clone, Debug)]
pub struct Functions {
    n_components: usize,
    instructions: Vec<Instruction>,
    outputs: Vec<usize>,
    program: Program,
    /// The functions, if all are linear combinations of components, with a constant.
    affine: Option<Vec<Affine>>,
}

impl Functions {
    /// Functions of `n_components` variables; instructions as those of a [`super::Tape`], one output for each function.
    ///
    /// # Errors
    /// No component; no output, or one that no instruction computes; an instruction that reads a register not yet
    /// written, or has a number that is not finite.
    pub fn new(n_components: usize, instructions: Vec<Instruction>, outputs: Vec<usize>) -> Result<Functions, Error> {
        check(n_components, &instructions, &outputs)?;
        if outputs.is_empty() {
            return Err(Error::Outputs { wanted: 1, got: 0 });
        }
        Ok(Functions::checked(n_components, instructions, outputs))
    }

    fn checked(n_components: usize, instructions: Vec<Instruction>, outputs: Vec<usize>) -> Functions {
        let graph = Graph::new(n_components, &instructions, &outputs);
        let (program, affine) = (Program::new(&graph), graph.affine_outputs());
        Functions { n_components, instructions, outputs, program, affine }
    }

    /// The first function, and the others, if there are any: each part computes what it needs and no more.
    pub fn split_first(self) -> (Functions, Option<Functions>) {
        let others = (self.outputs.len() > 1)
            .then(|| Functions::checked(self.n_components, self.instructions.clone(), self.outputs[1..].to_vec()));
        if others.is_none() {
            return (self, None);
        }
        (Functions::checked(self.n_components, self.instructions, self.outputs[..1].to_vec()), others)
    }

    /// Number of components of the state.
    pub fn n_components(&self) -> usize {
        self.n_components
    }

    /// Number of functions.
    pub fn n_functions(&self) -> usize {
        self.outputs.len()
    }

    /// The coefficients `(order, function)` of the functions, from those of the state, `(order, component)`. `work` is
    /// memory that calls share. Where a function or its series does not exist, the coefficients are not finite.
    pub fn series(&self, state: &[f64], work: &mut Vec<f64>, to: &mut [f64]) {
        let n_orders = state.len() / self.n_components;
        if let Some(forms) = &self.affine {
            return self.affine_series(forms, state, to);
        }
        // an order more than is wanted: the sums of products are formed for two orders at once
        work.clear();
        work.resize(self.n_components + self.program.registers(0, n_orders + 1), 0.0);
        dispatch(Simd::Scalar, Series { functions: self, n_orders, state, work, to });
    }

    fn affine_series(&self, forms: &[Affine], state: &[f64], to: &mut [f64]) {
        let rows = state.chunks_exact(self.n_components).zip(to.chunks_exact_mut(forms.len()));
        for (k, (row, to)) in rows.enumerate() {
            for (to, Affine { constant, terms }) in to.iter_mut().zip(forms) {
                let start = if k == 0 { *constant } else { 0.0 };
                *to = terms.iter().fold(start, |sum, &(component, c)| sum + c * row[component]);
            }
        }
    }

    /// The constant and the coefficients of the components, `(component, coefficient)`, of one function that is linear in the
    /// state.
    pub fn linear_form(&self) -> Option<(f64, &[(usize, f64)])> {
        match self.affine.as_deref()? {
            [Affine { constant, terms }] => Some((*constant, terms)),
            _ => None,
        }
    }

    /// Whether all functions are linear combinations of components, with a constant.
    pub fn is_affine(&self) -> bool {
        self.affine.is_some()
    }

    pub(super) fn instructions(&self) -> &[Instruction] {
        &self.instructions
    }

    pub(super) fn outputs(&self) -> &[usize] {
        &self.outputs
    }
}

struct Series<'s> {
    functions: &'s Functions,
    n_orders: usize,
    state: &'s [f64],
    work: &'s mut [f64],
    to: &'s mut [f64],
}

impl Task for Series<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        V::outline(Expansion::<V>(self, PhantomData));
    }
}

/// One number in a register: the trajectories of a block are looked at one by one.
struct Expansion<'s, V>(Series<'s>, PhantomData<V>);

impl<V: Wide> Body for Expansion<'_, V> {
    #[inline(always)]
    fn run(self) {
        let Series { functions, n_orders, state, work, to } = self.0;
        let program = &functions.program;
        let (row, work) = as_single_registers::<V>(work).split_at_mut(functions.n_components);
        for k in 0..n_orders {
            for (register, &value) in row.iter_mut().zip(&state[k * functions.n_components..]) {
                *register = V::splat(value);
            }
            let frame = Frame::new(program, work.len() + n_orders + 1, 1, 0, k);
            drive::complete_order(program, &frame, row, work);
            drive::write_functions(program, &frame, &mut to[k * functions.n_functions()..], work);
        }
    }
}
