//! Acceleration structures.
mod bounds;
mod order;
mod tree;

pub use bounds::Aabb;
pub use order::{SpatialOrder, instance_order, spatial_order};
pub use tree::{Item, Limits, Tree};
