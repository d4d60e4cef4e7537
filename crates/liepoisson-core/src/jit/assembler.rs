//! The instructions that compiled code consists of, as bytes: AVX2 with fused multiply-add (VEX) and AVX-512 (EVEX).
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

/// An operation on packed doubles `d = f(a, b)` or `d = f(d, a, b)`: its map of opcodes, whether AVX2 sets the bit W, its opcode.
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

const SIGNS: Opcode = Opcode(1, false, 0x50);

/// The predicate "larger, and none is NaN".
const LARGER: u8 = 30;
/// The predicate "not equal, or one is NaN".
const NOT_EQUAL: u8 = 4;

/// A place in the code that a jump goes to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jump(usize);

/// Condition codes of jumps.
#[derive(Clone, Copy, Debug)]
pub(super) enum Condition {
    NotBelow = 3,
    Equal = 4,
    NotEqual = 5,
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
            Instructions::Vex => self.vex(opcode, d, a, b, 0),
            Instructions::Evex => self.evex(opcode, d, a, b, 0, 0),
        }
    }

    /// `d = sqrt b`, and other instructions without a second operand.
    pub(super) fn square_root(&mut self, d: u8, b: Place) {
        self.operate(SQRT, d, 0, b);
    }

    pub(super) fn load(&mut self, d: u8, from: Place) {
        let is_constant = matches!(from, Place::Constant(_) | Place::Varying(..));
        let opcode = if is_constant && self.instructions == Instructions::Evex { BROADCAST } else { LOAD };
        match self.instructions {
            Instructions::Vex => self.vex(opcode, d, 0, from, 0),
            // one number is what this instruction reads anyway
            Instructions::Evex if opcode == BROADCAST => self.evex_with(opcode, d, 0, from, 0, (0, false, 8)),
            Instructions::Evex => self.evex(opcode, d, 0, from, 0, 0),
        }
    }

    pub(super) fn store(&mut self, from: u8, to: Place) {
        self.operate(STORE, from, 0, to);
    }

    pub(super) fn zero(&mut self, d: u8) {
        let opcode = if self.instructions == Instructions::Vex { XOR } else { XOR_OF_INTEGERS };
        self.operate(opcode, d, d, Place::Register(d));
    }

    /// `d = value`, zero in the lanes where `other` is zero; `zero` is where that constant is, and `d` another register than `value`.
    pub(super) fn where_not_zero(&mut self, d: u8, value: u8, other: u8, zero: Place) {
        debug_assert!(d != value);
        match self.instructions {
            Instructions::Vex => {
                self.vex(COMPARE, d, other, zero, 1);
                self.code.push(NOT_EQUAL);
                self.vex(AND, d, value, Place::Register(d), 0);
            }
            Instructions::Evex => {
                self.evex(COMPARE, 1, other, zero, 1, 0);
                self.code.push(NOT_EQUAL);
                self.evex_with(LOAD, d, 0, Place::Register(value), 0, (1, false, 64));
            }
        }
    }

    /// A jump that is taken if `value` is larger than `limit` in any lane.
    pub(super) fn jump_if_any_is_larger(&mut self, scratch: u8, value: u8, limit: Place) -> Jump {
        match self.instructions {
            Instructions::Vex => {
                self.vex(COMPARE, scratch, value, limit, 1);
                self.code.push(LARGER);
                self.vex(SIGNS, RAX, 0, Place::Register(scratch), 0);
                self.code.extend([0x85, 0xC0]); // test eax, eax
            }
            Instructions::Evex => {
                self.evex(COMPARE, 1, value, limit, 1, 0);
                self.code.push(LARGER);
                self.code.extend([0xC5, 0xF9, 0x98, 0xC9]); // kortestb k1, k1
            }
        }
        self.jump_if(Condition::NotEqual)
    }

    /// Three bytes of prefix; `n_after` bytes follow the operand.
    fn vex(&mut self, Opcode(map, w, opcode): Opcode, d: u8, a: u8, b: Place, n_after: usize) {
        let third = (u8::from(w) << 7) | ((!a & 15) << 3) | 0b101;
        self.code.extend([0xC4, (!(d >> 3) & 1) << 7 | 1 << 6 | (!(high_bits(b) & 1) & 1) << 5 | map, third, opcode]);
        self.operand(d, b, 1, n_after);
    }

    fn evex(&mut self, opcode: Opcode, d: u8, a: u8, b: Place, n_after: usize, mask: u8) {
        let is_broadcast = matches!(b, Place::Constant(_) | Place::Varying(..));
        self.evex_with(opcode, d, a, b, n_after, (mask, is_broadcast, if is_broadcast { 8 } else { 64 }));
    }

    /// Four bytes of prefix; a mask, which zeroes what it leaves out; whether one number in memory stands for all; the unit of short
    /// displacements.
    fn evex_with(
        &mut self,
        Opcode(map, _, opcode): Opcode,
        d: u8,
        a: u8,
        b: Place,
        n_after: usize,
        (mask, is_broadcast, unit): (u8, bool, i32),
    ) {
        let high = high_bits(b);
        let first = (!(d >> 3) & 1) << 7 | (!(high >> 1) & 1) << 6 | (!high & 1) << 5 | (!(d >> 4) & 1) << 4 | map;
        let second = 1 << 7 | (!a & 15) << 3 | 0b101;
        let third = u8::from(mask > 0) << 7 | 0b10 << 5 | u8::from(is_broadcast) << 4 | (!(a >> 4) & 1) << 3 | mask;
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

    pub(super) fn push_rbx(&mut self) {
        self.code.push(0x53);
    }

    /// Clears the upper halves of the vector registers, gives `rbx` back, and returns whether the code is left before its end.
    pub(super) fn leave(&mut self, is_early: bool) {
        self.code.extend([0xB8, u8::from(is_early), 0, 0, 0]); // mov eax, is_early
        self.clear_upper_halves();
        self.code.extend([0x5B, 0xC3]);
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
mod tests {
    use super::*;

    use Place::{Constant, Memory, Register, Varying};

    /// The forms with each kind of operand, and what an assembler makes of them: `as -o forms.o forms.s`
    /// and `objdump -d forms.o`, GNU Binutils 2.40, of a file with `.intel_syntax noprefix` and these lines.
    fn forms() -> Vec<(Instructions, &'static str, fn(&mut Assembler), &'static str)> {
        let (v, e) = (Instructions::Vex, Instructions::Evex);
        vec![
            (v, "{vex3} vaddpd ymm1, ymm10, ymm3", |a| a.operate(ADD, 1, 10, Register(3)), "c4e12d58cb"),
            (e, "vaddpd zmm1, zmm26, zmm3", |a| a.operate(ADD, 1, 26, Register(3)), "62f1ad4058cb"),
            (v, "{vex3} vmulpd ymm1, ymm10, ymm3", |a| a.operate(MUL, 1, 10, Register(3)), "c4e12d59cb"),
            (e, "vmulpd zmm1, zmm26, zmm3", |a| a.operate(MUL, 1, 26, Register(3)), "62f1ad4059cb"),
            (v, "{vex3} vsubpd ymm1, ymm10, ymm3", |a| a.operate(SUB, 1, 10, Register(3)), "c4e12d5ccb"),
            (e, "vsubpd zmm1, zmm26, zmm3", |a| a.operate(SUB, 1, 26, Register(3)), "62f1ad405ccb"),
            (v, "{vex3} vdivpd ymm1, ymm10, ymm3", |a| a.operate(DIV, 1, 10, Register(3)), "c4e12d5ecb"),
            (e, "vdivpd zmm1, zmm26, zmm3", |a| a.operate(DIV, 1, 26, Register(3)), "62f1ad405ecb"),
            (v, "{vex3} vfmadd132pd ymm1, ymm10, ymm3", |a| a.operate(MUL_ADD_132, 1, 10, Register(3)), "c4e2ad98cb"),
            (e, "vfmadd132pd zmm1, zmm26, zmm3", |a| a.operate(MUL_ADD_132, 1, 26, Register(3)), "62f2ad4098cb"),
            (v, "{vex3} vfmadd213pd ymm1, ymm10, ymm3", |a| a.operate(MUL_ADD_213, 1, 10, Register(3)), "c4e2ada8cb"),
            (e, "vfmadd213pd zmm1, zmm26, zmm3", |a| a.operate(MUL_ADD_213, 1, 26, Register(3)), "62f2ad40a8cb"),
            (v, "{vex3} vfmadd231pd ymm1, ymm10, ymm3", |a| a.operate(MUL_ADD_231, 1, 10, Register(3)), "c4e2adb8cb"),
            (e, "vfmadd231pd zmm1, zmm26, zmm3", |a| a.operate(MUL_ADD_231, 1, 26, Register(3)), "62f2ad40b8cb"),
            (
                v,
                "{vex3} vfnmadd132pd ymm1, ymm10, ymm3",
                |a| a.operate(NEG_MUL_ADD_132, 1, 10, Register(3)),
                "c4e2ad9ccb",
            ),
            (e, "vfnmadd132pd zmm1, zmm26, zmm3", |a| a.operate(NEG_MUL_ADD_132, 1, 26, Register(3)), "62f2ad409ccb"),
            (
                v,
                "{vex3} vfnmadd213pd ymm1, ymm10, ymm3",
                |a| a.operate(NEG_MUL_ADD_213, 1, 10, Register(3)),
                "c4e2adaccb",
            ),
            (e, "vfnmadd213pd zmm1, zmm26, zmm3", |a| a.operate(NEG_MUL_ADD_213, 1, 26, Register(3)), "62f2ad40accb"),
            (
                v,
                "{vex3} vfnmadd231pd ymm1, ymm10, ymm3",
                |a| a.operate(NEG_MUL_ADD_231, 1, 10, Register(3)),
                "c4e2adbccb",
            ),
            (e, "vfnmadd231pd zmm1, zmm26, zmm3", |a| a.operate(NEG_MUL_ADD_231, 1, 26, Register(3)), "62f2ad40bccb"),
            (v, "{vex3} vmulpd ymm9, ymm2, ymm11", |a| a.operate(MUL, 9, 2, Register(11)), "c4416d59cb"),
            (v, "{vex3} vmulpd ymm15, ymm14, ymm8", |a| a.operate(MUL, 15, 14, Register(8)), "c4410d59f8"),
            (v, "{vex3} vmulpd ymm7, ymm0, ymm15", |a| a.operate(MUL, 7, 0, Register(15)), "c4c17d59ff"),
            (e, "vmulpd zmm9, zmm2, zmm31", |a| a.operate(MUL, 9, 2, Register(31)), "6211ed4859cf"),
            (e, "vmulpd zmm31, zmm16, zmm8", |a| a.operate(MUL, 31, 16, Register(8)), "6241fd4059f8"),
            (e, "vmulpd zmm23, zmm8, zmm15", |a| a.operate(MUL, 23, 8, Register(15)), "62c1bd4859ff"),
            (e, "vmulpd zmm0, zmm31, zmm16", |a| a.operate(MUL, 0, 31, Register(16)), "62b1854059c0"),
            (e, "vmulpd zmm16, zmm15, zmm24", |a| a.operate(MUL, 16, 15, Register(24)), "6281854859c0"),
            (v, "{vex3} vsubpd ymm12, ymm3, [rdi+96]", |a| a.operate(SUB, 12, 3, Memory(RDI, 96)), "c461655c6760"),
            (e, "vsubpd zmm28, zmm19, [rdi+192]", |a| a.operate(SUB, 28, 19, Memory(RDI, 192)), "6261e5405c6703"),
            (v, "{vex3} vsubpd ymm12, ymm3, [rsi+96]", |a| a.operate(SUB, 12, 3, Memory(RSI, 96)), "c461655c6660"),
            (e, "vsubpd zmm28, zmm19, [rsi+192]", |a| a.operate(SUB, 28, 19, Memory(RSI, 192)), "6261e5405c6603"),
            (v, "{vex3} vsubpd ymm12, ymm3, [rdx+96]", |a| a.operate(SUB, 12, 3, Memory(RDX, 96)), "c461655c6260"),
            (e, "vsubpd zmm28, zmm19, [rdx+192]", |a| a.operate(SUB, 28, 19, Memory(RDX, 192)), "6261e5405c6203"),
            (v, "{vex3} vsubpd ymm12, ymm3, [r8+96]", |a| a.operate(SUB, 12, 3, Memory(R8, 96)), "c441655c6060"),
            (e, "vsubpd zmm28, zmm19, [r8+192]", |a| a.operate(SUB, 28, 19, Memory(R8, 192)), "6241e5405c6003"),
            (v, "{vex3} vsubpd ymm12, ymm3, [r9+96]", |a| a.operate(SUB, 12, 3, Memory(R9, 96)), "c441655c6160"),
            (e, "vsubpd zmm28, zmm19, [r9+192]", |a| a.operate(SUB, 28, 19, Memory(R9, 192)), "6241e5405c6103"),
            (v, "{vex3} vsubpd ymm12, ymm3, [r10+96]", |a| a.operate(SUB, 12, 3, Memory(R10, 96)), "c441655c6260"),
            (e, "vsubpd zmm28, zmm19, [r10+192]", |a| a.operate(SUB, 28, 19, Memory(R10, 192)), "6241e5405c6203"),
            (v, "{vex3} vsubpd ymm12, ymm3, [r11+96]", |a| a.operate(SUB, 12, 3, Memory(R11, 96)), "c441655c6360"),
            (e, "vsubpd zmm28, zmm19, [r11+192]", |a| a.operate(SUB, 28, 19, Memory(R11, 192)), "6241e5405c6303"),
            (v, "{vex3} vaddpd ymm1, ymm2, [rsi+127]", |a| a.operate(ADD, 1, 2, Memory(RSI, 127)), "c4e16d584e7f"),
            (
                v,
                "{vex3} vaddpd ymm1, ymm2, [rsi+128]",
                |a| a.operate(ADD, 1, 2, Memory(RSI, 128)),
                "c4e16d588e80000000",
            ),
            (v, "{vex3} vaddpd ymm1, ymm2, [rsi-128]", |a| a.operate(ADD, 1, 2, Memory(RSI, -128)), "c4e16d584e80"),
            (
                v,
                "{vex3} vaddpd ymm1, ymm2, [rsi-129]",
                |a| a.operate(ADD, 1, 2, Memory(RSI, -129)),
                "c4e16d588e7fffffff",
            ),
            (
                v,
                "{vex3} vaddpd ymm1, ymm2, [rsi+4096]",
                |a| a.operate(ADD, 1, 2, Memory(RSI, 4096)),
                "c4e16d588e00100000",
            ),
            (v, "{vex3} {disp8} vaddpd ymm1, ymm2, [rsi+0]", |a| a.operate(ADD, 1, 2, Memory(RSI, 0)), "c4e16d584e00"),
            (e, "vaddpd zmm1, zmm2, [rsi+8128]", |a| a.operate(ADD, 1, 2, Memory(RSI, 8128)), "62f1ed48584e7f"),
            (e, "vaddpd zmm1, zmm2, [rsi+8192]", |a| a.operate(ADD, 1, 2, Memory(RSI, 8192)), "62f1ed48588e00200000"),
            (e, "vaddpd zmm1, zmm2, [rsi-8192]", |a| a.operate(ADD, 1, 2, Memory(RSI, -8192)), "62f1ed48584e80"),
            (e, "vaddpd zmm1, zmm2, [rsi-8256]", |a| a.operate(ADD, 1, 2, Memory(RSI, -8256)), "62f1ed48588ec0dfffff"),
            (e, "vaddpd zmm1, zmm2, [rsi+32]", |a| a.operate(ADD, 1, 2, Memory(RSI, 32)), "62f1ed48588e20000000"),
            (
                e,
                "vaddpd zmm1, zmm2, [rsi+6400000]",
                |a| a.operate(ADD, 1, 2, Memory(RSI, 6400000)),
                "62f1ed48588e00a86100",
            ),
            (
                e,
                "vaddpd zmm17, zmm2, [rcx+1016]{1to8}",
                |a| a.operate(ADD, 17, 2, Varying(RCX, 1016)),
                "62e1ed5858497f",
            ),
            (
                e,
                "vaddpd zmm17, zmm2, [rcx+1024]{1to8}",
                |a| a.operate(ADD, 17, 2, Varying(RCX, 1024)),
                "62e1ed58588900040000",
            ),
            (
                e,
                "vaddpd zmm17, zmm2, [rcx-1024]{1to8}",
                |a| a.operate(ADD, 17, 2, Varying(RCX, -1024)),
                "62e1ed58584980",
            ),
            (
                e,
                "vaddpd zmm17, zmm2, [rcx-1032]{1to8}",
                |a| a.operate(ADD, 17, 2, Varying(RCX, -1032)),
                "62e1ed585889f8fbffff",
            ),
            (v, "{vex3} vaddpd ymm13, ymm2, [rcx+64]", |a| a.operate(ADD, 13, 2, Varying(RCX, 64)), "c4616d586940"),
            (v, "{vex3} vdivpd ymm1, ymm2, [rip-73]", |a| a.operate(DIV, 1, 2, Constant(-64)), "c4e16d5e0db7ffffff"),
            (e, "vdivpd zmm1, zmm2, [rip-74]{1to8}", |a| a.operate(DIV, 1, 2, Constant(-64)), "62f1ed585e0db6ffffff"),
            (v, "{vex3} vsqrtpd ymm9, [r9+64]", |a| a.square_root(9, Memory(R9, 64)), "c4417d514940"),
            (e, "vsqrtpd zmm29, zmm30", |a| a.square_root(29, Register(30)), "6201fd4851ee"),
            (v, "{vex3} vmovapd ymm9, ymm10", |a| a.load(9, Register(10)), "c4417d28ca"),
            (e, "vmovapd zmm9, zmm30", |a| a.load(9, Register(30)), "6211fd4828ce"),
            (v, "{vex3} vmovapd ymm9, [rdi-32]", |a| a.load(9, Memory(RDI, -32)), "c4617d284fe0"),
            (e, "vmovapd zmm19, [rdi-64]", |a| a.load(19, Memory(RDI, -64)), "62e1fd48285fff"),
            (v, "{vex3} vmovapd ymm9, [rcx+32]", |a| a.load(9, Varying(RCX, 32)), "c4617d284920"),
            (v, "{vex3} vmovapd ymm9, [rip-41]", |a| a.load(9, Constant(-32)), "c4617d280dd7ffffff"),
            (e, "vbroadcastsd zmm19, qword ptr [rcx+1016]", |a| a.load(19, Varying(RCX, 1016)), "62e2fd4819597f"),
            (e, "vbroadcastsd zmm19, qword ptr [rip-18]", |a| a.load(19, Constant(-8)), "62e2fd48191deeffffff"),
            (v, "{vex3} vmovapd [r8+32], ymm14", |a| a.store(14, Memory(R8, 32)), "c4417d297020"),
            (e, "vmovapd [r8+64], zmm30", |a| a.store(30, Memory(R8, 64)), "6241fd48297001"),
            (v, "{vex3} vxorpd ymm11, ymm11, ymm11", |a| a.zero(11), "c4412557db"),
            (e, "vpxorq zmm27, zmm27, zmm27", |a| a.zero(27), "6201a540efdb"),
            (
                v,
                "{vex3} vcmppd ymm1, ymm12, [rip-42], 4; {vex3} vandpd ymm1, ymm9, ymm1",
                |a| a.where_not_zero(1, 9, 12, Constant(-32)),
                "c4e11dc20dd6ffffff04c4e13554c9",
            ),
            (
                e,
                "vcmppd k1, zmm22, [rip-19]{1to8}, 4; vmovapd zmm21{k1}{z}, zmm19",
                |a| a.where_not_zero(21, 19, 22, Constant(-8)),
                "62f1cd50c20dedffffff0462a1fdc928eb",
            ),
            (v, "mov rdi, [rbx+8]", |a| a.get(RDI, RBX, 8), "488b7b08"),
            (v, "mov r9, [rbx+200]", |a| a.get(R9, RBX, 200), "4c8b8bc8000000"),
            (v, "{disp8} lea r10, [rdi+0]", |a| a.address(R10, RDI, 0), "4c8d5700"),
            (v, "lea r11, [r8+64]", |a| a.address(R11, R8, 64), "4d8d5840"),
            (v, "lea rsi, [rip-39]", |a| a.address_of_constant(RSI, -32), "488d35d9ffffff"),
            (v, "add r10, 64", |a| a.add_to(R10, 64), "4983c240"),
            (v, "add rax, -2", |a| a.add_to(RAX, -2), "4883c0fe"),
            (v, "{load} sub r11, 256", |a| a.subtract_from(R11, 256), "4981eb00010000"),
            (v, "cmp rax, -1", |a| a.compare(RAX, -1), "4883f8ff"),
            (v, "movabs rax, 0x123456789abcdef0", |a| a.set_rax(0x1234_5678_9ABC_DEF0), "48b8f0debc9a78563412"),
            (v, "call rax", |a| a.call_rax(), "ffd0"),
            (v, "push rbx", |a| a.push_rbx(), "53"),
            (v, "mov eax, 0; vzeroupper; pop rbx; ret", |a| a.leave(false), "b800000000c5f8775bc3"),
            (e, "vandpd zmm9, zmm19, [rip-18]{1to8}", |a| a.operate(AND, 9, 19, Constant(-8)), "6271e550540deeffffff"),
            (
                v,
                "{vex3} vcmppd ymm9, ymm12, [rip-42], 30; {vex3} vmovmskpd eax, ymm9; test eax, eax; .byte 0x0f, 0x85, 0, 0, 0, 0",
                |a| _ = a.jump_if_any_is_larger(9, 12, Constant(-32)),
                "c4611dc20dd6ffffff1ec4c17d50c185c00f8500000000",
            ),
            (
                e,
                "vcmppd k1, zmm22, [rip-19]{1to8}, 30; kortestb k1, k1; .byte 0x0f, 0x85, 0, 0, 0, 0",
                |a| _ = a.jump_if_any_is_larger(9, 22, Constant(-8)),
                "62f1cd50c20dedffffff1ec5f998c90f8500000000",
            ),
        ]
    }

    fn hexadecimal(bytes: &[u8]) -> String {
        bytes.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    #[test]
    fn instructions_have_the_bytes_of_an_assembler() {
        for (instructions, text, emit, bytes) in forms() {
            let mut assembler = Assembler::new(instructions);
            emit(&mut assembler);
            assert_eq!(hexadecimal(&assembler.code), bytes, "{text}");
        }
    }

    #[test]
    fn jumps_go_where_they_land() {
        let mut assembler = Assembler::new(Instructions::Vex);
        let jump = assembler.jump_if(Condition::Equal);
        assembler.align();
        let here = assembler.code.len();
        assembler.jump_back_if(Condition::NotBelow, here);
        assembler.land(jump);
        assert_eq!(hexadecimal(&assembler.code[..6]), format!("0f84{}", hexadecimal(&32_i32.to_le_bytes())));
        assert_eq!((here, hexadecimal(&assembler.code[32..])), (32, "0f83faffffff".to_owned()));
    }
}
