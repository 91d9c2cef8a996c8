//! Light transport: what paths need from the host.

pub mod energy;
