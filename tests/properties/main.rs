//! What must hold whatever the input.

mod metrics;
