//! WebAssembly shell over `liepoisson-core`: plain C exports, arrays in, tables of arrays out, no formulas.
//!
//! Whatever comes in or goes out is a thing with a number, its handle. JavaScript makes an array ([`lp_numbers`], [`lp_bytes`]),
//! writes into it where [`lp_pointer`] says, and hands its handle over; no pointer comes in, so none can be wrong. A call returns
//! a handle, or a negative number: [`lp_refusals`] has the names of these, and [`lp_message`] what the last one has to say. A panic,
//! which is a mistake in the core, stops the instance; its message can still be read. Growing memory moves it, so views of
//! it have to be made anew after each call.

mod describe;
mod json;
mod projection;
mod refusal;
mod runs;
mod table;
mod typed;
mod written;

use crate::refusal::{Kind, Refusal};
use crate::table::{Thing, keep, say};
use liepoisson_core::analysis::filled;
use liepoisson_core::analysis::verdict::Question;
use liepoisson_core::choice::AnyField;
use liepoisson_core::ensemble::Outcome;
use liepoisson_core::field::Functions;
use liepoisson_core::formula::{Lines, names_of};
use std::cell::RefCell;
use std::rc::Rc;

/// A handle, or the kind of a refusal, whose message is kept.
fn answer(result: Result<Thing, Refusal>) -> i32 {
    match result {
        Ok(thing) => keep(thing),
        Err(Refusal { kind, message, place }) => {
            say(message);
            table::point_at(place.unwrap_or(-1));
            kind as i32
        }
    }
}

fn bytes(bytes: Vec<u8>) -> Thing {
    Thing::Bytes(Rc::new(RefCell::new(bytes)))
}

fn text(text: String) -> Result<Thing, Refusal> {
    Ok(bytes(text.into_bytes()))
}

fn numbers(numbers: Vec<f64>) -> Thing {
    Thing::Numbers(Rc::new(RefCell::new(numbers)))
}

fn table(table: runs::Table) -> Thing {
    Thing::Table(Rc::new(table))
}

/// To be called once, before all else: keeps the message of a panic. The version of this interface.
#[unsafe(no_mangle)]
pub extern "C" fn lp_start() -> i32 {
    std::panic::set_hook(Box::new(|panic| say(panic.to_string())));
    6
}

/// Room for a text.
#[unsafe(no_mangle)]
pub extern "C" fn lp_bytes(len: u32) -> i32 {
    answer(filled(len as usize, 0).map(bytes).map_err(Refusal::from))
}

/// Room for numbers of double precision.
#[unsafe(no_mangle)]
pub extern "C" fn lp_numbers(len: u32) -> i32 {
    answer(filled(len as usize, 0.0).map(numbers).map_err(Refusal::from))
}

/// Where a text or numbers are in memory; 0 of anything else.
#[unsafe(no_mangle)]
pub extern "C" fn lp_pointer(handle: i32) -> usize {
    match table::thing(handle) {
        Some(Thing::Bytes(bytes)) => bytes.borrow().as_ptr().addr(),
        Some(Thing::Numbers(numbers)) => numbers.borrow().as_ptr().addr(),
        _ => 0,
    }
}

/// How many bytes or numbers there are; 0 of anything else.
#[unsafe(no_mangle)]
pub extern "C" fn lp_length(handle: i32) -> usize {
    match table::thing(handle) {
        Some(Thing::Bytes(bytes)) => bytes.borrow().len(),
        Some(Thing::Numbers(numbers)) => numbers.borrow().len(),
        _ => 0,
    }
}

/// Gives a thing back; nothing if there is none.
#[unsafe(no_mangle)]
pub extern "C" fn lp_free(handle: i32) {
    table::forget(handle);
}

/// Where the message of the last refusal, or of a panic, is.
#[unsafe(no_mangle)]
pub extern "C" fn lp_message() -> usize {
    table::message().0.addr()
}

/// Its length in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn lp_message_length() -> usize {
    table::message().1
}

/// Where in the text of a formula the last refusal points, as JavaScript counts; -1 if something else was refused.
#[unsafe(no_mangle)]
pub extern "C" fn lp_message_place() -> i32 {
    table::place()
}

/// The names of refusals: that of -1 first, one a line.
#[unsafe(no_mangle)]
pub extern "C" fn lp_refusals() -> i32 {
    answer(text(Kind::NAMES.join("\n")))
}

/// The names of outcomes: that of 0 first, one a line.
#[unsafe(no_mangle)]
pub extern "C" fn lp_outcomes() -> i32 {
    answer(text(Outcome::ALL.map(Outcome::name).join("\n")))
}

/// A field from its description.
#[unsafe(no_mangle)]
pub extern "C" fn lp_field(description: i32) -> i32 {
    answer(table::bytes(description).and_then(|text| Ok(Thing::Field(Rc::new(describe::read_field(&text.borrow())?)))))
}

/// Functions on phase space from their description.
#[unsafe(no_mangle)]
pub extern "C" fn lp_functions(description: i32) -> i32 {
    let read = |text: Rc<RefCell<Vec<u8>>>| Ok(Thing::Functions(Rc::new(describe::read_functions(&text.borrow())?)));
    answer(table::bytes(description).and_then(read))
}

/// A method from its description.
#[unsafe(no_mangle)]
pub extern "C" fn lp_method(description: i32) -> i32 {
    answer(table::bytes(description).and_then(|text| Ok(Thing::Method(describe::read_method(&text.borrow())?))))
}

/// A system from its description: a bracket, a formula, parameters.
#[unsafe(no_mangle)]
pub extern "C" fn lp_system(description: i32) -> i32 {
    let read = |text: Rc<RefCell<Vec<u8>>>| Ok(Thing::System(Rc::new(typed::read_system(&text.borrow())?)));
    answer(table::bytes(description).and_then(read))
}

/// The coordinates of a system and their rates of change as formulas: `name tab formula`, one a line.
#[unsafe(no_mangle)]
pub extern "C" fn lp_system_equations(system: i32) -> i32 {
    let run = || {
        let system = table::system(system)?;
        let rates = system.equations()?;
        let lines = system.coordinates().into_iter().zip(rates).map(|(name, rate)| format!("{name}\t{rate}"));
        text(lines.collect::<Vec<_>>().join("\n"))
    };
    answer(run())
}

/// A system as it is written: its coordinates, Hamiltonian, equations and Poisson tensor as JSON.
#[unsafe(no_mangle)]
pub extern "C" fn lp_system_written(system: i32) -> i32 {
    answer(table::system(system).and_then(|system| text(written::system(&system)?)))
}

/// The record of the field of a system: JSON that [`lp_field`] reads.
#[unsafe(no_mangle)]
pub extern "C" fn lp_system_field_record(system: i32) -> i32 {
    answer(table::system(system).and_then(|system| text(written::field(&system.field()?))))
}

/// The record of functions on the phase space of a system, from their texts: JSON that [`lp_functions`] reads.
#[unsafe(no_mangle)]
pub extern "C" fn lp_system_functions_record(system: i32, description: i32) -> i32 {
    answer(functions_of(system, description).and_then(|lines| text(written::functions(&lines))))
}

/// The names in a formula that are not those of functions, one a line.
#[unsafe(no_mangle)]
pub extern "C" fn lp_names(formula: i32) -> i32 {
    let run = || {
        let bytes = table::bytes(formula)?;
        text(names_of(&typed::read_text(&bytes.borrow())?)?.join("\n"))
    };
    answer(run())
}

/// The field of a system.
#[unsafe(no_mangle)]
pub extern "C" fn lp_system_field(system: i32) -> i32 {
    answer(table::system(system).and_then(|system| Ok(Thing::Field(Rc::new(AnyField::try_from(system.field()?)?)))))
}

/// Functions on the phase space of a system, from their texts.
#[unsafe(no_mangle)]
pub extern "C" fn lp_system_functions(system: i32, description: i32) -> i32 {
    let run = || Ok(Thing::Functions(Rc::new(Functions::try_from(functions_of(system, description)?)?)));
    answer(run())
}

fn functions_of(system: i32, description: i32) -> Result<Lines, Refusal> {
    let (system, description) = (table::system(system)?, table::bytes(description)?);
    let texts = typed::read_texts(&description.borrow())?;
    let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
    Ok(system.functions(&texts)?)
}

/// Components of the state of a field or of functions; 0 of anything else.
#[unsafe(no_mangle)]
pub extern "C" fn lp_n_components(handle: i32) -> usize {
    match table::thing(handle) {
        Some(Thing::Field(field)) => field.n_components(),
        Some(Thing::Functions(functions)) => functions.n_components(),
        _ => 0,
    }
}

/// How many functions there are; 0 of anything else.
#[unsafe(no_mangle)]
pub extern "C" fn lp_n_functions(handle: i32) -> usize {
    table::functions(handle).map_or(0, |functions| functions.n_functions())
}

/// Numbers: rates of change at states, `(state, component)`.
#[unsafe(no_mangle)]
pub extern "C" fn lp_rates(field: i32, method: i32, states: i32) -> i32 {
    let run = || {
        let (field, method, states) = (table::field(field)?, table::method(method)?, table::numbers(states)?);
        Ok(numbers(runs::rates(&field, method, &states.borrow())?))
    };
    answer(run())
}

/// Numbers: values of functions at states, `(state, function)`.
#[unsafe(no_mangle)]
pub extern "C" fn lp_values(functions: i32, states: i32) -> i32 {
    let run = || Ok(numbers(runs::values(&*table::functions(functions)?, &table::numbers(states)?.borrow())?));
    answer(run())
}

/// A result: the state nearest to first order at which each function has its value; as many of the first components move as
/// there are `units`, in which lengths are measured. Its parts are `[state, residual]`, the residuals relative.
#[unsafe(no_mangle)]
pub extern "C" fn lp_project(functions: i32, state: i32, values: i32, units: i32) -> i32 {
    let run = || {
        let functions = table::functions(functions)?;
        let [state, values, units] = [state, values, units].map(table::numbers);
        let (state, values, units) = (state?, values?, units?);
        let parts = projection::project(&functions, &state.borrow(), &values.borrow(), &units.borrow())?;
        Ok(table(runs::Table::of(parts)))
    };
    answer(run())
}

/// A result: orbits at `times`. Its parts are `[outcome, end_time, n_steps, end_state, state, tangent, step_time, series]`.
#[unsafe(no_mangle)]
pub extern "C" fn lp_orbits(
    field: i32,
    method: i32,
    states: i32,
    tangents: i32,
    n_tangents: u32,
    times: i32,
    dense: u32,
) -> i32 {
    let run = || {
        let (field, method) = (table::field(field)?, table::method(method)?);
        let [states, tangents, times] = [states, tangents, times].map(table::numbers);
        let (states, tangents, times) = (states?, tangents?, times?);
        let (states, tangents, times) = (states.borrow(), tangents.borrow(), times.borrow());
        runs::orbits(&field, method, &states, &tangents, n_tangents as usize, &times, dense != 0).map(table)
    };
    answer(run())
}

/// Numbers: states of an orbit with dense output at `times`, `(time, component)`.
#[unsafe(no_mangle)]
pub extern "C" fn lp_states_at(orbit: i32, times: i32) -> i32 {
    let run = || Ok(numbers(runs::states_at(&*table::table(orbit)?, &table::numbers(times)?.borrow())?));
    answer(run())
}

/// A result: finite-time exponents at `times` after the first. Its parts are `[outcome, end_time, n_steps, end_state, exponent]`.
#[unsafe(no_mangle)]
pub extern "C" fn lp_exponents(field: i32, method: i32, states: i32, tangents: i32, times: i32) -> i32 {
    let run = || {
        let (field, method) = (table::field(field)?, table::method(method)?);
        let [states, tangents, times] = [states, tangents, times].map(table::numbers);
        let (states, tangents, times) = (states?, tangents?, times?);
        runs::exponents(&field, method, &states.borrow(), &tangents.borrow(), &times.borrow()).map(table)
    };
    answer(run())
}

/// A result: frames of tangent vectors, `(trajectory, component, vector)`, orthonormal after each of `n_intervals` intervals of
/// length `duration`, to go on with. Its parts are `[outcome, end_time, n_steps, end_state, growth, frame, n_complete]`.
#[unsafe(no_mangle)]
pub extern "C" fn lp_frames(
    field: i32,
    method: i32,
    states: i32,
    frames: i32,
    n_vectors: u32,
    elapsed: i32,
    duration: f64,
    n_intervals: u32,
) -> i32 {
    let run = || {
        let (field, method) = (table::field(field)?, table::method(method)?);
        let [states, frames, elapsed] = [states, frames, elapsed].map(table::numbers);
        let (states, frames, elapsed) = (states?, frames?, elapsed?);
        let (states, frames, elapsed) = (states.borrow(), frames.borrow(), elapsed.borrow());
        let (n_vectors, n_intervals) = (n_vectors as usize, n_intervals as usize);
        runs::frames(&field, method, &states, &frames, n_vectors, &elapsed, duration, n_intervals).map(table)
    };
    answer(run())
}

/// A result: crossings of the surface where the first function is zero and, if `has_guard` is not 0, the second is positive; the
/// others are kept of each, or the state if there are none. `n_crossings` 0 is no limit; `sides` may be empty. Its parts are
/// `[outcome, end_time, n_steps, end_state, count, time, state, sign, touch_count, touch_time, touch_state, side, seen_to,
/// unresolved_time, undefined_time, unbounded_steps, unseen_steps, in_surface]`.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)] // flat, as C has it
pub extern "C" fn lp_section(
    field: i32,
    method: i32,
    functions: i32,
    has_guard: u32,
    direction: i32,
    n_crossings: u32,
    states: i32,
    sides: i32,
    times: i32,
) -> i32 {
    let run = || {
        let (field, method, functions) = (table::field(field)?, table::method(method)?, table::functions(functions)?);
        let [states, sides, times] = [states, sides, times].map(table::numbers);
        let (states, sides, times) = (states?, sides?, times?);
        let (states, sides, times) = (states.borrow(), sides.borrow(), times.borrow());
        let (has_guard, n_crossings) = (has_guard != 0, n_crossings as usize);
        runs::section(&field, method, &functions, has_guard, direction, n_crossings, &states, &sides, &times).map(table)
    };
    answer(run())
}

/// A result: units of time and of each component along the orbits from states. Its parts are `[time, component]`.
#[unsafe(no_mangle)]
pub extern "C" fn lp_units(field: i32, method: i32, states: i32, periods: i32) -> i32 {
    let run = || {
        let (field, method) = (table::field(field)?, table::method(method)?);
        let (states, periods) = (table::numbers(states)?, table::numbers(periods)?);
        runs::units(&field, method, &states.borrow(), &periods.borrow()).map(table)
    };
    answer(run())
}

/// A result: regular, chaotic or undecided, by the rule. Three tangent vectors belong to each state, a unit to each of its
/// components, and a length of the run in natural units. Its parts are `[outcome, kind, exponent, indicators]`, the kinds -1, 1
/// and 0, the indicators `(trajectory, 4)`.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)] // flat, as C has it
pub extern "C" fn lp_decide(
    field: i32,
    method: i32,
    states: i32,
    tangents: i32,
    units: i32,
    periods: i32,
    natural_times: i32,
    end: f64,
    is_plane: u32,
) -> i32 {
    let run = || {
        let (field, method) = (table::field(field)?, table::method(method)?);
        let [states, tangents, units] = [states, tangents, units].map(table::numbers);
        let [periods, natural_times] = [periods, natural_times].map(table::numbers);
        let (states, tangents, units, periods, natural_times) = (states?, tangents?, units?, periods?, natural_times?);
        let question = Question {
            states: &states.borrow(),
            tangents: &tangents.borrow(),
            units: &units.borrow(),
            periods: &periods.borrow(),
            end,
            natural_times: &natural_times.borrow(),
            is_plane: is_plane != 0,
        };
        runs::decide(&field, method, &question).map(table)
    };
    answer(run())
}

/// Where a part of a result is in memory.
#[unsafe(no_mangle)]
pub extern "C" fn lp_part(result: i32, index: u32) -> usize {
    table::table(result).map_or(0, |table| table.part(index as usize).as_ptr().addr())
}

/// How many numbers it has.
#[unsafe(no_mangle)]
pub extern "C" fn lp_part_length(result: i32, index: u32) -> usize {
    table::table(result).map_or(0, |table| table.part(index as usize).len())
}
