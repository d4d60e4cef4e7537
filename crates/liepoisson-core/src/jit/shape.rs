//! Recordings of several orders as one piece of code, wherever they differ only in how far the series have come.

use crate::lanes::recorded::{Loop, Operation, Recording, Value};

/// Bases of addresses, each some registers after the start of the memory: a number for each order.
pub(super) const BASES: usize = 4;

/// What is known of one order: where the bases are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Order {
    /// Number of the order, from which the lengths of loops follow.
    pub(super) k: usize,
    pub(super) bases: [usize; BASES],
}

/// A register of the memory, or a number: so much more than a base.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Relative {
    pub(super) base: usize,
    pub(super) more: isize,
}

/// All that a number may mean, as far as the orders seen tell: relative to which bases, and how much more it is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Candidates {
    more: [isize; BASES],
    are_possible: [bool; BASES],
}

impl Candidates {
    fn of(number: usize, bases: &[usize]) -> Candidates {
        let mut candidates = Candidates { more: [0; BASES], are_possible: [false; BASES] };
        for (base, &at) in bases.iter().enumerate() {
            candidates.more[base] = number as isize - at as isize;
            candidates.are_possible[base] = true;
        }
        candidates
    }

    /// What both may mean; none if nothing.
    fn common(mut self, other: Candidates) -> Option<Candidates> {
        for base in 0..BASES {
            self.are_possible[base] &= other.are_possible[base] && self.more[base] == other.more[base];
        }
        self.are_possible.contains(&true).then_some(self)
    }

    fn first(self) -> Relative {
        let base = self.are_possible.iter().position(|&is| is).expect("a number means something");
        Relative { base, more: self.more[base] }
    }
}

/// A register of the memory that the code writes.
#[derive(Clone, Debug)]
pub(super) struct Store {
    address: Candidates,
    pub(super) value: Value,
    /// Whether what was there before is read, so that it is written in the end.
    pub(super) is_late: bool,
}

impl Store {
    pub(super) fn address(&self) -> Relative {
        self.address.first()
    }
}

/// One piece of code for some orders.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub(super) orders: Vec<Order>,
    /// The operations in turn. Of a register of the memory the number counts `addresses`, of a constant `columns`.
    pub(super) operations: Vec<Operation>,
    pub(super) loops: Vec<Loop>,
    addresses: Vec<Candidates>,
    /// Of each constant its bits at each order.
    pub(super) columns: Vec<Vec<u64>>,
    /// How often each loop runs at each order, and what that may mean.
    counts: Vec<(Vec<usize>, Candidates)>,
    pub(super) stores: Vec<Store>,
}

impl Shape {
    /// What one order does, without what leaves no trace in the registers of the memory that are kept. None if it cannot be compiled.
    pub(super) fn new(recording: &Recording, order: Order, is_kept: &[bool]) -> Option<Shape> {
        let kept = recording.memory.iter().enumerate().filter(|&(register, &value)| {
            is_kept[register] && recording.operations[value as usize] != Operation::Memory(register)
        });
        let kept: Vec<(usize, Value)> = kept.map(|(register, &value)| (register, value)).collect();
        let is_live = live(recording, &kept);
        let mut shape = Shape {
            orders: vec![order],
            operations: vec![],
            loops: vec![],
            addresses: vec![],
            columns: vec![],
            counts: vec![],
            stores: vec![],
        };
        let mut numbers = vec![Value::MAX; recording.operations.len()];
        let read = reads(recording)?;
        for (old, &operation) in recording.operations.iter().enumerate().filter(|&(old, _)| is_live[old]) {
            let new = operation.map(|value| numbers[value as usize]);
            let new = match new {
                Operation::Memory(register) => {
                    shape.addresses.push(Candidates::of(register, &order.bases));
                    Operation::Memory(shape.addresses.len() - 1)
                }
                Operation::Constant(bits) => {
                    shape.columns.push(vec![bits]);
                    Operation::Constant(shape.columns.len() as u64 - 1)
                }
                Operation::Loop(number) => {
                    let one = &recording.loops[number];
                    let known = |values: &[Value]| values.iter().map(|&value| numbers[value as usize]).collect();
                    shape.loops.push(Loop {
                        sums: known(&one.sums),
                        left: known(&one.left),
                        right: known(&one.right),
                        ..one.clone()
                    });
                    shape.counts.push((vec![one.count], Candidates::of(one.count, &count_bases(order.k))));
                    Operation::Loop(shape.loops.len() - 1)
                }
                other => other,
            };
            numbers[old] = shape.operations.len() as Value;
            shape.operations.push(new);
        }
        for (register, value) in kept {
            shape.stores.push(Store {
                address: Candidates::of(register, &order.bases),
                value: numbers[value as usize],
                is_late: read[register],
            });
        }
        Some(shape)
    }

    /// Takes the orders of another one in, if one piece of code can serve all; else gives it back.
    pub(super) fn merge(&mut self, other: Shape) -> Option<Shape> {
        let is_alike = self.operations == other.operations
            && self.loops.len() == other.loops.len()
            && self.loops.iter().zip(&other.loops).all(|(a, b)| *a == Loop { count: a.count, ..b.clone() })
            && self.stores.len() == other.stores.len()
            && self.stores.iter().zip(&other.stores).all(|(a, b)| a.value == b.value);
        let common = |a: &[Candidates], b: &[Candidates]| -> Option<Vec<Candidates>> {
            a.iter().zip(b).map(|(a, &b)| a.common(b)).collect()
        };
        let of_counts = |shape: &Shape| shape.counts.iter().map(|&(_, means)| means).collect::<Vec<_>>();
        let of_stores = |shape: &Shape| shape.stores.iter().map(|store| store.address).collect::<Vec<_>>();
        if !is_alike {
            return Some(other);
        }
        let addresses = common(&self.addresses, &other.addresses);
        let counts = common(&of_counts(self), &of_counts(&other));
        let stores = common(&of_stores(self), &of_stores(&other));
        let (Some(addresses), Some(counts), Some(stores)) = (addresses, counts, stores) else { return Some(other) };
        self.orders.extend(other.orders);
        self.addresses = addresses;
        for ((runs, means), (more, common)) in
            self.counts.iter_mut().zip(other.counts.into_iter().map(|c| c.0).zip(counts))
        {
            runs.extend(more);
            *means = common;
        }
        for ((store, address), other) in self.stores.iter_mut().zip(stores).zip(other.stores) {
            store.address = address;
            store.is_late |= other.is_late;
        }
        for (column, more) in self.columns.iter_mut().zip(other.columns) {
            column.extend(more);
        }
        None
    }

    pub(super) fn address(&self, number: usize) -> Relative {
        self.addresses[number].first()
    }

    /// How often a loop runs at each order, and as a number relative to those of [`count_bases`].
    pub(super) fn count(&self, number: usize) -> (&[usize], Relative) {
        let (runs, means) = &self.counts[number];
        (runs, means.first())
    }

    /// Whether all registers that the code reads and writes are in a memory of so many, at each order.
    pub(super) fn fits(&self, registers: usize) -> bool {
        let is_inside = |order: &Order, Relative { base, more }: Relative, from: usize, to: usize| {
            let at = order.bases[base] as isize + more;
            at >= from as isize && at >= 0 && ((at as usize) + to) < registers
        };
        self.orders.iter().enumerate().all(|(i, order)| {
            let single = self.addresses.iter().chain(self.stores.iter().map(|store| &store.address));
            let of = |value: &Value| match self.operations[*value as usize] {
                Operation::Memory(number) => self.address(number),
                _ => unreachable!("a loop reads memory"),
            };
            single.map(|candidates| candidates.first()).all(|address| is_inside(order, address, 0, 0))
                && self.loops.iter().zip(&self.counts).all(|(one, (runs, means))| {
                    let Relative { base, more } = means.first();
                    count_bases(order.k)[base] as isize + more == runs[i] as isize
                        && one.left.iter().all(|value| is_inside(order, of(value), 0, one.reach(runs[i])[0]))
                        && one.right.iter().all(|value| is_inside(order, of(value), one.reach(runs[i])[1], 0))
                })
        })
    }
}

/// What the lengths of loops are counted from: nothing, the order, and half of it.
pub(super) fn count_bases(k: usize) -> [usize; 3] {
    [0, k, k / 2]
}

/// The registers of the memory of which a recording reads what they held before; none if a loop reads what was written.
pub(super) fn reads(recording: &Recording) -> Option<Vec<bool>> {
    let mut read = vec![false; recording.memory.len()];
    let register = |value: Value| match recording.operations[value as usize] {
        Operation::Memory(register) => Some(register),
        _ => None,
    };
    for &operation in &recording.operations {
        if let Operation::Loop(one) = operation {
            let one @ Loop { sums, left, right, count, .. } = &recording.loops[one];
            let [behind, before] = one.reach(*count);
            sums.iter().filter_map(|&sum| register(sum)).for_each(|sum| read[sum] = true);
            for &value in left {
                let first = register(value)?;
                read.get_mut(first..=first + behind)?
                    .iter_mut()
                    .step_by(one.step())
                    .for_each(|is_read| *is_read = true);
            }
            for &value in right {
                let last = register(value)?;
                let first = last.checked_sub(before)?;
                read[first..=last].iter_mut().step_by(one.step()).for_each(|is_read| *is_read = true);
            }
        }
        operation.map(|value| {
            if let Some(register) = register(value) {
                read[register] = true;
            }
            value
        });
    }
    // what is moved from one register to another
    for (to, &value) in recording.memory.iter().enumerate() {
        if let Some(from) = register(value).filter(|&from| from != to) {
            read[from] = true;
        }
    }
    Some(read)
}

/// Which operations something that is kept depends on.
fn live(recording: &Recording, kept: &[(usize, Value)]) -> Vec<bool> {
    let mut is_live = vec![false; recording.operations.len()];
    kept.iter().for_each(|&(_, value)| is_live[value as usize] = true);
    for (is_live, operation) in is_live.iter_mut().zip(&recording.operations) {
        *is_live |= matches!(operation, Operation::Limit(..));
    }
    for number in (0..recording.operations.len()).rev() {
        if !is_live[number] {
            continue;
        }
        if let Operation::Loop(one) = recording.operations[number] {
            let Loop { sums, left, right, .. } = &recording.loops[one];
            sums.iter().chain(left).chain(right).for_each(|&value| is_live[value as usize] = true);
        }
        recording.operations[number].map(|value| {
            is_live[value as usize] = true;
            value
        });
    }
    is_live
}
