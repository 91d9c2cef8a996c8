//! pathspace: a Vulkan ray-query path tracer that measures what accuracy costs in time.
//!
//! The modules are listed in the order of the data: a scene comes in, a picture goes out.

pub mod cli;
pub mod gpu;
pub mod shared;
pub mod frame;
pub mod scene;
pub mod accel;
pub mod paths;
pub mod filter;
pub mod display;
pub mod technique;
pub mod metrics;
pub mod bench;
