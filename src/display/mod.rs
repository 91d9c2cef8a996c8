//! From radiance to pictures that people and other programs read.

pub mod accumulate;
pub mod composite;
pub mod exr_file;
pub mod image;
pub mod rounds;
pub mod temporal;
pub mod tonemap;

pub use exr_file::ExrContents;
pub use image::{Image, ImageError};
pub use tonemap::{ToneCurve, ToneMapping};
