//! Numbers with 95 % confidence intervals, from few independent samples.

use super::statistics::{BatchMeans, two_sided_reach};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// A value and where the true one lies: an interval made this way misses it once in 20 times.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    pub value: f64,
    /// Equal to `value`, as `high`, where there is no interval: for exact values and for one sample.
    pub low: f64,
    pub high: f64,
    /// What `value` sums up, in the order given; empty for exact values.
    pub samples: Vec<f64>,
}

/// Why samples have no estimate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SampleError {
    #[error("there are no samples")]
    Empty,
    #[error("sample {index} is {value}, which is not finite")]
    NotFinite { index: usize, value: f64 },
}

/// Rank of the lower and upper 2.5 % quantiles among the sorted resamples, whose number plus 1 is divisible by 40.
const RESAMPLES: usize = 1999;
const TAIL: usize = (RESAMPLES + 1) / 40;

/// Of fewer samples there are too few different resamples.
const FEWEST_RESAMPLED: usize = 5;

impl Estimate {
    pub fn exact(value: f64) -> Estimate {
        Estimate { value, low: value, high: value, samples: vec![] }
    }

    /// Mean of independent samples of one distribution, with its bootstrap-t interval (Efron 1981; Hall 1988): quantiles of the
    /// studentized mean over resamples replace those of Student's t, so that the interval leans as the distribution does. Fewer than
    /// five samples, and those so discrete that many resamples do not vary, have Student's interval.
    ///
    /// Coverage of 2,000 intervals each, in tests/statistics/intervals.rs: of 8 samples 95 % for normal ones, 94 % for log-normal ones of
    /// sigma 0.5, 89 % of sigma 1, where Student's has 95, 91 and 82 %.
    pub fn mean(samples: Vec<f64>) -> Result<Estimate, SampleError> {
        check(&samples)?;
        let moments: BatchMeans = samples.iter().copied().collect();
        let [low, high] = match samples.len() {
            1 => [moments.mean; 2],
            2..FEWEST_RESAMPLED => student_interval(&moments),
            _ => bootstrap_interval(&samples, &moments).unwrap_or_else(|| student_interval(&moments)),
        };
        Ok(Estimate { value: moments.mean, low: low.min(moments.mean), high: high.max(moments.mean), samples })
    }

    /// The same with the value's own error widened by an independent normal one of this standard deviation.
    pub fn widened(self, standard_deviation: f64) -> Estimate {
        let spread = NORMAL_QUANTILE * standard_deviation;
        let low = self.value - (self.value - self.low).hypot(spread);
        Estimate { low, high: self.value + (self.high - self.value).hypot(spread), ..self }
    }

    /// This minus an independent other. The interval recovers each one's variance on the side that matters from its own interval
    /// (Zou and Donner 2008, equation 7), so that it holds for means, medians or whatever the two are.
    pub fn minus(&self, other: &Estimate) -> Estimate {
        let value = self.value - other.value;
        let low = value - (self.value - self.low).hypot(other.high - other.value);
        let high = value + (self.high - self.value).hypot(other.value - other.low);
        Estimate { value, low, high, samples: vec![] }
    }

    /// This over an independent other, both positive: [`Estimate::minus`] of the logarithms. `low` is 0 where this may be 0, and `high`
    /// infinite where the other may be; NaN where either value is not positive.
    pub fn over(&self, other: &Estimate) -> Estimate {
        let logarithms = self.logarithm().minus(&other.logarithm());
        Estimate { value: logarithms.value.exp(), low: logarithms.low.exp(), high: logarithms.high.exp(), samples: vec![] }
    }

    fn logarithm(&self) -> Estimate {
        Estimate { value: self.value.ln(), low: self.low.max(0.0).ln(), high: self.high.ln(), samples: vec![] }
    }
}

/// Of the standard normal distribution, at 97.5 %.
pub(crate) const NORMAL_QUANTILE: f64 = 1.959_963_984_540_054;

pub(super) fn check(samples: &[f64]) -> Result<(), SampleError> {
    match samples.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(SampleError::NotFinite { index, value: samples[index] }),
        None if samples.is_empty() => Err(SampleError::Empty),
        None => Ok(()),
    }
}

fn student_interval(moments: &BatchMeans) -> [f64; 2] {
    let half = two_sided_reach(0.95, (moments.batches - 1) as f64) * moments.variance_of_mean().sqrt();
    [moments.mean - half, moments.mean + half]
}

/// None where more than 2.5 % of the resamples do not vary on one side.
fn bootstrap_interval(samples: &[f64], moments: &BatchMeans) -> Option<[f64; 2]> {
    let standard_error = moments.variance_of_mean().sqrt();
    if standard_error == 0.0 {
        return Some([moments.mean; 2]);
    }
    let mut rng = Pcg32::seed_from_u64(0);
    let mut studentized: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let resample: BatchMeans = (0..samples.len()).map(|_| samples[rng.random_range(0..samples.len())]).collect();
            (resample.mean - moments.mean) / resample.variance_of_mean().sqrt()
        })
        .collect();
    studentized.sort_unstable_by(f64::total_cmp);
    let [low, high] = [studentized[RESAMPLES - TAIL], studentized[TAIL - 1]].map(|t| moments.mean - t * standard_error);
    (low.is_finite() && high.is_finite()).then_some([low, high])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(samples: &[f64]) -> Estimate {
        Estimate::mean(samples.to_vec()).unwrap()
    }

    /// Student's t of 2 degrees of freedom is 4.302653 at 97.5 %, the standard error 1 / sqrt(3).
    #[test]
    fn three_samples_have_students_interval() {
        let estimate = mean(&[1.0, 2.0, 3.0]);
        assert_eq!(estimate.value, 2.0);
        let half = 4.302_653 / 3f64.sqrt();
        assert!((estimate.low - (2.0 - half)).abs() < 1e-5 && (estimate.high - (2.0 + half)).abs() < 1e-5, "{estimate:?}");
    }

    #[test]
    fn one_sample_and_equal_samples_have_no_width() {
        for samples in [&[0.3][..], &[0.3; 3], &[0.3; 8]] {
            let Estimate { value, low, high, .. } = mean(samples);
            assert!((low, high) == (value, value) && (value - 0.3).abs() < 1e-15, "{samples:?}: {low} {high}");
        }
    }

    #[test]
    fn one_outlier_among_equal_samples_has_a_finite_interval() {
        let estimate = mean(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0]);
        assert!(estimate.low < 1.0 && estimate.high > 1.25 && estimate.high.is_finite(), "{estimate:?}");
    }

    #[test]
    fn intervals_lean_as_their_samples_do() {
        let estimate = mean(&[0.9, 1.0, 1.1, 1.0, 0.95, 1.2, 1.6, 3.0]);
        assert!(estimate.high - estimate.value > 2.0 * (estimate.value - estimate.low), "{estimate:?}");
    }

    #[test]
    fn no_samples_and_samples_that_are_not_finite_are_refused() {
        assert_eq!(Estimate::mean(vec![]), Err(SampleError::Empty));
        assert_eq!(Estimate::mean(vec![1.0, f64::INFINITY]), Err(SampleError::NotFinite { index: 1, value: f64::INFINITY }));
    }

    #[test]
    fn a_ratio_with_what_may_be_zero_is_unbounded() {
        let sure = Estimate { value: 2.0, low: 1.9, high: 2.1, samples: vec![] };
        let unsure = Estimate { value: 1.0, low: -0.5, high: 2.5, samples: vec![] };
        assert_eq!(sure.over(&unsure).high, f64::INFINITY);
        assert_eq!(unsure.over(&sure).low, 0.0);
        assert!((sure.over(&Estimate::exact(4.0)).low - 0.475).abs() < 1e-12);
    }
}
