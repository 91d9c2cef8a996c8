//! What accuracy costs in time: suites of measurements, the runner that makes them, their statistics, and the report.

pub mod accuracy;
pub mod calibrate;
pub mod change;
pub mod compare;
pub mod figure;
pub mod front;
pub mod log;
pub mod plan;
mod provenance;
pub mod record;
pub mod reference;
pub mod report;
pub mod roofline;
pub mod runner;
mod shots;
mod stage;
pub mod suite;
mod table;

pub use figure::{Better, FigureKind};
pub use log::{Log, LogError};
pub use record::{Figure, Record};
