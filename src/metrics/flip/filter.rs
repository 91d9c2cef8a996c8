//! FLIP's two filters: what contrast the eye resolves at which frequency (section 4.1.1), and where it sees edges and points (4.2).

use rayon::prelude::*;
use std::f64::consts::PI;

/// One channel of a picture, rows from the top.
pub struct Plane {
    pub width: usize,
    pub values: Vec<f64>,
}

/// Weights of an odd number of taps.
type Kernel = Vec<f64>;

/// `weight(x)` for whole x from -radius to radius.
fn sampled(radius: usize, weight: impl Fn(f64) -> f64) -> Kernel {
    (0..=2 * radius).map(|i| weight(i as f64 - radius as f64)).collect()
}

fn sum(kernel: &Kernel) -> f64 {
    kernel.iter().sum()
}

/// Positive weights that sum to 1 and negative ones that sum to -1.
fn balanced(kernel: Kernel) -> Kernel {
    let positive: f64 = kernel.iter().filter(|weight| **weight > 0.0).sum();
    let negative: f64 = -kernel.iter().filter(|weight| **weight < 0.0).sum::<f64>();
    kernel.into_iter().map(|weight| if weight > 0.0 { weight / positive } else { weight / negative }).collect()
}

impl Plane {
    /// Beyond the border, its nearest pixel counts.
    fn along_rows(&self, kernel: &Kernel) -> Plane {
        let radius = kernel.len() / 2;
        let mut values = vec![0.0; self.values.len()];
        values.par_chunks_mut(self.width).zip(self.values.par_chunks(self.width)).for_each(|(result, row)| {
            let [first, last] = [row[0], row[row.len() - 1]].map(|value| std::iter::repeat_n(value, radius));
            let padded: Vec<f64> = first.chain(row.iter().copied()).chain(last).collect();
            for (weight, shifted) in kernel.iter().zip(padded.windows(row.len())) {
                add_scaled(result, *weight, shifted);
            }
        });
        Plane { width: self.width, values }
    }

    fn along_columns(&self, kernel: &Kernel) -> Plane {
        let (radius, height) = (kernel.len() / 2, self.values.len() / self.width);
        let mut values = vec![0.0; self.values.len()];
        values.par_chunks_mut(self.width).enumerate().for_each(|(y, result)| {
            for (k, weight) in kernel.iter().enumerate() {
                let row = (y + k).saturating_sub(radius).min(height - 1) * self.width;
                add_scaled(result, *weight, &self.values[row..row + self.width]);
            }
        });
        Plane { width: self.width, values }
    }
}

fn add_scaled(sum: &mut [f64], weight: f64, values: &[f64]) {
    sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
}

/// The contrast sensitivity functions of an achromatic and two opponent channels, each a sum of Gaussians over the visual angle:
/// a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees. (a, b) after table 1.
const ACHROMATIC: &[(f64, f64)] = &[(1.0, 0.0047)];
const RED_GREEN: &[(f64, f64)] = &[(1.0, 0.0053)];
const BLUE_YELLOW: &[(f64, f64)] = &[(34.1, 0.04), (13.5, 0.025)];
/// The widest of them decides the radius of all: three of its standard deviations sqrt(b / 2) / pi.
const WIDEST: f64 = 0.04;

pub struct Contrast {
    /// Of each channel: Gaussians, with the weight of each.
    channels: [Vec<(f64, Kernel)>; 3],
}

impl Contrast {
    pub fn at(pixels_per_degree: f64) -> Contrast {
        let radius = (3.0 * (WIDEST / 2.0).sqrt() / PI * pixels_per_degree).ceil() as usize;
        let gaussian = |b: f64| sampled(radius, |x| (-(PI * x / pixels_per_degree).powi(2) / b).exp());
        let channel = |terms: &[(f64, f64)]| {
            let kernels: Vec<(f64, Kernel)> = terms.iter().map(|&(a, b)| (a * (PI / b).sqrt(), gaussian(b))).collect();
            let total: f64 = kernels.iter().map(|(weight, kernel)| weight * sum(kernel).powi(2)).sum();
            kernels.into_iter().map(|(weight, kernel)| (weight / total, kernel)).collect()
        };
        Contrast { channels: [ACHROMATIC, RED_GREEN, BLUE_YELLOW].map(channel) }
    }

    /// What is left of the channels Y, Cx and Cz.
    pub fn seen(&self, channels: [Plane; 3]) -> [Plane; 3] {
        let seen = |plane: &Plane, gaussians: &[(f64, Kernel)]| {
            let mut values = vec![0.0; plane.values.len()];
            for (weight, kernel) in gaussians {
                add_scaled(&mut values, *weight, &plane.along_rows(kernel).along_columns(kernel).values);
            }
            Plane { width: plane.width, values }
        };
        std::array::from_fn(|i| seen(&channels[i], &self.channels[i]))
    }
}

/// Width in degrees of the features that an eye detects best.
const FEATURE_WIDTH: f64 = 0.082;

/// First and second derivative of a Gaussian: they answer to edges, and to points and lines.
pub struct Features {
    gaussian: Kernel,
    derivatives: [Kernel; 2],
}

impl Features {
    pub fn at(pixels_per_degree: f64) -> Features {
        let sigma = 0.5 * FEATURE_WIDTH * pixels_per_degree;
        let radius = (3.0 * sigma).ceil() as usize;
        let bell = |x: f64| (-0.5 * (x / sigma).powi(2)).exp();
        let gaussian = sampled(radius, bell);
        let total = sum(&gaussian);
        let edge = sampled(radius, |x| -x * bell(x));
        let point = sampled(radius, |x| ((x / sigma).powi(2) - 1.0) * bell(x));
        Features { gaussian: gaussian.into_iter().map(|weight| weight / total).collect(), derivatives: [balanced(edge), balanced(point)] }
    }

    /// Lengths of the two gradients of luminance, for each pixel: of edges, of points.
    pub fn strengths(&self, luminance: &Plane) -> [Vec<f64>; 2] {
        let smooth_rows = luminance.along_rows(&self.gaussian);
        [0, 1].map(|kind: usize| {
            let derivative = &self.derivatives[kind];
            let across = luminance.along_rows(derivative).along_columns(&self.gaussian);
            let down = smooth_rows.along_columns(derivative);
            across.values.iter().zip(&down.values).map(|(x, y)| x.hypot(*y)).collect()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_constant_is_seen_as_it_is_and_has_no_features() {
        let flat = || Plane { width: 7, values: vec![0.6; 35] };
        for plane in Contrast::at(67.0).seen([flat(), flat(), flat()]) {
            assert!(plane.values.iter().all(|value| (value - 0.6).abs() < 1e-12));
        }
        assert!(Features::at(67.0).strengths(&flat()).iter().flatten().all(|strength| *strength < 1e-12));
    }

    #[test]
    fn a_step_is_an_edge_along_its_whole_length() {
        let step = Plane { width: 32, values: (0..320).map(|i| if i % 32 < 16 { 0.0 } else { 1.0 }).collect() };
        let [edges, _] = Features::at(67.0).strengths(&step);
        let strongest = edges.iter().copied().fold(0.0, f64::max);
        // Half of the derivative's weights lie on either side of the step.
        assert!((strongest - 1.0).abs() < 1e-12, "{strongest}");
        assert!((0..10).all(|y| (edges[y * 32 + 15] - strongest).abs() < 1e-12 && edges[y * 32] < 0.01));
    }
}
