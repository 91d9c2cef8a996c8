//! Which technique a budget buys: the measured front of one scene on one device, and the choice from it.

use crate::technique::{Scale, Work};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Of the file that a front is kept in.
pub const VERSION: u32 = 2;

/// What was measured on one scene, on one device, at one size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Front {
    pub version: u32,
    pub candidates: Vec<Candidate>,
}

/// A technique with so much work a frame, and what it gave.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    pub technique: String,
    /// Its samples per pixel go in rounds.
    pub rounds: bool,
    pub work: Work,
    /// Nanoseconds per pixel: a frame's time grows linearly with its pixels.
    pub ns_per_pixel: f64,
    /// Mean LDR-FLIP.
    pub flip: f64,
}

/// What the user asks for; at least one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wish {
    /// Milliseconds of a frame.
    pub budget_ms: Option<f64>,
    pub target_flip: Option<f64>,
}

/// A technique, its work, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    pub technique: String,
    /// Of a frame; may lie between what was measured, or beyond.
    pub work: Work,
    /// How its work grows with time.
    pub scale: Scale,
    pub predicted_ms: f64,
    pub predicted_flip: f64,
    pub reason: String,
}

impl Front {
    /// The best for a picture of so many pixels: least FLIP within the budget; of those that reach the target, the cheapest. `None`
    /// where nothing was measured.
    pub fn choose(&self, wish: &Wish, pixels: u64) -> Option<Choice> {
        let pixels = pixels as f64;
        let budget = wish.budget_ms.unwrap_or(f64::INFINITY);
        let choices: Vec<Choice> = self.families().iter().flat_map(|family| family.choices(wish.budget_ms, pixels)).collect();
        let affordable: Vec<&Choice> = choices.iter().filter(|choice| choice.predicted_ms <= budget * (1.0 + 1e-9)).collect();
        let cheapest =
            |choices: &mut dyn Iterator<Item = &Choice>| choices.min_by(|a, b| a.predicted_ms.total_cmp(&b.predicted_ms)).cloned();
        let best = affordable.iter().min_by(|a, b| a.predicted_flip.total_cmp(&b.predicted_flip)).map(|choice| (*choice).clone());
        let reaching = |target: f64| cheapest(&mut affordable.iter().copied().filter(|choice| choice.predicted_flip <= target));
        let (choice, reason) = match (wish.target_flip.map(reaching), best) {
            (Some(Some(choice)), _) => (choice, "the cheapest that reaches the target".to_owned()),
            (Some(None), Some(best)) => (best, format!("nothing measured reaches the target{}; this comes nearest", within(wish))),
            (None, Some(best)) => (best, "the least error within the budget".to_owned()),
            (_, None) => (cheapest(&mut choices.iter())?, "nothing keeps to the budget; this is the cheapest".to_owned()),
        };
        Some(Choice { reason, ..choice })
    }

    fn families(&self) -> Vec<Family<'_>> {
        let mut families: BTreeMap<&str, Vec<&Candidate>> = BTreeMap::new();
        for candidate in &self.candidates {
            families.entry(&candidate.technique).or_default().push(candidate);
        }
        families.into_values().filter_map(Family::of).collect()
    }
}

fn within(wish: &Wish) -> String {
    wish.budget_ms.map(|ms| format!(" within {} ms", ms as f32)).unwrap_or_default()
}

/// All that was measured of one technique.
struct Family<'a> {
    all: Vec<&'a Candidate>,
    /// Of the fewest shadow rays, by samples; at least one.
    by_samples: Vec<&'a Candidate>,
    /// Of the fewest samples, but more shadow rays.
    more_rays: Option<&'a Candidate>,
}

impl<'a> Family<'a> {
    /// `None` of nothing.
    fn of(mut all: Vec<&'a Candidate>) -> Option<Self> {
        all.sort_by(|a, b| a.work.samples.total_cmp(&b.work.samples).then(a.work.first_shadow_rays.cmp(&b.work.first_shadow_rays)));
        let least = all.first()?.work;
        let by_samples = all.iter().copied().filter(|candidate| candidate.work.first_shadow_rays == least.first_shadow_rays).collect();
        let more_rays =
            |candidate: &&Candidate| candidate.work.samples == least.samples && candidate.work.first_shadow_rays > least.first_shadow_rays;
        Some(Self { more_rays: all.iter().copied().find(more_rays), by_samples, all })
    }

    fn choices(&self, budget_ms: Option<f64>, pixels: f64) -> Vec<Choice> {
        let measured = self.all.iter().map(|candidate| (candidate.work, candidate.ns_per_pixel, candidate.flip));
        let filling = budget_ms.and_then(|ms| self.filling(ms, pixels));
        let scale = self.scale();
        let choice = |(work, ns_per_pixel, predicted_flip): (Work, f64, f64)| Choice {
            technique: self.by_samples[0].technique.clone(),
            work,
            scale,
            predicted_ms: ns_per_pixel * pixels * 1e-6,
            predicted_flip,
            reason: String::new(),
        };
        measured.chain(filling).map(choice).collect()
    }

    /// The work that uses the whole budget, its nanoseconds per pixel, its FLIP; `None` where the budget is too small.
    fn filling(&self, budget_ms: f64, pixels: f64) -> Option<(Work, f64, f64)> {
        let least = self.by_samples[0];
        let effort = budget_ms / (least.ns_per_pixel * pixels * 1e-6);
        let work = self.scale().work(effort);
        let (ns_per_pixel, flip) = (self.scale().effort(&work) * least.ns_per_pixel, self.flip(&work));
        (effort >= 1.0 && work.samples.is_finite() && flip.is_finite()).then_some((work, ns_per_pixel, flip))
    }

    /// Time is linear in samples, and in the shadow rays of each.
    fn scale(&self) -> Scale {
        let (least, last) = (self.by_samples[0], self.by_samples[self.by_samples.len() - 1]);
        let more = |candidate: &Candidate| candidate.ns_per_pixel / least.ns_per_pixel - 1.0;
        let of_ray = |candidate: &Candidate| {
            more(candidate) / (least.work.samples * f64::from(candidate.work.first_shadow_rays - least.work.first_shadow_rays))
        };
        let of_sample = more(last) / (last.work.samples - least.work.samples);
        Scale {
            rounds: least.rounds,
            first_shadow_rays: least.work.first_shadow_rays,
            effort_of_sample: if of_sample > 0.0 { of_sample } else { 1.0 },
            effort_of_ray: self.more_rays.map_or(0.0, of_ray),
            most_samples: if of_sample > 0.0 { f64::INFINITY } else { least.work.samples },
        }
    }

    /// Linear in logarithms: between two numbers of samples that were measured, or beyond the last; and over shadow rays.
    fn flip(&self, work: &Work) -> f64 {
        let family = &self.by_samples;
        let above = family.iter().position(|candidate| candidate.work.samples > work.samples).unwrap_or(family.len() - 1).max(1);
        let a = family[above - 1];
        let of_samples =
            family.get(above).map_or(1.0, |b| fall(a.flip, b.flip, b.work.samples / a.work.samples, work.samples / a.work.samples));
        let rays = |candidate: &Candidate, of: u32| f64::from(of) / f64::from(candidate.work.first_shadow_rays);
        let least = family[0];
        let of_rays = self
            .more_rays
            .map_or(1.0, |b| fall(least.flip, b.flip, rays(least, b.work.first_shadow_rays), rays(least, work.first_shadow_rays)));
        a.flip * of_samples * of_rays
    }
}

/// What `by` times as much of something leaves of an error, where `known` times as much has brought it from `a` to `b`; never more than 1.
fn fall(a: f64, b: f64, known: f64, by: f64) -> f64 {
    by.powf(((b / a).ln() / known.ln()).min(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(technique: &str, samples: f64, first_shadow_rays: u32, ns_per_pixel: f64, flip: f64) -> Candidate {
        let work = Work { samples, first_shadow_rays };
        Candidate { technique: technique.to_owned(), rounds: technique == "filter", work, ns_per_pixel, flip }
    }

    /// Of a picture of 10^6 pixels, nanoseconds per pixel are milliseconds.
    const PIXELS: u64 = 1_000_000;

    fn front() -> Front {
        let candidates = vec![
            candidate("reference", 1.0, 1, 10.0, 0.4),
            candidate("reference", 4.0, 1, 40.0, 0.2),
            candidate("filter", 1.0, 1, 12.0, 0.15),
        ];
        Front { version: VERSION, candidates }
    }

    fn choose(budget_ms: Option<f64>, target_flip: Option<f64>) -> Choice {
        front().choose(&Wish { budget_ms, target_flip }, PIXELS).unwrap()
    }

    #[test]
    fn a_budget_buys_the_least_error() {
        assert_eq!(choose(Some(15.0), None).technique, "filter");
        assert_eq!(choose(Some(11.0), None).technique, "reference");
    }

    #[test]
    fn samples_fill_the_budget_also_beyond_what_was_measured() {
        let choice = choose(Some(160.0), None);
        assert_eq!((choice.technique.as_str(), choice.work.samples), ("reference", 16.0));
        assert!((choice.predicted_flip - 0.1).abs() < 1e-9 && (choice.predicted_ms - 160.0).abs() < 1e-9);
        let choice = front_without_filter().choose(&Wish { budget_ms: Some(25.0), target_flip: None }, PIXELS).unwrap();
        assert_eq!(choice.work.samples, 2.5);
    }

    fn front_without_filter() -> Front {
        Front { candidates: front().candidates[..2].to_vec(), ..front() }
    }

    /// A filter of which 4 rounds and 11 shadow rays were measured, too.
    fn front_of_rounds() -> Front {
        let more = [candidate("filter", 4.0, 1, 42.0, 0.075), candidate("filter", 1.0, 11, 18.0, 0.12)];
        Front { candidates: front().candidates.into_iter().chain(more).collect(), ..front() }
    }

    #[test]
    fn rounds_of_a_filter_are_whole_and_shadow_rays_use_what_is_left() {
        let choose = |ms| front_of_rounds().choose(&Wish { budget_ms: Some(ms), target_flip: None }, PIXELS).unwrap();
        for ms in [12.0, 14.0, 20.0, 22.0, 27.0, 35.0, 60.0, 100.0] {
            let choice = choose(ms);
            // Another round takes 10 ms, another shadow ray 0.6 ms.
            let rounds = 1.0 + ((ms - 12.0) / 10.0).floor();
            assert_eq!((choice.technique.as_str(), choice.work.samples), ("filter", rounds), "{ms}");
            assert!(choice.predicted_ms <= ms + 1e-6 && choice.predicted_ms > ms - 0.6 * rounds, "{ms}: {}", choice.predicted_ms);
        }
        let (one, more, two) = (choose(12.0), choose(20.0), choose(22.0));
        assert!(one.predicted_flip > more.predicted_flip && more.predicted_flip > two.predicted_flip);
        assert!((two.predicted_flip - 0.15 / 2f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn a_target_is_reached_as_cheaply_as_possible_or_the_choice_says_that_it_is_not() {
        assert_eq!(choose(None, Some(0.2)).technique, "filter");
        assert_eq!(choose(None, Some(0.5)).work.samples, 1.0);
        let missed = choose(Some(15.0), Some(0.01));
        assert!(missed.technique == "filter" && missed.reason.contains("nothing measured reaches the target within 15 ms"));
    }

    #[test]
    fn a_budget_that_nothing_keeps_to_gives_the_cheapest_and_says_so() {
        let choice = choose(Some(1.0), None);
        assert!(choice.technique == "reference" && choice.work.samples == 1.0 && choice.reason.contains("nothing keeps to the budget"));
    }
}
