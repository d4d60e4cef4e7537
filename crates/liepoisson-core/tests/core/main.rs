//! The tests of the core through its public face, in one program: the kernels are generic, so that each program that uses
//! them compiles them anew.

//TMP mod common;
//TMP mod enclosure;
//TMP mod ensemble;
mod formula;
//TMP mod frame;
//TMP mod gauss;
//TMP mod mixed_taylor;
//TMP mod modular;
//TMP mod own_parameters;
//TMP mod quadratic;
//TMP mod runge_kutta;
//TMP mod runge_kutta_fields;
//TMP mod same_bits;
//TMP mod section;
//TMP mod splitting;
//TMP mod tangent_frames;
//TMP mod tape;
//TMP mod taylor;
//TMP mod top;
//TMP mod units;
