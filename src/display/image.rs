//! Pictures in memory, and the files they come from and go to.

use super::{ToneMapping, exr_file, tonemap::srgb_decode};
use image::{ImageEncoder, ImageFormat, ImageReader};
use rayon::prelude::*;
use std::borrow::Cow;
use std::fs::File;
use std::io::{BufReader, Cursor, Write};
use std::path::{Path, PathBuf};

/// Linear RGB (Rec. 709 primaries) radiance in W/(sr m^2), `width * height` pixels, rows from the top.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Image {
    pub width: u32,
    pub height: u32,
    pub pixels: Vec<[f32; 3]>,
}

/// Why a picture could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    #[error("cannot read '{}': {reason}", path.display())]
    Unreadable { path: PathBuf, reason: String },
    #[error("cannot read '{}': its name ends neither in .exr, .hdr nor .png", path.display())]
    UnknownFormat { path: PathBuf },
    #[error("cannot encode the picture: {reason}")]
    Encoding { reason: String },
    #[error(transparent)]
    Io(#[from] std::io::Error),
}

/// What decoding one file may take: a 16384 x 16384 map of three floats, and then some.
pub(super) const MAX_DECODED_BYTES: u64 = 4 << 30;

impl Image {
    /// `pixels.len()` must be `width * height`.
    pub fn new(width: u32, height: u32, pixels: Vec<[f32; 3]>) -> Image {
        assert_eq!(pixels.len(), width as usize * height as usize, "{width}x{height} pixels");
        Image { width, height, pixels }
    }

    /// Reads .exr and .hdr as they are, .png decoded from sRGB to linear [0, 1]. Alpha is ignored. Values may be non-finite.
    pub fn read(path: &Path) -> Result<Image, ImageError> {
        let unreadable = |reason: String| ImageError::Unreadable { path: path.to_owned(), reason };
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_ascii_lowercase();
        let format = match extension.as_str() {
            "exr" => None,
            "hdr" => Some(ImageFormat::Hdr),
            "png" => Some(ImageFormat::Png),
            _ => return Err(ImageError::UnknownFormat { path: path.to_owned() }),
        };
        let file = BufReader::new(File::open(path).map_err(|error| unreadable(error.to_string()))?);
        let Some(format) = format else {
            return exr_file::read(file).map_err(unreadable);
        };
        let mut reader = ImageReader::with_format(file, format);
        let mut limits = image::Limits::default();
        limits.max_alloc = Some(MAX_DECODED_BYTES);
        reader.limits(limits);
        let decoded = reader.decode().map_err(|error| unreadable(error.to_string()))?.into_rgb32f();
        let pixels = decoded.pixels().map(|pixel| if format == ImageFormat::Png { pixel.0.map(srgb_decode) } else { pixel.0 }).collect();
        Ok(Image::new(decoded.width(), decoded.height(), pixels))
    }

    /// Writes 8-bit sRGB. NaN is written as 0; [`Image::made_finite`] reports it.
    pub fn write_png(&self, mapping: &ToneMapping, mut to: impl Write) -> Result<(), ImageError> {
        write_png_bytes(self.width, self.height, &mapping.encoded_bytes(self), &mut to)
    }

    /// Pixels with a NaN or infinite channel: how many, and (x, y) of the first.
    pub fn non_finite(&self) -> Option<(usize, (u32, u32))> {
        let is_bad = |pixel: &[f32; 3]| !pixel.iter().all(|channel| channel.is_finite());
        let first = self.pixels.par_iter().position_first(is_bad)?;
        let count = self.pixels.par_iter().filter(|pixel| is_bad(pixel)).count();
        Some((count, (first as u32 % self.width, first as u32 / self.width)))
    }

    /// The same picture with non-finite channels set to 0; `what` names it in the warning that says how many pixels had any.
    pub fn made_finite(&self, what: &str) -> Cow<'_, Image> {
        let Some((count, (x, y))) = self.non_finite() else { return Cow::Borrowed(self) };
        tracing::warn!("{what}: {count} pixels were not finite and became 0; the first is ({x}, {y})");
        Cow::Owned(self.with_zeros())
    }

    /// The same picture with non-finite channels set to 0, silently.
    pub fn with_zeros(&self) -> Image {
        let finite = |channel: f32| if channel.is_finite() { channel } else { 0.0 };
        Image::new(self.width, self.height, self.pixels.par_iter().map(|pixel| pixel.map(finite)).collect())
    }
}

/// Writes 8-bit sRGB bytes, three a pixel, rows from the top.
pub fn write_png_bytes(width: u32, height: u32, rgb: &[u8], to: &mut impl Write) -> Result<(), ImageError> {
    // Encoded in memory, so that a failing disk is told from a failing encoder.
    let mut encoded = Cursor::new(Vec::new());
    image::codecs::png::PngEncoder::new(&mut encoded)
        .write_image(rgb, width, height, image::ExtendedColorType::Rgb8)
        .map_err(|error| ImageError::Encoding { reason: error.to_string() })?;
    Ok(to.write_all(encoded.get_ref())?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display::ToneCurve;

    #[test]
    fn png_bytes_come_back() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("ramp.png");
        let pixels = (0..16u16).map(|i| [i as f32 / 15.0, 0.5, 1.0 - i as f32 / 15.0].map(srgb_decode)).collect();
        let mapping = ToneMapping { exposure: 0.0, curve: ToneCurve::None };
        let image = Image::new(8, 2, pixels);
        image.write_png(&mapping, File::create(&path).unwrap()).unwrap();
        assert_eq!(mapping.encoded_bytes(&Image::read(&path).unwrap()), mapping.encoded_bytes(&image));
    }

    #[test]
    fn non_finite_pixels_are_counted_and_zeroed() {
        let image = Image::new(2, 2, vec![[1.0; 3], [0.0, f32::NAN, 2.0], [f32::INFINITY; 3], [-1.0; 3]]);
        assert_eq!(image.non_finite(), Some((2, (1, 0))));
        let repaired = image.made_finite("test");
        assert_eq!(repaired.pixels, [[1.0; 3], [0.0, 0.0, 2.0], [0.0; 3], [-1.0; 3]]);
        assert!(matches!(repaired.made_finite("test"), Cow::Borrowed(_)));
    }

    #[test]
    fn files_that_are_no_pictures_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        for name in ["a.exr", "a.hdr", "a.png", "a.gif", "missing/a.png"] {
            let path = directory.path().join(name);
            for content in [&b""[..], b"not a picture", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4000000000 +X 4000000000\n"] {
                std::fs::write(&path, content).ok();
                let message = Image::read(&path).unwrap_err().to_string();
                assert!(message.contains(name), "{message}");
            }
        }
    }
}
