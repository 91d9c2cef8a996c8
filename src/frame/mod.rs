//! The frame: what every kernel sees, passes that declare what they read and write, and the order that follows.

mod globals;
mod graph;
mod pass;
mod resources;
mod share;

pub use globals::{Globals, GlobalsInfo, STRUCTURE_TEXELS, TOP_LEVEL};
pub use graph::{FrameBuilder, FrameGraph};
pub use pass::{MOST_GROUPS, PassBuilder, Traffic};
pub use resources::{BufferHandle, History, ImageHandle, Resource};
pub use share::{Share, shares};
