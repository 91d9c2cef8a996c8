//! What tells a difference from chance. Every test here returns a p-value: the probability of a result at least this far
//! from what was expected, if nothing but chance is at work.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

/// The value that a fraction `at` (0 to 1) of `values` stays below, interpolated linearly between neighbours in order.
/// NaN for no values.
pub fn quantile(mut values: Vec<f64>, at: f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let place = at.clamp(0.0, 1.0) * values.len().saturating_sub(1) as f64;
    match (values.get(place.floor() as usize), values.get(place.ceil() as usize)) {
        (Some(low), Some(high)) => low + (high - low) * place.fract(),
        _ => f64::NAN,
    }
}

/// The significance at which each of `tests` independent tests must run so that all of them together raise a false alarm
/// with probability `significance` (Sidak 1967).
pub fn sidak(significance: f64, tests: usize) -> f64 {
    -((-significance).ln_1p() / tests as f64).exp_m1()
}

/// Degrees of freedom beyond which Student's t and the normal distribution differ by less than double precision can show in the incomplete
/// beta function. The library does not invert the former where they are infinite.
const NORMAL_FROM: f64 = 1e6;

/// Probability that a standard normal variable is further from 0 than `z`; Student's t for few `degrees_of_freedom`, which
/// may be infinite.
pub fn two_sided_p(z: f64, degrees_of_freedom: f64) -> f64 {
    let student = || StudentsT::new(0.0, 1.0, degrees_of_freedom).ok();
    let tail = match degrees_of_freedom < NORMAL_FROM {
        true => student().map_or(f64::NAN, |distribution| distribution.sf(z.abs())),
        false => Normal::standard().sf(z.abs()),
    };
    2.0 * tail
}

/// What a standard normal variable, or Student's t, is no further from 0 than with probability `confidence`: undoes [`two_sided_p`].
pub fn two_sided_reach(confidence: f64, degrees_of_freedom: f64) -> f64 {
    let at = 0.5 + confidence / 2.0;
    match degrees_of_freedom < NORMAL_FROM {
        true => StudentsT::new(0.0, 1.0, degrees_of_freedom).map_or(f64::NAN, |distribution| distribution.inverse_cdf(at)),
        false => Normal::standard().inverse_cdf(at),
    }
}

/// Mean and estimated variance *of that mean*, from independent batches (Welford's recurrence).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BatchMeans {
    pub batches: u64,
    pub mean: f64,
    squared_deviations: f64,
}

impl BatchMeans {
    /// Adds one batch's mean. All batches must hold the same number of samples.
    pub fn add(&mut self, batch_mean: f64) {
        self.batches += 1;
        let deviation = batch_mean - self.mean;
        self.mean += deviation / self.batches as f64;
        self.squared_deviations += deviation * (batch_mean - self.mean);
    }

    /// NaN before the second batch.
    pub fn variance_of_mean(&self) -> f64 {
        match self.batches {
            0 | 1 => f64::NAN,
            n => self.squared_deviations / (n as f64 * (n - 1) as f64),
        }
    }
}

impl FromIterator<f64> for BatchMeans {
    fn from_iter<I: IntoIterator<Item = f64>>(batch_means: I) -> Self {
        let mut result = BatchMeans::default();
        batch_means.into_iter().for_each(|mean| result.add(mean));
        result
    }
}

/// Pearson's chi-square test of counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChiSquare {
    pub statistic: f64,
    pub degrees_of_freedom: usize,
    /// Small where the counts do not follow what was expected.
    pub p_value: f64,
}

/// Compares how often each cell was hit with how often it should be: expected counts, not probabilities, of the same total.
///
/// Cells of fewer than 5 expected hits are pooled, smallest first, until a pool has 5, since the statistic follows its
/// distribution only there. A hit in a cell that expects none has a p-value of 0.
pub fn chi_square_test(observed: &[u64], expected: &[f64]) -> ChiSquare {
    assert_eq!(observed.len(), expected.len(), "one expected count for each cell");
    let mut cells: Vec<(f64, f64)> = expected.iter().copied().zip(observed.iter().map(|&count| count as f64)).collect();
    let impossible = cells.iter().any(|&(expected, observed)| expected <= 0.0 && observed > 0.0);
    cells.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let pools = pooled(&cells);
    let statistic =
        if impossible { f64::INFINITY } else { pools.iter().map(|(expected, observed)| (observed - expected).powi(2) / expected).sum() };
    let degrees_of_freedom = pools.len().saturating_sub(1);
    let p_value = match ChiSquared::new(degrees_of_freedom as f64) {
        Ok(distribution) if !impossible => distribution.sf(statistic),
        // One pool says nothing.
        Err(_) if !impossible => 1.0,
        _ => 0.0,
    };
    ChiSquare { statistic, degrees_of_freedom, p_value }
}

/// Merges (expected, observed) cells, given in rising order of expectation, into pools that expect at least 5.
fn pooled(cells: &[(f64, f64)]) -> Vec<(f64, f64)> {
    const FEWEST: f64 = 5.0;
    let mut pools: Vec<(f64, f64)> = Vec::new();
    for &(expected, observed) in cells.iter().filter(|cell| cell.0 > 0.0) {
        match pools.last_mut() {
            Some(pool) if pool.0 < FEWEST => *pool = (pool.0 + expected, pool.1 + observed),
            _ => pools.push((expected, observed)),
        }
    }
    pools
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_interpolate() {
        assert_eq!(quantile(vec![3.0, 1.0, 2.0], 0.5), 2.0);
        assert_eq!(quantile(vec![10.0, 0.0], 0.99), 9.9);
        assert!(quantile(vec![], 0.5).is_nan());
    }

    #[test]
    fn sidak_is_exact_for_many_tests() {
        assert!((sidak(0.01, 1) - 0.01).abs() < 1e-15);
        let threshold = sidak(0.01, 1_000_000);
        assert!((threshold - 1.005_033_580e-8).abs() < 1e-16, "{threshold}");
    }

    /// Tabulated quantiles: 1.959964 (normal), 2.228139 (t, 10), 5.326724 (normal, 1e-7).
    #[test]
    fn two_sided_p_matches_the_tables() {
        assert!((two_sided_p(-1.959_964, f64::INFINITY) - 0.05).abs() < 1e-7);
        assert!((two_sided_p(2.228_139, 10.0) - 0.05).abs() < 1e-7);
        assert!((two_sided_p(5.326_724, f64::INFINITY) / 1e-7 - 1.0).abs() < 1e-4);
        assert!((two_sided_reach(0.95, f64::INFINITY) - 1.959_964).abs() < 1e-6);
        assert!((two_sided_reach(0.95, 10.0) - 2.228_139).abs() < 1e-6);
        assert!((two_sided_p(5.0, 0.99e6) / two_sided_p(5.0, 1.01e6) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn batch_means_keep_precision_beside_a_large_mean() {
        let batches: BatchMeans = [4.0, 7.0, 13.0, 16.0].map(|x| x + 1e9).into_iter().collect();
        assert_eq!((batches.mean, batches.variance_of_mean()), (1e9 + 10.0, 7.5));
    }

    #[test]
    fn chi_square_pools_small_cells() {
        // Pools: 1 + 1 + 4 = 6 expected, then 20 and 30.
        let result = chi_square_test(&[30, 0, 2, 22, 2], &[30.0, 1.0, 1.0, 20.0, 4.0]);
        assert_eq!(result.degrees_of_freedom, 2);
        assert!((result.statistic - (4.0 / 6.0 + 4.0 / 20.0)).abs() < 1e-12);
    }

    #[test]
    fn chi_square_refuses_the_impossible_and_the_unlikely() {
        assert_eq!(chi_square_test(&[50, 50, 1], &[50.0, 50.0, 0.0]).p_value, 0.0);
        assert!(chi_square_test(&[600, 400], &[500.0, 500.0]).p_value < 1e-9);
        assert!(chi_square_test(&[505, 495], &[500.0, 500.0]).p_value > 0.5);
        assert_eq!(chi_square_test(&[3], &[3.0]).p_value, 1.0);
    }
}
