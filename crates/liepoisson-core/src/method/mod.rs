//! How a field is advanced in time: one method per file.

mod taylor;

pub use taylor::{Block, Taylor};
