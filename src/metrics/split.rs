//! Bias and variance apart: what more samples would not cure, and what they would.
//!
//! With d_i = x_i - r for each of R seeds' pictures x_i, all there is to know lies in the Gram matrix G_ij, the mean over pixels and
//! channels of w d_i d_j. Seeds are independent, so that off the diagonal the noise cancels: E G_ij = bias^2 + v_r where the
//! reference r has the variance v_r itself (in weighted means), while E G_ii = bias^2 + v_r + variance. Means of G's parts are
//! U-statistics: unbiased whatever the distribution (Hoeffding 1948).
//!
//! Intervals are those of the mean of the jackknife's pseudo-values, one a seed, whose mean is the U-statistic itself (Arvesen 1969).
//! They are conservative where the bias is far below the noise: 97 to 98 % instead of 95 %.

use super::estimate::Estimate;
use super::{MetricError, Pair, relmse};
use crate::display::Image;
use rayon::prelude::*;

/// w: what squared errors are multiplied by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weighting {
    /// 1.
    Absolute,
    /// As in relMSE: 1 / (r^2 + 0.01).
    Relative,
}

/// Means over pixels and channels. All may come out below 0 where the truth is near 0: an unbiased estimate of 0 has to.
#[derive(Debug, Clone, PartialEq)]
pub struct Split {
    pub bias2: Estimate,
    /// Of one picture, over seeds.
    pub variance: Estimate,
    /// Squared error of one picture without the reference's own noise: bias2 + variance.
    pub mse: Estimate,
}

/// Splits the error of pictures of independent seeds. `reference_variance` is each pixel's variance *of the reference's mean*; without
/// it, the reference is taken as exact.
///
/// Two pictures have no intervals (`low` and `high` are `value`) for bias2 and variance; fewer are an error.
pub fn split(images: &[&Image], reference: &Image, reference_variance: Option<&Image>, weighting: Weighting) -> Result<Split, MetricError> {
    if images.len() < 2 {
        return Err(MetricError::TooFewPictures { given: images.len(), needed: 2 });
    }
    for image in images.iter().copied().chain(reference_variance) {
        Pair::new(image, reference)?;
    }
    let sums = Sums::over(images, reference, reference_variance, weighting);
    let diagonal: Vec<f64> = (0..images.len()).map(|i| sums.gram(i, i)).collect();
    let bias2 = u_statistic(images.len(), |i, j| sums.gram(i, j) - sums.reference_noise);
    let variance = u_statistic(images.len(), |i, j| 0.5 * (diagonal[i] + diagonal[j]) - sums.gram(i, j));
    let mse = of_finite(diagonal.iter().map(|squared| squared - sums.reference_noise).collect());
    let reference_error = sums.variance_through_reference.max(0.0).sqrt();
    // Seeds do not show that the reference errs; it cancels from the variance alone.
    Ok(Split { bias2: bias2.widened(reference_error), variance, mse: mse.widened(reference_error) })
}

/// Pixels that are summed up before the sums are, in a fixed order: results do not depend on the number of threads.
const CHUNK: usize = 1024;

/// Everything of one pass over the pixels, divided by the number of pixels and channels.
struct Sums {
    images: usize,
    /// Of pairs i <= j, row after row: j counts fastest.
    gram: Vec<f64>,
    /// Weighted variance of the reference.
    reference_noise: f64,
    /// Variance that the reference's error e gives to bias2: its share of w (b - e)^2 is w (e^2 - 2 b e), whose variance is
    /// w^2 (4 b^2 v + 2 v^2) for normal e. b^2 + v is estimated by the mean of d_i d_j over pairs.
    variance_through_reference: f64,
}

impl Sums {
    fn over(images: &[&Image], reference: &Image, variance: Option<&Image>, weighting: Weighting) -> Sums {
        let pixels = reference.pixels.len();
        let chunks: Vec<Sums> = (0..pixels.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let mut sums = Sums::zero(images.len());
                for pixel in chunk * CHUNK..pixels.min((chunk + 1) * CHUNK) {
                    for channel in 0..3 {
                        let at = |image: &Image| f64::from(image.pixels[pixel][channel]);
                        let r = at(reference);
                        let differences: Vec<f64> = images.iter().map(|image| at(image) - r).collect();
                        sums.add(&differences, variance.map_or(0.0, at), weighting.at(r));
                    }
                }
                sums
            })
            .collect();
        let mut total = Sums::zero(images.len());
        chunks.iter().for_each(|chunk| total.join(chunk));
        total.scale(1.0 / (3 * pixels) as f64);
        total
    }

    fn zero(images: usize) -> Sums {
        Sums { images, gram: vec![0.0; images * (images + 1) / 2], reference_noise: 0.0, variance_through_reference: 0.0 }
    }

    fn add(&mut self, differences: &[f64], variance: f64, weight: f64) {
        let mut rest = self.gram.as_mut_slice();
        let (mut sum, mut squares) = (0.0, 0.0);
        for (i, a) in differences.iter().enumerate() {
            let (row, below) = rest.split_at_mut(differences.len() - i);
            row.iter_mut().zip(&differences[i..]).for_each(|(gram, b)| *gram += weight * a * b);
            rest = below;
            (sum, squares) = (sum + a, squares + a * a);
        }
        let pairs = (differences.len() * (differences.len() - 1)) as f64;
        let squared_bias_and_noise = (sum * sum - squares) / pairs;
        self.reference_noise += weight * variance;
        self.variance_through_reference += weight * weight * (4.0 * squared_bias_and_noise * variance - 2.0 * variance * variance);
    }

    fn join(&mut self, other: &Sums) {
        self.gram.iter_mut().zip(&other.gram).for_each(|(sum, value)| *sum += value);
        self.reference_noise += other.reference_noise;
        self.variance_through_reference += other.variance_through_reference;
    }

    fn scale(&mut self, factor: f64) {
        self.gram.iter_mut().for_each(|sum| *sum *= factor);
        self.reference_noise *= factor;
        self.variance_through_reference *= factor * factor;
    }

    fn gram(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.min(j), i.max(j));
        self.gram[i * self.images - i * (i + 1) / 2 + j]
    }
}

impl Weighting {
    fn at(self, reference: f64) -> f64 {
        match self {
            Weighting::Absolute => 1.0,
            Weighting::Relative => relmse::weight(reference),
        }
    }
}

/// Mean of a symmetric `kernel(i, j)` over pairs of different seeds. Pseudo-values need three seeds.
fn u_statistic(seeds: usize, kernel: impl Fn(usize, usize) -> f64) -> Estimate {
    let rows: Vec<f64> = (0..seeds).map(|i| (0..seeds).filter(|j| *j != i).map(|j| kernel(i, j)).sum()).collect();
    let total: f64 = rows.iter().sum();
    let n = seeds as f64;
    let value = total / (n * (n - 1.0));
    if seeds == 2 {
        return Estimate::exact(value);
    }
    let without = |row: f64| (total - 2.0 * row) / ((n - 1.0) * (n - 2.0));
    of_finite(rows.iter().map(|row| n * value - (n - 1.0) * without(*row)).collect())
}

/// Pictures are finite and single precision: so is every sum of their squares in double precision.
fn of_finite(samples: Vec<f64>) -> Estimate {
    Estimate::mean(samples).unwrap_or_else(|_| Estimate::exact(f64::NAN))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: [f32; 2]) -> Image {
        Image::new(2, 1, values.map(|value| [value; 3]).to_vec())
    }

    /// d = (1, 0), (3, 0), (2, 4) over two pixels: squares 0.5, 4.5, 10, products 1.5, 1, 3.
    #[test]
    fn three_pictures_split_by_hand() {
        let (images, reference) = ([grey([2.0, 2.0]), grey([4.0, 2.0]), grey([3.0, 6.0])], grey([1.0, 2.0]));
        let images = images.each_ref();
        let exact = split(&images, &reference, None, Weighting::Absolute).unwrap();
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        close(exact.bias2.value, 5.5 / 3.0);
        close(exact.variance.value, 15.0 / 3.0 - 5.5 / 3.0);
        close(exact.mse.value, 5.0);
        let noisy = split(&images, &reference, Some(&grey([0.5, 0.125])), Weighting::Absolute).unwrap();
        close(noisy.bias2.value, 5.5 / 3.0 - 0.3125);
        close(noisy.variance.value, exact.variance.value);
        assert!(noisy.bias2.high > exact.bias2.high - 0.3125, "the reference's noise widens the interval");
        let relative = split(&images, &reference, None, Weighting::Relative).unwrap();
        close(relative.mse.value, ((1.0 + 9.0 + 4.0) / 1.01 + 16.0 / 4.01) / 6.0);
    }

    #[test]
    fn two_pictures_have_no_interval_and_one_has_no_split() {
        let (a, b, reference) = (grey([1.0, 2.0]), grey([3.0, 1.0]), grey([1.0, 1.0]));
        let two = split(&[&a, &b], &reference, None, Weighting::Absolute).unwrap();
        assert_eq!((two.bias2.low, two.bias2.high, two.bias2.samples.len()), (two.bias2.value, two.bias2.value, 0));
        let one = split(&[&a], &reference, None, Weighting::Absolute);
        assert_eq!(one, Err(MetricError::TooFewPictures { given: 1, needed: 2 }));
    }
}
