//! The frame: what every kernel sees, passes that declare what they read and write, and the order that follows.

mod globals;
mod graph;

pub use globals::{Globals, GlobalsInfo, STRUCTURE_TEXELS, TOP_LEVEL};
pub use graph::{FrameBuilder, FrameGraph, ImageHandle, PassBuilder, Traffic};
