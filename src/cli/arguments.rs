//! Values on the command line: each parser says what it takes when it refuses.

use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Picture size in pixels, `WIDTHxHEIGHT`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    pub width: u32,
    pub height: u32,
}

/// The largest side of an image that desktop Vulkan devices agree on.
const MAX_SIDE: u32 = 16384;

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |text: &str| text.parse().ok().filter(|side| (1..=MAX_SIDE).contains(side));
        text.split_once(['x', 'X'])
            .and_then(|(width, height)| Some(Size { width: side(width)?, height: side(height)? }))
            .ok_or_else(|| format!("expected WIDTHxHEIGHT with sides of 1 to {MAX_SIDE} pixels, such as 640x360"))
    }
}

/// A finite number; "nan" and "inf" are refused.
pub fn finite(text: &str) -> Result<f32, String> {
    text.trim().parse().ok().filter(|x: &f32| x.is_finite()).ok_or_else(|| "expected a finite number".to_owned())
}

/// A finite number above zero.
pub fn positive(text: &str) -> Result<f32, String> {
    finite(text).ok().filter(|x| *x > 0.0).ok_or_else(|| "expected a finite number above 0".to_owned())
}

/// Vertical field of view in degrees.
pub fn field_of_view(text: &str) -> Result<f32, String> {
    finite(text).ok().filter(|x| *x > 0.0 && *x < 180.0).ok_or_else(|| "expected degrees above 0 and below 180".to_owned())
}

/// `x,y,z`, each finite.
pub fn vector(text: &str) -> Result<[f32; 3], String> {
    let numbers: Vec<f32> = text.split(',').map_while(|part| finite(part).ok()).collect();
    match (numbers.as_slice(), text.split(',').count()) {
        (&[x, y, z], 3) => Ok([x, y, z]),
        _ => Err("expected three finite numbers, such as 0,1.5,-2".to_owned()),
    }
}

/// `r,g,b` radiance, finite and not negative.
pub fn radiance(text: &str) -> Result<[f32; 3], String> {
    vector(text)
        .ok()
        .filter(|rgb| rgb.iter().all(|channel| *channel >= 0.0))
        .ok_or_else(|| "expected three finite numbers of at least 0, such as 0.5,0.5,0.5".to_owned())
}

/// `key=value`, both not empty.
pub fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=').map(|(key, value)| (key.trim(), value.trim())) {
        Some((key, value)) if !key.is_empty() && !value.is_empty() => Ok((key.to_owned(), value.to_owned())),
        _ => Err("expected key=value".to_owned()),
    }
}

/// A picture to write.
pub fn picture(text: &str) -> Result<PathBuf, String> {
    with_extension(text, &["exr", "png"])
}

/// A PNG to write.
pub fn png(text: &str) -> Result<PathBuf, String> {
    with_extension(text, &["png"])
}

/// A binary glTF file to write.
pub fn glb(text: &str) -> Result<PathBuf, String> {
    with_extension(text, &["glb"])
}

/// An environment map to read.
pub fn environment(text: &str) -> Result<PathBuf, String> {
    with_extension(text, &["exr", "hdr"])
}

/// `NAME=OUT.exr`.
pub fn named_exr(text: &str) -> Result<(String, PathBuf), String> {
    let (name, path) = assignment(text).map_err(|_| "expected NAME=OUT.exr".to_owned())?;
    Ok((name, with_extension(&path, &["exr"])?))
}

fn with_extension(text: &str, known: &[&str]) -> Result<PathBuf, String> {
    let found = Path::new(text).extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_ascii_lowercase();
    match known.contains(&found.as_str()) {
        true => Ok(PathBuf::from(text)),
        false => Err(format!("expected a file name that ends in .{}", known.join(" or ."))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_positive_sides() {
        assert_eq!("640x360".parse(), Ok(Size { width: 640, height: 360 }));
        for bad in ["0x0", "640x0", "640", "x", "-1x5", "1x2x3", "16385x1", "1e3x4", ""] {
            assert!(bad.parse::<Size>().is_err(), "{bad}");
        }
    }

    #[test]
    fn numbers_are_finite() {
        assert_eq!(vector("1,-2.5, 3e1"), Ok([1.0, -2.5, 30.0]));
        for bad in ["1,2", "1,2,3,4", "1,nan,3", "1,2,inf", "1,,2", "1e99,0,0"] {
            assert!(vector(bad).is_err(), "{bad}");
        }
        assert!(radiance("1,-1,1").is_err());
        assert!(positive("0").is_err() && field_of_view("180").is_err());
    }

    #[test]
    fn file_names_tell_their_format() {
        assert_eq!(picture("out/A.EXR"), Ok(PathBuf::from("out/A.EXR")));
        assert_eq!(named_exr("normal=n.exr"), Ok(("normal".to_owned(), PathBuf::from("n.exr"))));
        assert!(picture("a.jpg").is_err() && picture("exr").is_err() && named_exr("a.exr").is_err() && named_exr("=a.exr").is_err());
    }
}
