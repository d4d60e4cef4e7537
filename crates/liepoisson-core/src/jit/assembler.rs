//! The instructions that compiled code consists of, as bytes: AVX2 with fused multiply-add (VEX), on four numbers or on one, and
//! AVX-512 (EVEX).
//!
//! # References
//! *Intel 64 and IA-32 Architectures Software Developer's Manual*, volume 2, sections 2.3 (VEX), 2.7 (EVEX, its displacements of
//! eight bits in units of the operand), and the entries of the instructions.

use crate::lanes::Instructions;

/// A general register: number 0 to 15.
pub(super) type General = u8;

pub(super) const RAX: General = 0;
pub(super) const RCX: General = 1;
pub(super) const RDX: General = 2;
pub(super) const RBX: General = 3;
const RSP: General = 4;
pub(super) const RSI: General = 6;
pub(super) const RDI: General = 7;
pub(super) const R8: General = 8;
pub(super) const R9: General = 9;
pub(super) const R10: General = 10;
pub(super) const R11: General = 11;

/// Where a vector is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// In a vector register.
    Register(u8),
    /// In memory, some bytes from a general register.
    Memory(General, i32),
    /// So many bytes from the start of the code, and before it: a constant.
    Constant(i32),
    /// At this byte from a general register: a constant that depends on the order.
    Varying(General, i32),
}

/// An operation on packed doubles `d = f(a, b)` or `d = f(d, a, b)`: its map of opcodes, whether AVX2 sets the bit W, its opcode. Its
/// form for one number is [`Opcode::of_one`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Opcode(u8, bool, u8);

pub(super) const ADD: Opcode = Opcode(1, false, 0x58);
pub(super) const MUL: Opcode = Opcode(1, false, 0x59);
pub(super) const SUB: Opcode = Opcode(1, false, 0x5C);
pub(super) const DIV: Opcode = Opcode(1, false, 0x5E);
/// `d = sqrt b`
pub(super) const SQRT: Opcode = Opcode(1, false, 0x51);
pub(super) const AND: Opcode = Opcode(1, false, 0x54);
const XOR: Opcode = Opcode(1, false, 0x57);
const XOR_OF_INTEGERS: Opcode = Opcode(1, false, 0xEF);
const LOAD: Opcode = Opcode(1, false, 0x28);
const STORE: Opcode = Opcode(1, false, 0x29);
const BROADCAST: Opcode = Opcode(2, false, 0x19);
const COMPARE: Opcode = Opcode(1, false, 0xC2);
/// `d = d b + a`
pub(super) const MUL_ADD_132: Opcode = Opcode(2, true, 0x98);
/// `d = a d + b`
pub(super) const MUL_ADD_213: Opcode = Opcode(2, true, 0xA8);
/// `d = a b + d`
pub(super) const MUL_ADD_231: Opcode = Opcode(2, true, 0xB8);
/// `d = a - d b`
pub(super) const NEG_MUL_ADD_132: Opcode = Opcode(2, true, 0x9C);
/// `d = b - a d`
pub(super) const NEG_MUL_ADD_213: Opcode = Opcode(2, true, 0xAC);
/// `d = d - a b`
pub(super) const NEG_MUL_ADD_231: Opcode = Opcode(2, true, 0xBC);

pub(super) const ADD_OF_INTEGERS: Opcode = Opcode(1, false, 0xD4);
const SHIFT_LEFT: Opcode = Opcode(1, false, 0x73);
const SIGNS: Opcode = Opcode(1, false, 0x50);

/// The predicate "larger, and none is NaN".
const LARGER: u8 = 30;

/// Compares two numbers, and sets the conditions as for numbers without a sign; with NaN as if the first were smaller.
const COMPARE_ONE: Opcode = Opcode(1, false, 0x2E);
/// Loads and stores of one number.
const LOAD_ONE: Opcode = Opcode(1, false, 0x10);
const STORE_ONE: Opcode = Opcode(1, false, 0x11);

const LOAD_TWICE: Opcode = Opcode(1, false, 0x12);
const LOAD_SECOND: Opcode = Opcode(1, false, 0x16);
const LOAD_FIRST: Opcode = Opcode(1, false, 0x7E);
const FIRSTS: Opcode = Opcode(1, false, 0x14);
const SECONDS: Opcode = Opcode(1, false, 0x15);

/// The lowest bits of the third byte of a VEX prefix, the length of registers and what was a prefix of its own: four packed numbers, two
/// of them, and one.
const FOUR: u8 = 0b101;
const TWO: u8 = 0b001;
const ONE: u8 = 0b011;
/// The first of two numbers.
const FIRST: u8 = 0b010;

impl Opcode {
    /// The form for one number, and the bits of its prefix. What works on bits does so on two numbers, of which the second is none.
    fn of_one(self, b: Place) -> (Opcode, u8) {
        match self {
            ADD | SUB | MUL | DIV | SQRT => (self, ONE),
            LOAD if !matches!(b, Place::Register(_)) => (LOAD_ONE, ONE),
            STORE => (STORE_ONE, ONE),
            // the prefix of the packed forms
            Opcode(2, w, multiply_add) => (Opcode(2, w, multiply_add | 1), TWO),
            _ => (self, TWO),
        }
    }
}

/// A place in the code that a jump goes to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jump(usize);

/// Condition codes of jumps.
#[derive(Clone, Copy, Debug)]
pub(super) enum Condition {
    NotBelow = 3,
    Equal = 4,
    NotEqual = 5,
    Above = 7,
    /// Of numbers with a sign.
    Less = 12,
}

pub(super) struct Assembler {
    pub(super) instructions: Instructions,
    pub(super) code: Vec<u8>,
}

impl Assembler {
    pub(super) fn new(instructions: Instructions) -> Assembler {
        Assembler { instructions, code: vec![] }
    }

    /// `d = f(a, b)`
    pub(super) fn operate(&mut self, opcode: Opcode, d: u8, a: u8, b: Place) {
        match self.instructions {
            Instructions::Vex => self.vex(opcode, d, a, b, 0, FOUR),
            Instructions::Evex => self.evex(opcode, d, a, b, 0),
            Instructions::VexOne => {
                let (opcode, kind) = opcode.of_one(b);
                self.vex(opcode, d, a, b, 0, kind);
            }
        }
    }

    /// `d = sqrt b`, and other instructions without a second operand.
    pub(super) fn square_root(&mut self, d: u8, b: Place) {
        // the form for one number takes the rest of its result from a register: one that it waits for anyway
        let rest = match (self.instructions, b) {
            (Instructions::VexOne, Place::Register(from)) => from,
            (Instructions::VexOne, _) => d,
            _ => 0,
        };
        self.operate(SQRT, d, rest, b);
    }

    pub(super) fn load(&mut self, d: u8, from: Place) {
        let is_constant = matches!(from, Place::Constant(_) | Place::Varying(..));
        let opcode = if is_constant && self.instructions == Instructions::Evex { BROADCAST } else { LOAD };
        match self.instructions {
            Instructions::Vex | Instructions::VexOne => self.operate(opcode, d, 0, from),
            // one number is what this instruction reads anyway
            Instructions::Evex if opcode == BROADCAST => self.evex_with(opcode, d, 0, from, 0, (false, 8)),
            Instructions::Evex => self.evex(opcode, d, 0, from, 0),
        }
    }

    pub(super) fn store(&mut self, from: u8, to: Place) {
        self.operate(STORE, from, 0, to);
    }

    pub(super) fn zero(&mut self, d: u8) {
        let opcode = if self.instructions == Instructions::Evex { XOR_OF_INTEGERS } else { XOR };
        self.operate(opcode, d, d, Place::Register(d));
    }

    // ---- two numbers in a register of which others hold one ----

    /// `d = (number, number)`, from memory.
    pub(super) fn load_twice(&mut self, d: u8, from: Place) {
        self.vex(LOAD_TWICE, d, 0, from, 0, ONE);
    }

    /// `d = (first of d, number)`, from memory.
    pub(super) fn load_second(&mut self, d: u8, from: Place) {
        self.vex(LOAD_SECOND, d, d, from, 0, TWO);
    }

    /// `d = (first of d, 0)`
    pub(super) fn clear_second(&mut self, d: u8) {
        self.vex(LOAD_FIRST, d, 0, Place::Register(d), 0, FIRST);
    }

    /// `d = (first of d, first of a)`
    pub(super) fn put_second(&mut self, d: u8, a: u8) {
        self.vex(FIRSTS, d, d, Place::Register(a), 0, TWO);
    }

    /// `d = (second of a, second of a)`
    pub(super) fn take_second(&mut self, d: u8, a: u8) {
        self.vex(SECONDS, d, a, Place::Register(a), 0, TWO);
    }

    /// `d = a b + d`, of two numbers.
    pub(super) fn multiply_add_two(&mut self, d: u8, a: u8, b: Place) {
        self.vex(MUL_ADD_231, d, a, b, 0, TWO);
    }

    /// `d = a` as integers, times `2^52`.
    pub(super) fn shift_to_exponents(&mut self, d: u8, a: u8) {
        /// What is part of the opcode in the place of a register.
        const LEFT: u8 = 6;
        match self.instructions {
            Instructions::Vex => self.vex(SHIFT_LEFT, LEFT, d, Place::Register(a), 1, FOUR),
            Instructions::VexOne => self.vex(SHIFT_LEFT, LEFT, d, Place::Register(a), 1, TWO),
            Instructions::Evex => self.evex(SHIFT_LEFT, LEFT, d, Place::Register(a), 1),
        }
        self.code.push(52);
    }

    /// A jump that is taken if `value` is larger than `limit` in any lane.
    pub(super) fn jump_if_any_is_larger(&mut self, scratch: u8, value: u8, limit: Place) -> Jump {
        match self.instructions {
            Instructions::Vex => {
                self.vex(COMPARE, scratch, value, limit, 1, FOUR);
                self.code.push(LARGER);
                self.vex(SIGNS, RAX, 0, Place::Register(scratch), 0, FOUR);
                self.code.extend([0x85, 0xC0]); // test eax, eax
            }
            Instructions::Evex => {
                self.evex(COMPARE, 1, value, limit, 1);
                self.code.push(LARGER);
                self.code.extend([0xC5, 0xF9, 0x98, 0xC9]); // kortestb k1, k1
            }
            Instructions::VexOne => {
                self.vex(COMPARE_ONE, value, 0, limit, 0, TWO);
                return self.jump_if(Condition::Above);
            }
        }
        self.jump_if(Condition::NotEqual)
    }

    /// Three bytes of prefix, of which the last ends with the bits of `kind`; `n_after` bytes follow the operand.
    fn vex(&mut self, Opcode(map, w, opcode): Opcode, d: u8, a: u8, b: Place, n_after: usize, kind: u8) {
        let third = (u8::from(w) << 7) | ((!a & 15) << 3) | kind;
        self.code.extend([0xC4, (!(d >> 3) & 1) << 7 | 1 << 6 | (!(high_bits(b) & 1) & 1) << 5 | map, third, opcode]);
        self.operand(d, b, 1, n_after);
    }

    fn evex(&mut self, opcode: Opcode, d: u8, a: u8, b: Place, n_after: usize) {
        let is_broadcast = matches!(b, Place::Constant(_) | Place::Varying(..));
        self.evex_with(opcode, d, a, b, n_after, (is_broadcast, if is_broadcast { 8 } else { 64 }));
    }

    /// Four bytes of prefix; whether one number in memory stands for all, and the unit of short displacements.
    fn evex_with(
        &mut self,
        Opcode(map, _, opcode): Opcode,
        d: u8,
        a: u8,
        b: Place,
        n_after: usize,
        (is_broadcast, unit): (bool, i32),
    ) {
        let high = high_bits(b);
        let first = (!(d >> 3) & 1) << 7 | (!(high >> 1) & 1) << 6 | (!high & 1) << 5 | (!(d >> 4) & 1) << 4 | map;
        let second = 1 << 7 | (!a & 15) << 3 | 0b101;
        let third = 0b10 << 5 | u8::from(is_broadcast) << 4 | (!(a >> 4) & 1) << 3;
        self.code.extend([0x62, first, second, third, opcode]);
        self.operand(d, b, unit, n_after);
    }

    fn operand(&mut self, d: u8, b: Place, unit: i32, n_after: usize) {
        match b {
            Place::Register(r) => self.code.push(0xC0 | (d & 7) << 3 | r & 7),
            Place::Memory(base, displacement) | Place::Varying(base, displacement) => {
                self.displaced(d, base, displacement, unit);
            }
            Place::Constant(at) => {
                self.code.push((d & 7) << 3 | 0b101);
                let next = self.code.len() + 4 + n_after;
                self.code.extend((at - next as i32).to_le_bytes());
            }
        }
    }

    /// `[base + displacement]`, of eight bits where it is a small multiple of the unit.
    fn displaced(&mut self, d: u8, base: General, displacement: i32, unit: i32) {
        debug_assert!(base & 7 != 4, "a base that needs another byte");
        let middle = (d & 7) << 3 | base & 7;
        match i8::try_from(displacement / unit) {
            Ok(short) if displacement % unit == 0 => self.code.extend([0x40 | middle, short as u8]),
            _ => {
                self.code.push(0x80 | middle);
                self.code.extend(displacement.to_le_bytes());
            }
        }
    }

    // ---- general registers ----

    fn general(&mut self, opcode: u8, register: General, base: General, displacement: i32) {
        self.code.extend([0x48 | (register >> 3) << 2 | base >> 3, opcode]);
        self.displaced(register, base, displacement, 1);
    }

    /// `to = [base + displacement]`
    pub(super) fn get(&mut self, to: General, base: General, displacement: i32) {
        self.general(0x8B, to, base, displacement);
    }

    /// `to = base + displacement`
    pub(super) fn address(&mut self, to: General, base: General, displacement: i32) {
        self.general(0x8D, to, base, displacement);
    }

    /// `to = the address so many bytes from the start of the code`
    pub(super) fn address_of_constant(&mut self, to: General, at: i32) {
        self.code.extend([0x48 | (to >> 3) << 2, 0x8D]);
        self.operand(to, Place::Constant(at), 1, 0);
    }

    /// `to += number`, which sets the conditions as a comparison of `to` with `-number` does.
    pub(super) fn add_to(&mut self, to: General, number: i32) {
        self.with_number(0, to, number);
    }

    /// `to -= number`, which sets the conditions.
    pub(super) fn subtract_from(&mut self, to: General, number: i32) {
        self.with_number(5, to, number);
    }

    pub(super) fn compare(&mut self, register: General, number: i32) {
        self.with_number(7, register, number);
    }

    fn with_number(&mut self, operation: u8, to: General, number: i32) {
        let prefix = 0x48 | to >> 3;
        let middle = 0xC0 | operation << 3 | to & 7;
        match i8::try_from(number) {
            Ok(short) => self.code.extend([prefix, 0x83, middle, short as u8]),
            Err(_) => {
                self.code.extend([prefix, 0x81, middle]);
                self.code.extend(number.to_le_bytes());
            }
        }
    }

    /// `rax = number`
    pub(super) fn set_rax(&mut self, number: u64) {
        self.code.extend([0x48, 0xB8]);
        self.code.extend(number.to_le_bytes());
    }

    pub(super) fn call_rax(&mut self) {
        self.code.extend([0xFF, 0xD0]);
    }

    /// Calls what begins at this byte of the code.
    pub(super) fn call(&mut self, to: usize) {
        self.code.push(0xE8);
        let distance = to as i64 - (self.code.len() as i64 + 4);
        self.code.extend((distance as i32).to_le_bytes());
    }

    pub(super) fn give_back(&mut self) {
        self.code.push(0xC3);
    }

    pub(super) fn push(&mut self, register: General) {
        self.with_short(0x50, register);
    }

    pub(super) fn pop(&mut self, register: General) {
        self.with_short(0x58, register);
    }

    fn with_short(&mut self, opcode: u8, register: General) {
        if register > 7 {
            self.code.push(0x41);
        }
        self.code.push(opcode | register & 7);
    }

    /// Clears the upper halves of the vector registers, gives `rbx` back, and returns `result`.
    pub(super) fn leave(&mut self, result: u8) {
        self.code.extend([0xB8, result, 0, 0, 0]); // mov eax, result
        self.clear_upper_halves();
        self.pop(RBX);
        self.give_back();
    }

    /// Drops the address that a call has left.
    pub(super) fn drop_return(&mut self) {
        self.add_to(RSP, 8);
    }

    pub(super) fn clear_upper_halves(&mut self) {
        self.code.extend([0xC5, 0xF8, 0x77]);
    }

    pub(super) fn jump_if(&mut self, condition: Condition) -> Jump {
        self.code.extend([0x0F, 0x80 | condition as u8, 0, 0, 0, 0]);
        Jump(self.code.len())
    }

    /// The jump goes to here.
    pub(super) fn land(&mut self, Jump(after): Jump) {
        let distance = (self.code.len() - after) as i32;
        self.code[after - 4..after].copy_from_slice(&distance.to_le_bytes());
    }

    pub(super) fn jump_back_if(&mut self, condition: Condition, to: usize) {
        self.code.extend([0x0F, 0x80 | condition as u8]);
        let distance = to as i64 - (self.code.len() as i64 + 4);
        self.code.extend((distance as i32).to_le_bytes());
    }

    /// Fills up to a multiple of 32 bytes, counted from the start of the code.
    pub(super) fn align(&mut self) {
        /// Instructions that do nothing, of one to eight bytes.
        const NOTHING: [&[u8]; 8] = [
            &[0x90],
            &[0x66, 0x90],
            &[0x0F, 0x1F, 0x00],
            &[0x0F, 0x1F, 0x40, 0x00],
            &[0x0F, 0x1F, 0x44, 0x00, 0x00],
            &[0x66, 0x0F, 0x1F, 0x44, 0x00, 0x00],
            &[0x0F, 0x1F, 0x80, 0x00, 0x00, 0x00, 0x00],
            &[0x0F, 0x1F, 0x84, 0x00, 0x00, 0x00, 0x00, 0x00],
        ];
        while !self.code.len().is_multiple_of(32) {
            let missing = 32 - self.code.len() % 32;
            self.code.extend(NOTHING[missing.min(8) - 1]);
        }
    }
}

/// The bits of a register's number beyond the lowest three.
fn high_bits(b: Place) -> u8 {
    match b {
        Place::Register(r) => r >> 3,
        Place::Memory(base, _) | Place::Varying(base, _) => base >> 3,
        Place::Constant(_) => 0,
    }
}

#[cfg(test)]
mod tests;
