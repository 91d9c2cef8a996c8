//! Decoded images with their mip chains.

/// RGBA, 8 bits a channel, with a full mip chain (level 0 first, each half the size, rounded down, down to 1x1).
/// An image used both as colour and as data is two textures.
#[derive(Debug, Clone)]
pub struct Texture {
    pub name: String,
    pub width: u32,
    pub height: u32,
    /// RGB is sRGB-encoded (filtered in linear light); else linear data.
    pub srgb: bool,
    pub mips: Vec<Vec<u8>>,
    pub wrap: [Wrap; 2],
    pub filter: Filter,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Wrap {
    Repeat,
    Mirror,
    Clamp,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Filter {
    Nearest,
    Linear,
}
