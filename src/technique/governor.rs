//! Keeps frames within a time budget by what they do.

/// Follows what frames take. A frame's time is known one or two frames later, so corrections are damped: a step goes half the way, in
/// proportion, and effort need not be quite what a frame's time is proportional to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Governor {
    budget_ms: f64,
    effort: f64,
    most: f64,
}

/// Share of a correction, as an exponent.
const DAMPING: f64 = 0.5;
/// One frame changes the effort by this factor at most: a hitch of the machine is no reason to give up the picture.
const LARGEST_STEP: f64 = 1.5;

impl Governor {
    /// Begins with this effort (technique::Scale), at least 1, and goes up to `most`.
    pub fn new(budget_ms: f64, effort: f64, most: f64) -> Self {
        Self { budget_ms, effort: effort.clamp(1.0, most), most }
    }

    /// Of the next frame.
    pub fn effort(&self) -> f64 {
        self.effort
    }

    /// A frame has taken `ms`.
    pub fn observe(&mut self, ms: f64) {
        if ms.is_finite() && ms > 0.0 {
            let step = (self.budget_ms / ms).powf(DAMPING).clamp(1.0 / LARGEST_STEP, LARGEST_STEP);
            self.effort = (self.effort * step).clamp(1.0, self.most);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::statistics::quantile;
    use rand::{Rng, SeedableRng};

    /// Median of 200 frames of a device that takes `fixed + per_effort * effort` ms, two frames late, with 10 % of noise.
    fn median(budget: f64, fixed: f64, per_effort: f64, start: f64) -> f64 {
        let mut rng = rand_pcg::Pcg32::seed_from_u64(3);
        let mut governor = Governor::new(budget, start, 1e6);
        let mut times: Vec<f64> = Vec::new();
        for frame in 0..220 {
            times.push((fixed + per_effort * governor.effort()) * rng.random_range(0.9..1.1));
            if frame >= 2 {
                governor.observe(times[frame - 2]);
            }
        }
        quantile(times.split_off(20), 0.5)
    }

    #[test]
    fn frames_keep_to_the_budget_whatever_they_cost() {
        for (fixed, per_effort, start) in [(0.1, 0.3, 1.0), (5.0, 2.0, 1.0), (0.0, 0.01, 3.0), (1.0, 4.0, 200.0)] {
            let found = median(16.6, fixed, per_effort, start);
            assert!((found / 16.6 - 1.0).abs() < 0.03, "{fixed} {per_effort}: {found}");
        }
    }

    #[test]
    fn effort_stays_within_its_bounds_and_nonsense_is_ignored() {
        let mut governor = Governor::new(16.6, 1.0, 2.0);
        (0..20).for_each(|_| governor.observe(1.0));
        assert_eq!(governor.effort(), 2.0);
        (0..20).for_each(|_| governor.observe(1e9));
        assert_eq!(governor.effort(), 1.0);
        [f64::NAN, 0.0, -1.0].into_iter().for_each(|ms| governor.observe(ms));
        assert_eq!(governor.effort(), 1.0);
    }
}
