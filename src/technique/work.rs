//! How much a frame does, by one number: what a governor turns to keep to a time.

use serde::{Deserialize, Serialize};

/// What a frame does for its picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Work {
    /// Per pixel; of a technique that goes in rounds a whole number.
    pub samples: f64,
    /// `rays.first_shadow_rays`.
    pub first_shadow_rays: u32,
}

/// The largest of `rays.first_shadow_rays`.
pub const MOST_SHADOW_RAYS: u32 = 64;

/// From effort to work. Effort is a frame's time as a multiple of the least frame's: one sample per pixel. Samples follow it; where they go
/// in rounds, which are whole, shadow rays take what is left between two numbers of rounds: the one thing that can grow by a little, and
/// brings some accuracy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    pub rounds: bool,
    /// Of the least frame.
    pub first_shadow_rays: u32,
    /// What another sample per pixel takes, above 0.
    pub effort_of_sample: f64,
    /// What another shadow ray of one sample takes; 0 or less: nothing to be measured, so none is sent.
    pub effort_of_ray: f64,
    pub most_samples: f64,
}

impl Scale {
    /// The most work that takes no more than this effort; the least where it is less than 1.
    pub fn work(&self, effort: f64) -> Work {
        let samples = (1.0 + (effort - 1.0) / self.effort_of_sample).clamp(1.0, self.most_samples);
        if !self.rounds {
            return Work { samples, first_shadow_rays: self.first_shadow_rays };
        }
        // Rounding must not lose a round.
        let samples = (samples + 1e-9).floor();
        let left = effort - self.effort(&Work { samples, first_shadow_rays: self.first_shadow_rays });
        let rays = left / (samples * self.effort_of_ray);
        let more = if self.effort_of_ray > 0.0 { (rays + 1e-9).max(0.0) as u32 } else { 0 };
        Work { samples, first_shadow_rays: self.first_shadow_rays.saturating_add(more).min(self.most_rays()) }
    }

    /// What this work takes.
    pub fn effort(&self, work: &Work) -> f64 {
        let more = f64::from(work.first_shadow_rays) - f64::from(self.first_shadow_rays);
        1.0 + (work.samples - 1.0) * self.effort_of_sample + work.samples * more * self.effort_of_ray.max(0.0)
    }

    /// Beyond which no more is done.
    pub fn most_effort(&self) -> f64 {
        self.effort(&Work { samples: self.most_samples, first_shadow_rays: self.most_rays() })
    }

    fn most_rays(&self) -> u32 {
        if self.rounds && self.effort_of_ray > 0.0 { MOST_SHADOW_RAYS.max(self.first_shadow_rays) } else { self.first_shadow_rays }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rounds() -> Scale {
        Scale { rounds: true, first_shadow_rays: 1, effort_of_sample: 1.0, effort_of_ray: 0.05, most_samples: 8.0 }
    }

    #[test]
    fn rounds_are_whole_and_shadow_rays_fill_what_lies_between() {
        for effort in (100..900).map(|percent| f64::from(percent) / 100.0) {
            let work = rounds().work(effort);
            assert_eq!(work.samples, effort.floor().min(8.0), "{effort}");
            let used = rounds().effort(&work);
            assert!(used <= effort + 1e-6 && used > effort - work.samples * 0.05 - 1e-6, "{effort}: {used}");
        }
    }

    #[test]
    fn samples_that_need_no_rounds_are_fractions() {
        let scale = Scale { rounds: false, effort_of_sample: 0.5, most_samples: f64::INFINITY, ..rounds() };
        assert_eq!(scale.work(2.25), Work { samples: 3.5, first_shadow_rays: 1 });
    }

    #[test]
    fn work_stays_within_its_bounds() {
        assert_eq!(rounds().work(0.1), Work { samples: 1.0, first_shadow_rays: 1 });
        assert_eq!(rounds().work(1e9), Work { samples: 8.0, first_shadow_rays: MOST_SHADOW_RAYS });
        assert_eq!(rounds().effort(&rounds().work(1e9)), rounds().most_effort());
        let dark = Scale { effort_of_ray: -0.01, ..rounds() };
        assert_eq!(dark.work(3.9), Work { samples: 3.0, first_shadow_rays: 1 });
    }

    #[test]
    fn the_parameter_goes_as_far() {
        let mut parameters = crate::technique::Parameters::default();
        assert!(parameters.set("rays.first_shadow_rays", &MOST_SHADOW_RAYS.to_string()).is_ok());
        assert!(parameters.set("rays.first_shadow_rays", &(MOST_SHADOW_RAYS + 1).to_string()).is_err());
    }
}
