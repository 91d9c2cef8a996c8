//! What a ray that leaves the scene sees.

use std::path::Path;

use super::{LoadError, Problem, Warning};
use crate::display::{Image, ImageError};

/// Radiance from infinity.
#[derive(Debug, Clone, PartialEq)]
pub enum Environment {
    Constant([f32; 3]),
    /// Latitude-longitude map, rows from the top (+y) down. The image's centre is +z, its column at a quarter is +x:
    /// u = 1/2 - atan2(x, z) / (2 pi), v = acos(y) / pi. (Mitsuba's orientation in glTF axes.)
    Map {
        width: u32,
        height: u32,
        pixels: Vec<[f32; 3]>,
    },
}

impl Default for Environment {
    fn default() -> Self {
        Environment::Constant([0.0; 3])
    }
}

/// What an infinite channel becomes: the largest value that half-precision maps hold.
const BRIGHTEST: f32 = 65504.0;

impl Environment {
    /// Loads a latitude-longitude map from an .hdr or .exr file. Negative and NaN channels become 0, infinite ones 65504, and are counted.
    ///
    /// # Errors
    /// Where the file cannot be read, is of another kind, or is damaged.
    pub fn load(path: &Path) -> Result<(Environment, Vec<Warning>), LoadError> {
        let read = || -> Result<_, Problem> {
            std::fs::metadata(path)?;
            let Image { width, height, mut pixels } = read_map(path)?;
            let warnings = repair(&mut pixels);
            Ok((Environment::Map { width, height, pixels }, warnings))
        };
        read().map_err(|problem| problem.in_file(path.display().to_string()))
    }
}

fn read_map(path: &Path) -> Result<Image, Problem> {
    let malformed = |reason: String| Problem::Malformed { expected: "an .hdr or .exr map", reason };
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        return Err(malformed("a .png holds no radiance".into()));
    }
    let image = Image::read(path).map_err(|error| match error {
        ImageError::Unreadable { reason, .. } => malformed(reason),
        ImageError::UnknownFormat { .. } => malformed("its name has another ending".into()),
        other => malformed(other.to_string()),
    })?;
    if image.pixels.is_empty() { Err(malformed("it has no pixels".into())) } else { Ok(image) }
}

fn repair(pixels: &mut [[f32; 3]]) -> Vec<Warning> {
    let mut count = 0;
    for channel in pixels.as_flattened_mut().iter_mut().filter(|channel| !(**channel >= 0.0 && channel.is_finite())) {
        *channel = if *channel == f32::INFINITY { BRIGHTEST } else { 0.0 };
        count += 1;
    }
    let message = "negative or non-finite channels of the environment map repaired".into();
    if count > 0 { vec![Warning { message, count }] } else { Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_that_are_no_radiance_are_repaired_and_counted() {
        let mut pixels = [[1.0, -2.0, 3.0], [f32::NAN, f32::INFINITY, 0.0], [f32::NEG_INFINITY, 1e30, -0.0]];
        let warnings = repair(&mut pixels);
        assert_eq!(pixels, [[1.0, 0.0, 3.0], [0.0, BRIGHTEST, 0.0], [0.0, 1e30, 0.0]]);
        assert_eq!(warnings[0].count, 4);
        assert_eq!(repair(&mut pixels), []);
    }
}
