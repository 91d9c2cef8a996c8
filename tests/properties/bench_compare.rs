//! bench-compare on runs that never took place: what it finds, and how often it is wrong.
//!
//! A run: 24 points of 2 techniques; 16 frames as the runner takes, log-normal with 3 to 8 % of noise that correlates by 0.4 from frame to frame; 8 seeds with
//! 0.3 % of noise in energy, 1 % in FLIP, 10 % in relMSE; references that know their radiance to 0.1 %.

use crate::records::{figure, normal, record};
use pathspace::bench::compare::{Comparison, FALSE_ALARMS, Verdict, subjects};
use pathspace::bench::record::{Figure, Record};
use rand::SeedableRng;
use rand_pcg::Pcg32;
use rayon::prelude::*;

const RUNS: u64 = 200;
const POINTS: usize = 24;

/// What the second run is changed by, on the points that it picks.
#[derive(Clone, Copy)]
struct Injected {
    slowdown: f64,
    energy_lost: f64,
    /// By the integrator, and so by the reference, which `energy` is relative to.
    reference_lost: f64,
    at: fn(usize) -> bool,
    /// Of both runs.
    frames: usize,
}

const NOTHING: Injected = Injected { slowdown: 0.0, energy_lost: 0.0, reference_lost: 0.0, at: |_| false, frames: 16 };

fn frames(count: usize, median: f64, noise: f64, rng: &mut Pcg32) -> Vec<f64> {
    const CORRELATION: f64 = 0.4;
    let mut state = normal(rng);
    let mut frame = || {
        state = CORRELATION * state + (1.0 - CORRELATION * CORRELATION).sqrt() * normal(rng);
        median * (noise * state).exp()
    };
    (0..count).map(|_| frame()).collect()
}

/// Known by its standard error instead of by samples.
fn reference_radiance(mean: f64, rng: &mut Pcg32) -> Figure {
    let error = 0.001;
    let value = mean + error * normal(rng);
    Figure { value, low: value - 1.96 * error, high: value + 1.96 * error, unit: String::new(), samples: vec![] }
}

fn run(injected: Injected, rng: &mut Pcg32) -> Vec<Record> {
    let seeds = |mean: f64, noise: f64, rng: &mut Pcg32| figure((0..8).map(|_| mean * (noise * normal(rng)).exp()).collect());
    let mut point = |i: usize| {
        let here = if (injected.at)(i) { injected } else { NOTHING };
        let noise = 0.03 + 0.05 * (i as f64 / (POINTS - 1) as f64);
        let mut record = record(&format!("point-{i}"), ["reference", "filtered"][i % 2]);
        let figures = [
            ("frame_ms", figure(frames(injected.frames, (1.0 + i as f64) * (1.0 + here.slowdown), noise, rng))),
            ("energy", seeds(1.0 - here.energy_lost, 0.003, rng)),
            ("reference_radiance", reference_radiance(1.0 - here.reference_lost, rng)),
            ("flip", seeds(0.1, 0.01, rng)),
            ("relmse", seeds(0.01, 0.1, rng)),
        ];
        record.figures.extend(figures.map(|(key, figure)| (key.to_owned(), figure)));
        record
    };
    (0..POINTS).map(&mut point).collect()
}

/// [`RUNS`] pairs of runs.
fn comparisons(injected: Injected) -> Vec<Comparison> {
    let compare = |seed| {
        let mut rng = Pcg32::seed_from_u64(seed);
        let (a, b) = (run(Injected { frames: injected.frames, ..NOTHING }, &mut rng), run(injected, &mut rng));
        Comparison::new(&a, &b, &subjects(&[], &[]))
    };
    (0..RUNS).into_par_iter().map(compare).collect()
}

/// Of the pairs of which `wanted` holds.
fn share(comparisons: &[Comparison], wanted: impl Fn(&Comparison) -> bool) -> f64 {
    comparisons.iter().filter(|comparison| wanted(comparison)).count() as f64 / comparisons.len() as f64
}

fn summary_regressed(comparison: &Comparison, key: &str) -> bool {
    comparison.summaries.iter().any(|summary| summary.subject.kind.key == key && summary.verdict == Verdict::Regressed)
}

fn regressed_points(comparison: &Comparison, key: &str) -> usize {
    comparison.points.iter().filter(|point| point.subject.kind.key == key && point.verdict == Verdict::Regressed).count()
}

/// Any significant change counts here, not only one that is beyond its limit: the limits would hide a significance that is too lax. At 5 %
/// of 200, more than 20 alarms come by chance once in 1000 times.
#[test]
fn a_rerun_raises_false_alarms_no_more_often_than_stated() {
    let changed = |verdict| matches!(verdict, Verdict::Regressed | Verdict::Worse | Verdict::Better);
    let comparisons = comparisons(NOTHING);
    let significant = share(&comparisons, |comparison| {
        let points = comparison.points.iter().map(|point| point.verdict);
        points.chain(comparison.summaries.iter().map(|summary| summary.verdict)).any(changed)
    });
    let regressed = share(&comparisons, Comparison::regressed);
    println!("no change: significant in {significant}, regressed in {regressed}");
    assert!(significant <= 20.0 / RUNS as f64, "{significant}");
    assert!(regressed <= FALSE_ALARMS, "{regressed}");
}

#[test]
fn a_slowdown_of_10_percent_everywhere_is_found() {
    let injected = Injected { slowdown: 0.1, at: |_| true, ..NOTHING };
    let power = share(&comparisons(injected), |comparison| summary_regressed(comparison, "frame_ms"));
    println!("10 % slower everywhere: found in {power}");
    assert!(power >= 0.99, "{power}");
}

#[test]
fn a_slowdown_of_10_percent_of_one_technique_is_found() {
    let injected = Injected { slowdown: 0.1, at: |i| i % 2 == 1, ..NOTHING };
    let power = share(&comparisons(injected), |comparison| summary_regressed(comparison, "frame_ms"));
    println!("10 % slower with one technique: found in {power}");
    assert!(power >= 0.99, "{power}");
}

/// The quietest point, of 3 % noise; it takes more frames than a summary does.
#[test]
fn a_slowdown_of_10_percent_at_one_point_is_found() {
    let injected = Injected { slowdown: 0.1, at: |i| i == 0, frames: 64, ..NOTHING };
    let power = share(&comparisons(injected), |comparison| regressed_points(comparison, "frame_ms") == 1);
    println!("10 % slower at one point: found in {power}");
    assert!(power >= 0.8, "{power}");
}

#[test]
fn a_percent_of_energy_lost_is_found() {
    let injected = Injected { energy_lost: 0.01, at: |i| i % 2 == 1, ..NOTHING };
    let comparisons = comparisons(injected);
    let by_summary = share(&comparisons, |comparison| summary_regressed(comparison, "energy"));
    let by_point = share(&comparisons, |comparison| regressed_points(comparison, "energy") > 0);
    println!("1 % of energy lost with one technique: found by summary in {by_summary}, at a point in {by_point}");
    assert!(by_summary >= 0.99, "{by_summary}");
}

/// The reference is rendered anew by the same code, so `energy` stays at 1.
#[test]
fn a_percent_of_energy_lost_in_the_integrator_is_found() {
    let injected = Injected { reference_lost: 0.01, at: |_| true, ..NOTHING };
    let comparisons = comparisons(injected);
    let power = share(&comparisons, |comparison| regressed_points(comparison, "reference_radiance") > 0);
    println!("1 % of energy lost by the integrator: found in {power}");
    assert!(power >= 0.99, "{power}");
    assert_eq!(share(&comparisons, |comparison| summary_regressed(comparison, "energy")), 0.0);
}
