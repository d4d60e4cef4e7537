//! Code that was compiled before, for other constants: a parameter of a system has a new value, and its code is the same.
//!
//! What is compiled depends on the operations that were recorded, on which of their constants are equal, and on the values of a few:
//! zero, one and minus one, and those that [`emit`](super::emit) has itself. So where a recording differs from an earlier one in its
//! constants alone, each of these stands for one other, and those few for themselves, its code is that of the earlier one, with other
//! numbers before it. The field itself is read and derived anew for each value, so what depends on values there (terms that vanish or
//! cancel, factors of one) shows in the operations.

use super::emit::{SIZE, WHOLE};
use super::memory::{Functions, caller};
use super::{Program, Source};
use crate::lanes::recorded::Operation;
use crate::lanes::{Instructions, Lane};
use std::collections::{HashMap, HashSet};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// How much code is kept at most: the curves and grids of one system need one or two of each purpose.
const MOST: usize = 16;

/// Operations of which records are kept at most: some 2 MB.
const MOST_OPERATIONS: usize = 1 << 16;

/// Constants whose value decides what is compiled: see `Recorded` and `emit`.
const FIXED: [u64; 5] = [0, 1.0_f64.to_bits(), (-1.0_f64).to_bits(), WHOLE.to_bits(), SIZE];

/// All that code follows from.
#[derive(Debug)]
pub(super) struct Question {
    pub(super) instructions: Instructions,
    pub(super) registers: usize,
    /// The address of what it calls for a function.
    pub(super) function: usize,
    pub(super) sources: Vec<Source>,
    /// Whether a register of the memory is wanted in the end.
    pub(super) is_wanted: Vec<bool>,
}

impl Question {
    /// None for registers for which no code is compiled.
    pub(super) fn new<V: Lane, F: Functions>(
        registers: usize,
        sources: Vec<Source>,
        is_wanted: impl Fn(usize) -> bool,
    ) -> Option<Question> {
        let is_wanted = (0..registers).map(is_wanted).collect();
        Some(Question { instructions: V::INSTRUCTIONS?, registers, function: caller::<V, F>(), sources, is_wanted })
    }

    /// The bits of all constants, one after the other: those that decide what is compiled, then those of the operations.
    fn constants(&self) -> impl Iterator<Item = u64> {
        let operations = self.sources.iter().flat_map(|source| &source.trace.operations);
        let of_operations = operations.filter_map(|&operation| match operation {
            Operation::Constant(bits) | Operation::Call([_, bits], _) => Some(bits),
            _ => None,
        });
        FIXED.into_iter().chain(of_operations)
    }
}

/// The question, and what was compiled.
struct Answer {
    question: Question,
    /// The constants that differ.
    values: Vec<u64>,
    /// Which of them each of all constants is.
    numbers_of_values: Vec<usize>,
    program: Program,
}

/// What was compiled last.
static KNOWN: Mutex<Vec<Answer>> = Mutex::new(vec![]);

/// How often code was asked for that was not there, by its registers.
static UNKNOWN: Mutex<Vec<((Instructions, usize), u64)>> = Mutex::new(vec![]);

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What is known of code for memory of a size.
pub(crate) enum Asked {
    /// There is code that may be for the same operations.
    Known,
    /// There is none, which was asked for so many times.
    Unknown { times: u64 },
}

/// Asks for code for memory of so many registers.
pub(crate) fn asked<V: Lane>(registers: usize) -> Asked {
    let Some(instructions) = V::INSTRUCTIONS else { return Asked::Unknown { times: 0 } };
    let is_like = |question: &Question| (question.instructions, question.registers) == (instructions, registers);
    if locked(&KNOWN).iter().any(|answer| is_like(&answer.question)) {
        return Asked::Known;
    }
    let mut unknown = locked(&UNKNOWN);
    let at = unknown.iter().position(|&(of, _)| of == (instructions, registers)).unwrap_or_else(|| {
        if unknown.len() == MOST {
            unknown.remove(0);
        }
        unknown.push(((instructions, registers), 0));
        unknown.len() - 1
    });
    unknown[at].1 += 1;
    Asked::Unknown { times: unknown[at].1 }
}

/// The code for a question, if it was compiled before, for whatever constants.
pub(super) fn find(question: &Question) -> Option<Program> {
    locked(&KNOWN).iter().rev().find_map(|answer| answer.of(question))
}

/// Keeps what was compiled, and forgets the oldest for it.
pub(super) fn keep(question: Question, program: Program) {
    if question.sources.iter().map(|source| source.trace.operations.len()).sum::<usize>() > MOST_OPERATIONS {
        return;
    }
    let answer = Answer::new(question, program);
    let mut answers = locked(&KNOWN);
    if answers.len() == MOST {
        answers.remove(0);
    }
    answers.push(answer);
}

impl Answer {
    fn new(question: Question, program: Program) -> Answer {
        let (mut values, mut known) = (vec![], HashMap::new());
        let number = |bits: u64| {
            *known.entry(bits).or_insert_with(|| {
                values.push(bits);
                values.len() - 1
            })
        };
        let numbers_of_values = question.constants().map(number).collect();
        Answer { question, values, numbers_of_values, program }
    }

    /// The program for another question; none if its code is not the same.
    fn of(&self, question: &Question) -> Option<Program> {
        let constants = self.substitution(question)?;
        let mut program = self.program.clone();
        for bits in &mut program.numbers {
            *bits = *constants.get(bits).unwrap_or(bits);
        }
        Some(program)
    }

    /// What each constant stands for in another question; none if the code is not the same.
    fn substitution(&self, to: &Question) -> Option<HashMap<u64, u64>> {
        let from = &self.question;
        let is_alike = from.instructions == to.instructions
            && from.registers == to.registers
            && from.function == to.function
            && from.sources.len() == to.sources.len()
            && from.is_wanted == to.is_wanted
            && from.sources.iter().zip(&to.sources).all(|(from, to)| is_alike(from, to));
        if !is_alike {
            return None;
        }
        let mut values: Vec<Option<u64>> = vec![None; self.values.len()];
        for (&number, value) in self.numbers_of_values.iter().zip(to.constants()) {
            if *values[number].get_or_insert(value) != value {
                return None;
            }
        }
        let (mut constants, mut taken) = (HashMap::new(), HashSet::new());
        for (&from, to) in self.values.iter().zip(values) {
            let to = to?;
            // beside the constants lie small whole numbers, such as the lengths of loops
            let is_free = from == to || is_large(from) && is_large(to);
            if !is_free || !taken.insert(to) {
                return None;
            }
            constants.insert(from, to);
        }
        FIXED.iter().all(|bits| constants.get(bits) == Some(bits)).then_some(constants)
    }
}

/// Whether one recording is the other but for constants.
fn is_alike(from: &Source, to: &Source) -> bool {
    let (ours, others) = (&from.trace, &to.trace);
    (from.k, from.bases) == (to.k, to.bases)
        && ours.registers == others.registers
        && ours.operations.len() == others.operations.len()
        && ours.loops == others.loops
        && ours.memory == others.memory
        && ours
            .operations
            .iter()
            .zip(&others.operations)
            .all(|(from, to)| from == to || matches!((from, to), (Operation::Constant(_), Operation::Constant(_))))
}

fn is_large(bits: u64) -> bool {
    f64::from_bits(bits).is_normal()
}

#[cfg(test)]
mod tests {
    use super::super::compile;
    use super::*;
    use crate::lanes::recorded::Recorded;

    struct Nothing;

    impl Functions for Nothing {
        fn compute<V: Lane>(_: [u64; 2], x: V) -> [V; 2] {
            [x; 2]
        }
    }

    /// `c x + d y`, `x / c` and a function with the number 0.3, where a factor of one or minus one is none.
    fn question([c, d]: [f64; 2]) -> Question {
        let trace = Recorded::trace(4, |memory| {
            let [x, y] = [memory[0], memory[1]];
            memory[2] = x.mul_add(Recorded::splat(c), y.mul(Recorded::splat(d))).add(Recorded::splat(0.25));
            memory[3] = x.div(Recorded::splat(c));
            memory[1] = Recorded::record_call([3, 0.3_f64.to_bits()], y).unwrap()[0];
        });
        Question {
            instructions: Instructions::Vex,
            registers: 4,
            function: caller::<f64, Nothing>(),
            sources: vec![Source { trace, k: 7, bases: [7, 3, 7] }],
            is_wanted: vec![true; 4],
        }
    }

    /// The numbers of the code are the length of a loop, those of a function, and constants; a constant may be any of them.
    #[test]
    fn code_for_other_constants_is_what_would_be_compiled_for_them() {
        let numbers = [0.0, -0.0, 1.0, -1.0, 2.0, 0.25, 0.3, 0.7, 1e-300, -1e300, 5e-324, f64::from_bits(7), WHOLE];
        let pairs = || numbers.iter().flat_map(|&c| numbers.iter().map(move |&d| [c, d]));
        let mut n_found = 0;
        for from in pairs() {
            let answer = Answer::new(question(from), compile(&question(from)).unwrap());
            for to in pairs() {
                let found = answer.of(&question(to));
                n_found += usize::from(from != to && found.is_some());
                assert!(found.is_none_or(|found| Some(found) == compile(&question(to))), "{from:?} {to:?}");
            }
        }
        // two of the numbers 2, 0.7, 1e-300 and -1e300 which are not equal, for two others
        assert!(n_found >= 12 * 11, "{n_found}");
    }

    #[test]
    fn what_was_compiled_last_is_kept() {
        for k in 0..2 * MOST {
            let one = Question { registers: 1000 + k, ..question([0.5, 0.75]) };
            let program = compile(&one).unwrap();
            keep(one, program);
        }
        assert!(locked(&KNOWN).len() <= MOST);
    }
}
