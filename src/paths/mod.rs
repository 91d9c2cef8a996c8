//! Primary visibility and path tracing.

pub mod energy;
pub mod gbuffer;
pub mod megakernel;
pub mod terms;
