//! Which technique a budget buys: the measured front of one scene on one device, and the choice from it.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Of the file that a front is kept in.
pub const VERSION: u32 = 1;

/// What was measured on one scene, on one device, at one size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Front {
    pub version: u32,
    pub candidates: Vec<Candidate>,
}

/// A technique with its parameters, and what it gave.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    pub technique: String,
    pub settings: BTreeMap<String, String>,
    /// Per pixel and frame.
    pub spp: u32,
    /// Most that the technique takes.
    pub most_spp: u32,
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

/// A candidate, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    pub candidate: Candidate,
    /// Per pixel and frame; may be a fraction, and between two that were measured.
    pub samples: f64,
    pub predicted_ms: f64,
    pub predicted_flip: f64,
    pub reason: String,
}

impl Candidate {
    fn ms(&self, pixels: f64) -> f64 {
        self.ns_per_pixel * pixels * 1e-6
    }
}

impl Front {
    /// The best for a picture of so many pixels: least FLIP within the budget; of those that reach the target, the cheapest. `None`
    /// where nothing was measured.
    pub fn choose(&self, wish: &Wish, pixels: u64) -> Option<Choice> {
        let pixels = pixels as f64;
        let budget = wish.budget_ms.unwrap_or(f64::INFINITY);
        let mut choices: Vec<Choice> = self.candidates.iter().map(|candidate| as_measured(candidate, pixels)).collect();
        choices.extend(wish.budget_ms.into_iter().flat_map(|ms| self.between(ms, pixels)));
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

    /// Sample counts that use the whole budget: between two that were measured, or beyond the last, time is linear in samples, and
    /// FLIP linear in the logarithms of both.
    fn between(&self, budget_ms: f64, pixels: f64) -> Vec<Choice> {
        let mut families: BTreeMap<(&str, &BTreeMap<String, String>), Vec<&Candidate>> = BTreeMap::new();
        for candidate in &self.candidates {
            families.entry((&candidate.technique, &candidate.settings)).or_default().push(candidate);
        }
        families.into_values().filter_map(|family| interpolated(family, budget_ms, pixels)).collect()
    }
}

fn within(wish: &Wish) -> String {
    wish.budget_ms.map(|ms| format!(" within {} ms", ms as f32)).unwrap_or_default()
}

fn as_measured(candidate: &Candidate, pixels: f64) -> Choice {
    Choice {
        samples: f64::from(candidate.spp),
        predicted_ms: candidate.ms(pixels),
        predicted_flip: candidate.flip,
        reason: String::new(),
        candidate: candidate.clone(),
    }
}

fn interpolated(mut family: Vec<&Candidate>, budget_ms: f64, pixels: f64) -> Option<Choice> {
    family.sort_by_key(|candidate| candidate.spp);
    let above = family.iter().position(|candidate| candidate.ms(pixels) > budget_ms).unwrap_or(family.len() - 1).max(1);
    let (a, b) = (family.get(above - 1)?, family.get(above)?);
    let per_sample = (b.ms(pixels) - a.ms(pixels)) / f64::from(b.spp - a.spp);
    let samples = f64::from(a.spp) + (budget_ms - a.ms(pixels)) / per_sample;
    let samples = samples.min(f64::from(a.most_spp));
    if per_sample <= 0.0 || samples.is_nan() || samples < 1.0 || samples.is_infinite() {
        return None;
    }
    let slope = (b.flip / a.flip).ln() / (f64::from(b.spp) / f64::from(a.spp)).ln();
    let flip = a.flip * (samples / f64::from(a.spp)).powf(slope.min(0.0));
    let ms = a.ms(pixels) + per_sample * (samples - f64::from(a.spp));
    let choice = Choice { candidate: (*a).clone(), samples, predicted_ms: ms, predicted_flip: flip, reason: String::new() };
    choice.predicted_flip.is_finite().then_some(choice)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(technique: &str, spp: u32, most_spp: u32, ns_per_pixel: f64, flip: f64) -> Candidate {
        Candidate { technique: technique.to_owned(), settings: BTreeMap::new(), spp, most_spp, ns_per_pixel, flip }
    }

    /// Of a picture of 10^6 pixels, nanoseconds per pixel are milliseconds.
    const PIXELS: u64 = 1_000_000;

    fn front() -> Front {
        let candidates = vec![
            candidate("reference", 1, 1000, 10.0, 0.4),
            candidate("reference", 4, 1000, 40.0, 0.2),
            candidate("filter", 1, 1, 12.0, 0.15),
        ];
        Front { version: VERSION, candidates }
    }

    fn choose(budget_ms: Option<f64>, target_flip: Option<f64>) -> Choice {
        front().choose(&Wish { budget_ms, target_flip }, PIXELS).unwrap()
    }

    #[test]
    fn a_budget_buys_the_least_error() {
        assert_eq!(choose(Some(15.0), None).candidate.technique, "filter");
        assert_eq!(choose(Some(11.0), None).candidate.technique, "reference");
    }

    #[test]
    fn samples_fill_the_budget_also_beyond_what_was_measured() {
        let choice = choose(Some(160.0), None);
        assert_eq!((choice.candidate.technique.as_str(), choice.samples), ("reference", 16.0));
        assert!((choice.predicted_flip - 0.1).abs() < 1e-9 && (choice.predicted_ms - 160.0).abs() < 1e-9);
        let choice = front_without_filter().choose(&Wish { budget_ms: Some(25.0), target_flip: None }, PIXELS).unwrap();
        assert_eq!(choice.samples, 2.5);
    }

    fn front_without_filter() -> Front {
        Front { candidates: front().candidates[..2].to_vec(), ..front() }
    }

    #[test]
    fn a_target_is_reached_as_cheaply_as_possible_or_the_choice_says_that_it_is_not() {
        assert_eq!(choose(None, Some(0.2)).candidate.technique, "filter");
        assert_eq!(choose(None, Some(0.5)).samples, 1.0);
        let missed = choose(Some(15.0), Some(0.01));
        assert!(missed.candidate.technique == "filter" && missed.reason.contains("nothing measured reaches the target within 15 ms"));
    }

    #[test]
    fn a_budget_that_nothing_keeps_to_gives_the_cheapest_and_says_so() {
        let choice = choose(Some(1.0), None);
        assert!(
            choice.candidate.technique == "reference" && choice.samples == 1.0 && choice.reason.contains("nothing keeps to the budget")
        );
    }
}
