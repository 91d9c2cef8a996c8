//! LDR-FLIP, the difference that a person sees when flipping between two pictures: Andersson et al. 2020, "FLIP: A
//! Difference Evaluator for Alternating Images", computed by NVIDIA's own code (crate nv-flip) for the paper's screen of 67.02
//! pixels per degree: 3840 pixels on 0.7 m, seen from 0.7 m.

use super::{Pair, statistics::quantile};
use crate::display::tonemap::quantised;
use nv_flip::{FlipImageFloat, FlipImageRgb8, magma_lut, pixels_per_degree};

/// The error of each pixel, 0 (none) to 1.
pub struct FlipErrors {
    map: FlipImageFloat,
    /// Mean over the pixels.
    pub mean: f64,
    /// What 99 % of the pixels stay below.
    pub percentile_99: f64,
}

/// The encoded values are rounded to 8 bits first, as they would be in a PNG.
pub fn flip(encoded: &Pair) -> FlipErrors {
    let (width, height) = encoded.size();
    let [image, reference] = [encoded.image, encoded.reference].map(|image| FlipImageRgb8::with_data(width, height, &quantised(image)));
    let map = nv_flip::flip(reference, image, pixels_per_degree(0.7, 3840.0, 0.7));
    let errors: Vec<f64> = map.to_vec().into_iter().map(f64::from).collect();
    FlipErrors { map, mean: errors.iter().sum::<f64>() / errors.len() as f64, percentile_99: quantile(errors, 0.99) }
}

impl FlipErrors {
    /// sRGB bytes of the magma colour map, three a pixel, rows from the top: black is no error, bright yellow is 1.
    pub fn heatmap(&self) -> Vec<u8> {
        self.map.apply_color_lut(&magma_lut()).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::super::judged::{assert_close, images};
    use super::*;

    #[test]
    fn flip_agrees_with_its_authors_python_package() {
        let (image, reference) = images();
        let errors = flip(&Pair::new(&image, &reference).unwrap());
        assert_close(errors.mean, 0.06851343810558319, 1e-5);
        assert_close(errors.percentile_99, 0.13970715, 1e-5);
        assert_eq!(errors.heatmap().len(), 48 * 32 * 3);
    }
}
