//! How far a picture is from a reference, and whether the distance is chance. On the CPU, in double precision.
//!
//! `mse`, `relmse`, `hdr_flip`, `mean_ratio` and `split` take radiance; `rmse_tonemapped` and `temporal` take linear display values
//! in [0, 1], which [`ToneMapping::displayed`](crate::display::ToneMapping::displayed) makes; `psnr`, `ssim` and `flip` take
//! sRGB-encoded ones of [`ToneMapping::encoded`](crate::display::ToneMapping::encoded). [`accuracy`] does it all at once.

pub mod accuracy;
pub mod error_map;
pub mod estimate;
pub mod faults;
pub mod flip;
pub mod mean_ratio;
pub mod mse;
pub mod psnr;
pub mod relmse;
pub mod rmse_tonemapped;
pub mod series;
pub mod split;
pub mod ssim;
pub mod statistics;
pub mod temporal;
pub mod z_test;

pub use accuracy::accuracy;
pub use error_map::ErrorMap;
pub use estimate::Estimate;
pub use faults::Faults;
pub use flip::flip;
pub use flip::hdr::hdr_flip;
pub use mean_ratio::mean_ratio;
pub use mse::mse;
pub use psnr::psnr;
pub use relmse::relmse;
pub use rmse_tonemapped::rmse_tonemapped;
pub use split::split;
pub use ssim::ssim;
pub use temporal::temporal;
pub use z_test::z_test;

use crate::display::Image;

/// Why two pictures cannot be compared.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MetricError {
    #[error("the picture is {}x{} and the reference {}x{}: render both with one --size", image.0, image.1, reference.0, reference.1)]
    SizesDiffer { image: (u32, u32), reference: (u32, u32) },
    #[error("{count} of the {which}'s pixels hold NaN or infinity, the first is ({}, {})", first.0, first.1)]
    NotFinite { which: &'static str, count: usize, first: (u32, u32) },
    #[error("SSIM needs at least 11x11 pixels; these pictures are {}x{}", size.0, size.1)]
    TooSmallForSsim { size: (u32, u32) },
    #[error("{given} pictures are too few: at least {needed} of independent seeds are needed")]
    TooFewPictures { given: usize, needed: usize },
}

/// A picture and what it should be: one size, all finite.
#[derive(Debug, Clone, Copy)]
pub struct Pair<'a> {
    image: &'a Image,
    reference: &'a Image,
}

impl<'a> Pair<'a> {
    pub fn new(image: &'a Image, reference: &'a Image) -> Result<Self, MetricError> {
        let size = |image: &Image| (image.width, image.height);
        if size(image) != size(reference) {
            return Err(MetricError::SizesDiffer { image: size(image), reference: size(reference) });
        }
        for (which, picture) in [("picture", image), ("reference", reference)] {
            if let Some((count, first)) = picture.non_finite() {
                return Err(MetricError::NotFinite { which, count, first });
            }
        }
        Ok(Pair { image, reference })
    }

    fn size(&self) -> (u32, u32) {
        (self.image.width, self.image.height)
    }

    /// (picture, reference) of each pixel.
    fn pixels(&self) -> impl ExactSizeIterator<Item = ([f64; 3], [f64; 3])> {
        self.image.pixels.iter().zip(&self.reference.pixels).map(|(a, b)| (a.map(f64::from), b.map(f64::from)))
    }

    /// The mean over a pixel's channels of `error(picture, reference)`, for each pixel.
    fn pixel_errors(&self, error: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        self.pixels().map(|(a, b)| (error(a[0], b[0]) + error(a[1], b[1]) + error(a[2], b[2])) / 3.0).collect()
    }
}

/// Luminance of linear Rec. 709 values, luma of encoded ones.
fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// What the judges of other hands saw: 48x32 pictures of whole bytes, for which flip-evaluator 1.7, scikit-image 0.26.0
/// and numpy 2.4.6 (all from PyPI, Python 3.11) gave the constants that the metrics' tests hold.
#[cfg(test)]
mod judged {
    use super::*;

    fn image(byte: impl Fn(i32, i32, i32) -> i32) -> Image {
        let pixel = |x, y| [0, 1, 2].map(|c| byte(x, y, c).clamp(0, 255) as f32 / 255.0);
        Image::new(48, 32, (0..32).flat_map(|y| (0..48).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect())
    }

    fn reference_byte(x: i32, y: i32, channel: i32) -> i32 {
        [(x * 8 + y * 3) % 256, (x * y) % 256, 255 - 5 * y][channel as usize]
    }

    /// (picture, reference).
    pub fn images() -> (Image, Image) {
        (image(|x, y, c| reference_byte(x, y, c) + (x * 7 + y * 13 + c * 29) % 33 - 16), image(reference_byte))
    }

    pub fn assert_close(ours: f64, theirs: f64, relative: f64) {
        assert!((ours / theirs - 1.0).abs() < relative, "ours {ours}, theirs {theirs}");
    }

    #[test]
    fn pictures_of_two_sizes_or_with_nan_make_no_pair() {
        let (image, reference) = images();
        let smaller = Image::new(2, 1, vec![[0.0; 3]; 2]);
        assert!(matches!(Pair::new(&image, &smaller), Err(MetricError::SizesDiffer { .. })));
        let mut broken = reference.clone();
        broken.pixels[50][1] = f32::NAN;
        assert_eq!(Pair::new(&image, &broken).unwrap_err(), MetricError::NotFinite { which: "reference", count: 1, first: (2, 1) });
    }
}
