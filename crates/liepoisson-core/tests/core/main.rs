//! The tests of the core through its public face, in one program: the kernels are generic, so that each program that uses
//! them compiles them anew.

mod common;
mod enclosure;
mod ensemble;
mod formula;
mod frame;
mod gauss;
mod mixed_taylor;
mod modular;
mod own_parameters;
mod quadratic;
mod runge_kutta;
mod runge_kutta_fields;
mod same_bits;
mod section;
mod splitting;
mod tangent_frames;
mod tape;
mod taylor;
mod top;
mod units;
