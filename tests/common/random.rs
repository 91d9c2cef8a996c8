//! Random numbers of a fixed seed.

use rand::Rng;
use rand_pcg::Pcg32;
use statrs::distribution::{ContinuousCDF, Normal};

/// Standard normal.
pub fn normal(rng: &mut Pcg32) -> f64 {
    Normal::standard().inverse_cdf(rng.random_range(f64::EPSILON..1.0))
}
