//! What accuracy costs in time: suites of measurements, the runner that makes them, their statistics, and the report.

pub mod figure;
pub mod record;

pub use figure::{Better, FigureKind};
pub use record::{Figure, Record};
