//! Structural similarity: Wang, Bovik, Sheikh and Simoncelli 2004, "Image Quality Assessment: From Error Visibility to
//! Structural Similarity", equation 13 under an 11x11 Gaussian window of sigma 1.5.

use super::{MetricError, Pair, luminance};
use rayon::prelude::*;

const WINDOW: usize = 11;
const SIGMA: f64 = 1.5;
/// (K1 L)^2 and (K2 L)^2 with the paper's K1 = 0.01 and K2 = 0.03, for values up to L = 1.
const C1: f64 = 1e-4;
const C2: f64 = 9e-4;

/// Mean structural similarity of the luma (Rec. 709 weights on encoded values); 1 for equal pictures, more is better.
/// Only windows that lie within the picture count.
pub fn ssim(encoded: &Pair) -> Result<f64, MetricError> {
    let (width, height) = encoded.size();
    if width.min(height) < WINDOW as u32 {
        return Err(MetricError::TooSmallForSsim { size: (width, height) });
    }
    let pixels: Vec<[f64; 2]> = encoded.pixels().map(|(a, b)| [luminance(a), luminance(b)]).collect();
    let moments: [fn(&[f64; 2]) -> f64; 5] = [|p| p[0], |p| p[1], |p| p[0] * p[0], |p| p[1] * p[1], |p| p[0] * p[1]];
    let blurred: Vec<Vec<f64>> =
        moments.par_iter().map(|moment| window_means(width as usize, &pixels.iter().map(moment).collect::<Vec<_>>())).collect();
    let count = blurred[0].len();
    let similarity = |i: usize| {
        let [mean_a, mean_b, aa, bb, ab] = [0, 1, 2, 3, 4].map(|moment: usize| blurred[moment][i]);
        let (variance_a, variance_b, covariance) = (aa - mean_a * mean_a, bb - mean_b * mean_b, ab - mean_a * mean_b);
        (2.0 * mean_a * mean_b + C1) * (2.0 * covariance + C2) / ((mean_a * mean_a + mean_b * mean_b + C1) * (variance_a + variance_b + C2))
    };
    Ok((0..count).map(similarity).sum::<f64>() / count as f64)
}

/// Gaussian-weighted means of all windows within a picture that is `width` wide: 10 columns and 10 rows fewer.
fn window_means(width: usize, values: &[f64]) -> Vec<f64> {
    let weights = gaussian();
    let weighted = |window: &[f64]| window.iter().zip(&weights).map(|(value, weight)| value * weight).sum::<f64>();
    let rows: Vec<f64> = values.chunks(width).flat_map(|row| row.windows(WINDOW).map(weighted)).collect();
    let width = width - WINDOW + 1;
    let column = |i: usize| weights.iter().enumerate().map(|(k, weight)| weight * rows[i + k * width]).sum();
    (0..rows.len() - (WINDOW - 1) * width).map(column).collect()
}

fn gaussian() -> [f64; WINDOW] {
    let weights: [f64; WINDOW] = std::array::from_fn(|i| (-0.5 * ((i as f64 - (WINDOW / 2) as f64) / SIGMA).powi(2)).exp());
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

#[cfg(test)]
mod tests {
    use super::super::judged::{assert_close, images};
    use super::*;
    use crate::display::Image;

    /// `structural_similarity(a, b, data_range=1, gaussian_weights=True, sigma=1.5, use_sample_covariance=False)`
    #[test]
    fn ssim_agrees_with_scikit_image() {
        let (image, reference) = images();
        assert_close(ssim(&Pair::new(&image, &reference).unwrap()).unwrap(), 0.9712685753046697, 1e-6);
    }

    #[test]
    fn ssim_refuses_pictures_smaller_than_its_window() {
        let image = Image::new(11, 10, vec![[0.5; 3]; 110]);
        assert_eq!(ssim(&Pair::new(&image, &image).unwrap()), Err(MetricError::TooSmallForSsim { size: (11, 10) }));
        let image = Image::new(11, 11, vec![[0.5; 3]; 121]);
        assert_eq!(ssim(&Pair::new(&image, &image).unwrap()), Ok(1.0));
    }
}
