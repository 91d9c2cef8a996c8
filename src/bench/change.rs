//! How far one figure went from one run to another, and how far chance alone would have taken it.
//!
//! Seeds are independent, so means over seeds follow Student's t: over the seeds' differences where both runs had the same seeds, Welch's
//! for two samples otherwise. Frames are not: a frame's time resembles that of the frame before. The standard error of their median comes
//! from a circular block bootstrap (Politis and Romano 1992), and the statistic is taken as Student's t with half as many degrees
//! of freedom as there are blocks. *Why not the bootstrap's own percentiles:* over a suite of points single tests run at a significance of
//! 1e-4 and below, where percentiles of few frames do not reach.

use super::figure::{Better, FigureKind, Group};
use super::record::Figure;
use crate::metrics::estimate::NORMAL_QUANTILE;
use crate::metrics::statistics::{BatchMeans, quantile, two_sided_p, two_sided_reach};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use serde::Serialize;

/// How two values of a figure are set against each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// B / A.
    Ratio,
    /// B - A.
    Difference,
}

impl Scale {
    /// Ratios for all that is positive by nature; differences where the scale has a fixed point, or values may be negative.
    pub fn of(kind: &FigureKind) -> Self {
        match (kind.group, kind.better, kind.key) {
            (Group::Fault | Group::Table, ..) | (_, Better::One, _) | (.., "psnr" | "ssim" | "bias2" | "temporal") => Scale::Difference,
            _ => Scale::Ratio,
        }
    }
}

/// What is known of a change's error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Spread {
    /// It has none, as bytes and counts.
    Exact,
    /// A single measurement each.
    Unknown,
    /// Of the logarithm of a ratio, or of a difference.
    Estimated { standard_error: f64, degrees_of_freedom: f64 },
}

/// From A to B: medians of times, means of all else.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    pub scale: Scale,
    pub a: f64,
    pub b: f64,
    pub spread: Spread,
}

impl Change {
    /// None where a ratio would not be a positive number. `same_seeds`: sample i of both comes from one seed.
    pub fn of(kind: &FigureKind, a: &Figure, b: &Figure, same_seeds: bool) -> Option<Self> {
        let scale = Scale::of(kind);
        let centre = Centre::of(kind);
        let [centre_a, centre_b] = [a, b].map(|figure| centre.of_figure(figure));
        // Equal values, such as two zeros, are no change on any scale.
        let scale = if centre_a == centre_b && centre_a <= 0.0 { Scale::Difference } else { scale };
        if scale == Scale::Ratio && (centre_a <= 0.0 || centre_b <= 0.0) {
            return None;
        }
        let units = match scale {
            Scale::Ratio => [centre_a, centre_b],
            Scale::Difference => [1.0; 2],
        };
        let sampled = a.samples.len().min(b.samples.len()) > 1;
        let stated = [Error::stated(a, units[0]), Error::stated(b, units[1])];
        let spread = match centre {
            _ if !sampled && is_exact(kind) => Spread::Exact,
            _ if !sampled => {
                if let [Some(a), Some(b)] = stated {
                    welch([a, b])
                } else {
                    Spread::Unknown
                }
            }
            Centre::Mean if same_seeds && a.samples.len() == b.samples.len() => paired(&a.samples, &b.samples, units),
            Centre::Mean => welch([Error::of_mean(&a.samples, units[0]), Error::of_mean(&b.samples, units[1])]),
            Centre::Quantile(at) => welch([Error::of_quantile(&a.samples, at, units[0]), Error::of_quantile(&b.samples, at, units[1])]),
        };
        Some(Change { scale, a: centre_a, b: centre_b, spread })
    }

    /// B / A or B - A.
    pub fn estimate(&self) -> f64 {
        match self.scale {
            Scale::Ratio => self.b / self.a,
            Scale::Difference => self.b - self.a,
        }
    }

    /// Logarithm of the ratio, or the difference: 0 for no change.
    pub fn effect(&self) -> f64 {
        match self.scale {
            Scale::Ratio => (self.b / self.a).ln(),
            Scale::Difference => self.b - self.a,
        }
    }

    /// Holds the true B / A or B - A with probability `confidence`.
    pub fn interval(&self, confidence: f64) -> Option<[f64; 2]> {
        let reach = match self.spread {
            Spread::Exact => 0.0,
            Spread::Unknown => return None,
            Spread::Estimated { standard_error, degrees_of_freedom } => standard_error * two_sided_reach(confidence, degrees_of_freedom),
        };
        Some([-reach, reach].map(|reach| match self.scale {
            Scale::Ratio => self.estimate() * reach.exp(),
            Scale::Difference => self.estimate() + reach,
        }))
    }

    /// Probability of a change at least this large where nothing changed.
    pub fn p_value(&self) -> Option<f64> {
        match self.spread {
            Spread::Unknown => None,
            _ if self.effect() == 0.0 => Some(1.0),
            Spread::Exact => Some(0.0),
            Spread::Estimated { standard_error, .. } if standard_error <= 0.0 => Some(0.0),
            Spread::Estimated { standard_error, degrees_of_freedom } => {
                Some(two_sided_p(self.effect() / standard_error, degrees_of_freedom))
            }
        }
    }
}

/// The same in every run of one program.
fn is_exact(kind: &FigureKind) -> bool {
    matches!(kind.group, Group::Memory | Group::Fault)
}

/// What the samples of a figure are summed up by.
#[derive(Debug, Clone, Copy)]
enum Centre {
    Mean,
    Quantile(f64),
}

impl Centre {
    fn of(kind: &FigureKind) -> Self {
        match (kind.group, kind.key) {
            (Group::Time, "frame_ms_p95") => Centre::Quantile(0.95),
            (Group::Time, _) => Centre::Quantile(0.5),
            _ => Centre::Mean,
        }
    }

    fn of_figure(self, figure: &Figure) -> f64 {
        match self {
            _ if figure.samples.len() < 2 => figure.value,
            Centre::Mean => figure.samples.iter().sum::<f64>() / figure.samples.len() as f64,
            Centre::Quantile(at) => quantile(figure.samples.clone(), at),
        }
    }
}

/// Of one run's centre.
#[derive(Debug, Clone, Copy)]
struct Error {
    variance: f64,
    degrees_of_freedom: f64,
}

impl Error {
    /// Of a normal figure that came with an interval and no samples.
    fn stated(figure: &Figure, unit: f64) -> Option<Self> {
        let standard_error = (figure.high - figure.low) / (2.0 * NORMAL_QUANTILE) / unit;
        (standard_error > 0.0).then_some(Error { variance: standard_error.powi(2), degrees_of_freedom: f64::INFINITY })
    }

    fn of_mean(samples: &[f64], unit: f64) -> Self {
        let batches: BatchMeans = samples.iter().map(|sample| sample / unit).collect();
        Error { variance: batches.variance_of_mean(), degrees_of_freedom: samples.len() as f64 - 1.0 }
    }

    /// Circular block bootstrap: samples are drawn in runs of neighbours, so that each replicate resembles itself as the series does.
    fn of_quantile(samples: &[f64], at: f64, unit: f64) -> Self {
        const REPLICATES: u64 = 400;
        let block = block_length(samples);
        let mut rng = Pcg32::seed_from_u64(0);
        let replicates: BatchMeans = (0..REPLICATES).map(|_| quantile(resampled(samples, block, &mut rng), at) / unit).collect();
        let blocks = samples.len() as f64 / block as f64;
        // `variance_of_mean` divides by the number of replicates, which says nothing about the quantile.
        Error { variance: replicates.variance_of_mean() * REPLICATES as f64, degrees_of_freedom: (blocks / 2.0 - 1.0).max(1.0) }
    }
}

fn resampled(samples: &[f64], block: usize, rng: &mut Pcg32) -> Vec<f64> {
    let count = samples.len();
    let starts = std::iter::repeat_with(|| rng.random_range(0..count));
    starts.flat_map(|start| (start..start + block).map(|place| samples[place % count])).take(count).collect()
}

/// The length that is best for an autoregressive series of first order (Carlstein 1986, "The Use of Subseries Values for Estimating the
/// Variance of a General Statistic from a Stationary Sequence"), at most a quarter of the series.
fn block_length(samples: &[f64]) -> usize {
    let count = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / count;
    let product = |lag: usize| samples.iter().zip(&samples[lag..]).map(|(x, y)| (x - mean) * (y - mean)).sum::<f64>();
    let correlation = (product(1) / product(0)).clamp(0.0, 0.97);
    let length = (2.0 * correlation / (1.0 - correlation * correlation)).powf(2.0 / 3.0) * count.cbrt();
    // A constant series has no correlation: NaN becomes 0 in the cast.
    (length.ceil() as usize).clamp(1, (samples.len() / 4).max(1))
}

/// Over the differences of equal seeds: what both runs drew alike cancels. For ratios these are the first order of B's and A's logarithms.
fn paired(a: &[f64], b: &[f64], units: [f64; 2]) -> Spread {
    let differences: BatchMeans = a.iter().zip(b).map(|(a, b)| b / units[1] - a / units[0]).collect();
    Spread::Estimated { standard_error: differences.variance_of_mean().sqrt(), degrees_of_freedom: a.len() as f64 - 1.0 }
}

/// Two samples of unequal variances (Welch 1947), with Satterthwaite's degrees of freedom.
fn welch(errors: [Error; 2]) -> Spread {
    let variance: f64 = errors.iter().map(|error| error.variance).sum();
    let spread_of_variance: f64 = errors.iter().map(|error| error.variance * error.variance / error.degrees_of_freedom).sum();
    let degrees_of_freedom = if variance > 0.0 { variance * variance / spread_of_variance } else { 1.0 };
    Spread::Estimated { standard_error: variance.sqrt(), degrees_of_freedom }
}

#[cfg(test)]
mod tests {
    use super::super::figure;
    use super::*;

    fn change(key: &str, a: &[f64], b: &[f64], same_seeds: bool) -> Change {
        let figure = |samples: &[f64]| Figure { value: samples[0], low: 0.0, high: 0.0, unit: String::new(), samples: samples.to_vec() };
        Change::of(figure::find(key).unwrap(), &figure(a), &figure(b), same_seeds).unwrap()
    }

    /// By hand: differences 1, 2, 3 have mean 2 and standard error 1 / sqrt(3); t(2) at 97.5 % is 4.302653.
    #[test]
    fn equal_seeds_are_paired() {
        let change = change("energy", &[1.0, 5.0, 9.0], &[2.0, 7.0, 12.0], true);
        let [low, high] = change.interval(0.95).unwrap();
        let reach = 4.302_653 / 3f64.sqrt();
        assert!((low - (2.0 - reach)).abs() < 1e-5 && (high - (2.0 + reach)).abs() < 1e-5, "{low} {high}");
        assert!((change.p_value().unwrap() - 0.074_18).abs() < 1e-5, "t = 3.4641 with 2 degrees of freedom");
    }

    /// By hand: variances of the means 4/3 and 16/3, together 20/3; degrees of freedom (20/3)^2 / ((16/9 + 256/9) / 2) = 50/17.
    #[test]
    fn other_seeds_are_two_samples() {
        let change = change("energy", &[1.0, 3.0, 5.0], &[2.0, 6.0, 10.0], false);
        let Spread::Estimated { standard_error, degrees_of_freedom } = change.spread else { panic!("{change:?}") };
        assert!((standard_error - (20f64 / 3.0).sqrt()).abs() < 1e-12 && (degrees_of_freedom - 50.0 / 17.0).abs() < 1e-12);
    }

    #[test]
    fn ratios_do_not_depend_on_the_unit() {
        let [a, b] = [[4.0, 5.0, 6.0, 5.5], [5.0, 5.5, 6.5, 6.0]];
        let [small, large] = [1.0, 1e6].map(|unit| change("relmse", &a.map(|x| x * unit), &b.map(|x| x * unit), true));
        assert!((small.estimate() - large.estimate()).abs() < 1e-12);
        assert!((small.p_value().unwrap() - large.p_value().unwrap()).abs() < 1e-9);
    }

    #[test]
    fn what_has_one_sample_has_no_interval_unless_it_is_exact() {
        assert_eq!(change("load_ms", &[10.0], &[20.0], true).p_value(), None);
        assert_eq!(change("memory_bytes", &[10.0], &[20.0], true).interval(0.95), Some([2.0; 2]));
        assert_eq!(change("memory_bytes", &[10.0], &[10.0], true).p_value(), Some(1.0));
        assert_eq!(change("relmse", &[0.0], &[0.0], true).estimate(), 0.0);
    }

    /// By hand: standard errors 0.03 and 0.04 of means near 1 make 0.05 of their ratio.
    #[test]
    fn figures_that_state_an_interval_are_normal() {
        let figure = |value: f64, error: f64| Figure {
            value,
            low: value - NORMAL_QUANTILE * error,
            high: value + NORMAL_QUANTILE * error,
            unit: String::new(),
            samples: vec![],
        };
        let kind = figure::find("reference_radiance").unwrap();
        let change = Change::of(kind, &figure(1.0, 0.03), &figure(1.0, 0.04), true).unwrap();
        let Spread::Estimated { standard_error, degrees_of_freedom } = change.spread else { panic!("{change:?}") };
        assert!((standard_error - 0.05).abs() < 1e-12 && degrees_of_freedom.is_infinite());
        let [low, high] = change.interval(0.95).unwrap();
        assert!((low - (-NORMAL_QUANTILE * 0.05).exp()).abs() < 1e-9 && (high - (NORMAL_QUANTILE * 0.05).exp()).abs() < 1e-9);
    }

    #[test]
    fn correlated_frames_come_in_long_blocks() {
        let alternating: Vec<f64> = (0..64).map(|i| f64::from(i % 2)).collect();
        let slow: Vec<f64> = (0..64).map(|i| f64::from(i / 8 % 2)).collect();
        assert_eq!(block_length(&alternating), 1);
        assert!(block_length(&slow) > 4);
        assert_eq!(block_length(&[3.0; 64]), 1, "constant");
    }
}
