//! What JavaScript holds by number: arrays, fields, functions, methods, results. No pointer comes in, so none can be wrong.

use crate::refusal::{Kind, Refusal};
use crate::runs::Table;
use liepoisson_core::choice::{AnyField, AnyMethod};
use liepoisson_core::field::Functions;
use liepoisson_core::formula::System;
use std::cell::{Cell, RefCell};
use std::rc::Rc;

/// A thing with a number.
#[derive(Clone)]
pub(crate) enum Thing {
    Bytes(Rc<RefCell<Vec<u8>>>),
    Numbers(Rc<RefCell<Vec<f64>>>),
    Field(Rc<AnyField>),
    Functions(Rc<Functions>),
    Method(AnyMethod),
    System(Rc<System>),
    Table(Rc<Table>),
}

thread_local! {
    static THINGS: RefCell<Vec<Option<Thing>>> = const { RefCell::new(Vec::new()) };
    static MESSAGE: RefCell<String> = const { RefCell::new(String::new()) };
    static PLACE: Cell<i32> = const { Cell::new(-1) };
}

/// Keeps a thing; its number, from 1.
pub(crate) fn keep(thing: Thing) -> i32 {
    THINGS.with_borrow_mut(|things| {
        let place = things.iter().position(Option::is_none).unwrap_or_else(|| {
            things.push(None);
            things.len() - 1
        });
        things[place] = Some(thing);
        place as i32 + 1
    })
}

/// Forgets a thing.
pub(crate) fn forget(handle: i32) {
    THINGS.with_borrow_mut(|things| {
        if let Some(thing) = usize::try_from(handle - 1).ok().and_then(|place| things.get_mut(place)) {
            *thing = None;
        }
    });
}

pub(crate) fn thing(handle: i32) -> Option<Thing> {
    let place = usize::try_from(handle.checked_sub(1)?).ok()?;
    THINGS.with_borrow(|things| things.get(place).cloned().flatten())
}

macro_rules! by_handle {
    ($name:ident, $variant:ident, $type:ty, $what:literal) => {
        pub(crate) fn $name(handle: i32) -> Result<$type, Refusal> {
            match thing(handle) {
                Some(Thing::$variant(thing)) => Ok(thing),
                _ => Err(Refusal::new(
                    Kind::Handle,
                    format!("handle {handle}: wanted {}; it was freed, or is another thing", $what),
                )),
            }
        }
    };
}

by_handle!(bytes, Bytes, Rc<RefCell<Vec<u8>>>, "bytes");
by_handle!(numbers, Numbers, Rc<RefCell<Vec<f64>>>, "numbers");
by_handle!(field, Field, Rc<AnyField>, "a field");
by_handle!(functions, Functions, Rc<Functions>, "functions");
by_handle!(method, Method, AnyMethod, "a method");
by_handle!(system, System, Rc<System>, "a system");
by_handle!(table, Table, Rc<Table>, "a result");

/// Sets what the last refusal, or the panic, has to say.
pub(crate) fn say(message: String) {
    // a panic may come while it is borrowed
    let _ = MESSAGE.try_with(|said| said.try_borrow_mut().map(|mut said| *said = message));
}

/// Sets where in a formula the last refusal points; -1 for one of something else.
pub(crate) fn point_at(place: i32) {
    PLACE.set(place);
}

/// Where in a formula the last refusal points.
pub(crate) fn place() -> i32 {
    PLACE.get()
}

/// Where the message is.
pub(crate) fn message() -> (*const u8, usize) {
    MESSAGE.with_borrow(|message| (message.as_ptr(), message.len()))
}
