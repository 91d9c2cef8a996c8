//! Are two renderings estimates of one picture? A Z-test for each pixel and channel with a correction for their number, as
//! Mitsuba 3 tests its own images (Subr and Arvo 2007, "Statistical Hypothesis Testing for Assessing Monte Carlo Estimators").
//!
//! *Deviations and why.* Both sides have noise here, so their variances add. Variances are themselves estimates from a few
//! batches, so the statistic follows Student's t, with Welch and Satterthwaite's degrees of freedom, whose tails are much
//! heavier at the corrected significance. And no share of pixels is allowed to fail: the correction already accounts for
//! their number, so that correct renderings fail together with the probability `significance`.

use super::statistics::{sidak, two_sided_p};
use super::{MetricError, Pair};
use crate::display::Image;

/// An unbiased rendering and how sure it is.
#[derive(Debug, Clone, Copy)]
pub struct Estimate<'a> {
    pub mean: &'a Image,
    /// Estimated variance of `mean`, that is, of one sample divided by the number of samples.
    pub variance: &'a Image,
    /// How many batches the variance was estimated from, at least 2; `None` where it is as good as exact.
    pub batches: Option<u64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ZTest {
    /// Blocks times 3 channels.
    pub tests: usize,
    /// Tests whose p-value is below the corrected significance.
    pub rejected: usize,
    /// Of all tests.
    pub smallest_p: f64,
    /// Where the smallest was found: pixel (x, y) of the block's corner.
    pub worst: (u32, u32),
}

impl ZTest {
    pub fn passed(&self) -> bool {
        self.rejected == 0
    }
}

/// Tests each `block` x `block` mean (1: each pixel) of each channel at `significance` in all, corrected after Sidak.
///
/// A pixel's mean is normal only after many samples; where light is rare or noise heavy-tailed, averaging neighbours makes
/// it so sooner, and lets smaller errors show if they are smooth. Blocks at the right and bottom may be smaller.
pub fn z_test(a: Estimate, b: Estimate, block: u32, significance: f64) -> Result<ZTest, MetricError> {
    Pair::new(a.mean, b.mean)?;
    for (mean, variance) in [(a.mean, a.variance), (b.mean, b.variance)] {
        Pair::new(variance, mean)?;
    }
    let (width, height) = (a.mean.width, a.mean.height);
    let corners = (0..height).step_by(block as usize).flat_map(|y| (0..width).step_by(block as usize).map(move |x| (x, y)));
    let p_values: Vec<(f64, (u32, u32))> = corners
        .flat_map(|(x, y)| {
            let pixels: Vec<usize> = (y..height.min(y + block))
                .flat_map(|row| (x..width.min(x + block)).map(move |column| row as usize * width as usize + column as usize))
                .collect();
            [0, 1, 2].map(|channel| (p_value(&a, &b, &pixels, channel), (x, y)))
        })
        .collect();
    let threshold = sidak(significance, p_values.len());
    let accepted = p_values.iter().filter(|(p, _)| *p >= threshold).count();
    let (smallest_p, worst) = p_values.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((1.0, (0, 0)));
    Ok(ZTest { tests: p_values.len(), rejected: p_values.len() - accepted, smallest_p, worst })
}

/// Of the hypothesis that the sums over `pixels` of both estimates have one expectation.
fn p_value(a: &Estimate, b: &Estimate, pixels: &[usize], channel: usize) -> f64 {
    let mut difference = 0.0;
    let mut rounding = 0.0;
    let mut variance = 0.0;
    let mut spread_of_variance = 0.0;
    for &pixel in pixels {
        let [mean_a, mean_b] = [a, b].map(|estimate| f64::from(estimate.mean.pixels[pixel][channel]));
        difference += mean_a - mean_b;
        rounding += mean_a.abs().max(mean_b.abs()) * f64::from(f32::EPSILON);
        for estimate in [a, b] {
            let own = f64::from(estimate.variance.pixels[pixel][channel]);
            variance += own;
            spread_of_variance += estimate.batches.map_or(0.0, |batches| own * own / (batches as f64 - 1.0));
        }
    }
    // Means are kept in single precision: where nothing varies, only more than rounding is a difference.
    if difference.abs() <= 2.0 * rounding {
        return 1.0;
    }
    two_sided_p(difference / variance.sqrt(), variance * variance / spread_of_variance)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: [f32; 4]) -> Image {
        Image::new(2, 2, values.map(|value| [value; 3]).to_vec())
    }

    fn compare(a: &Image, b: &Image) -> ZTest {
        let nothing = grey([0.0; 4]);
        let exact = |mean| Estimate { mean, variance: &nothing, batches: None };
        z_test(exact(a), exact(b), 1, 0.01).unwrap()
    }

    #[test]
    fn where_nothing_varies_any_difference_beyond_rounding_is_rejected() {
        let image = grey([0.0, 1.0, 100.0, 1e-6]);
        assert!(compare(&image, &grey([0.0, 1.0 + f32::EPSILON, 100.0, 1e-6])).passed());
        let result = compare(&image, &grey([0.0, 1.0, 100.01, 1e-6]));
        assert_eq!((result.tests, result.rejected, result.smallest_p, result.worst), (12, 3, 0.0, (0, 1)));
    }

    #[test]
    fn estimates_of_two_sizes_are_an_error() {
        let (image, pixel) = (grey([0.0; 4]), Image::new(1, 1, vec![[0.0; 3]]));
        let estimate = Estimate { mean: &image, variance: &pixel, batches: None };
        assert!(matches!(z_test(estimate, estimate, 1, 0.01), Err(MetricError::SizesDiffer { .. })));
    }
}
