//! hpsf's table in figures: how full it is, how far keys are from home, how many find no slot.

use crate::common;
use crate::common::render::{builtin, output, render_frames, set, settings};
use pathspace::technique::{Renderer, Settings};

/// hpsf.probes by default.
const PROBES: usize = 8;

fn with(values: &[(&str, &str)]) -> Settings {
    let mut settings = settings(96, 54);
    settings.outputs = ["hpsf_probed", "hpsf_failed", "hpsf_collided", "hpsf_slots", "hpsf_taken"].map(str::to_owned).to_vec();
    set(&mut settings, values);
    settings
}

fn values(renderer: &Renderer, name: &str) -> Vec<usize> {
    output(renderer, name).pixels.iter().map(|pixel| pixel[0] as usize).collect()
}

struct Statistics {
    /// Taken slots over all.
    occupancy: f64,
    /// Insertions at which no slot was found, over all.
    failures: f64,
    /// Insertions into another key's slot.
    collisions: f64,
    /// Samples whose key was looked for in so many slots; the last: in vain.
    histogram: [usize; PROBES + 2],
}

fn statistics(settings: &Settings, frames: u32, slots: usize, levels: f64) -> Statistics {
    let renderer = render_frames(&common::gpu(), &builtin("cornell"), settings, "hpsf", frames);
    let mut histogram = [0; PROBES + 2];
    values(&renderer, "hpsf_probed").into_iter().for_each(|probed| histogram[probed] += 1);
    let sum = |name| values(&renderer, name).iter().sum::<usize>() as f64;
    let vertices = histogram[1..].iter().sum::<usize>() as f64;
    assert_eq!(sum("hpsf_slots"), slots as f64);
    Statistics {
        occupancy: sum("hpsf_taken") / slots as f64,
        collisions: sum("hpsf_collided"),
        failures: sum("hpsf_failed") / (vertices * levels),
        histogram,
    }
}

#[test]
fn at_the_default_size_hardly_an_insertion_fails() {
    let found = statistics(&with(&[]), 8, 96 * 54, 2.0);
    assert!((0.005..0.5).contains(&found.occupancy), "occupancy {}", found.occupancy);
    assert_eq!(found.collisions, 0.0);
    assert!(found.failures < 0.001, "failures {}", found.failures);
    let at_home = found.histogram[1] as f64 / found.histogram[1..].iter().sum::<usize>() as f64;
    assert!(at_home > 0.8 && found.histogram[PROBES + 1] == 0, "{:?}", found.histogram);
}

/// 64 slots for hundreds of cells: all are taken, and most samples find none.
#[test]
fn a_table_that_is_too_small_says_so() {
    let found = statistics(&with(&[("hpsf.cells", "0.001"), ("hpsf.width", "4"), ("hpsf.levels", "1")]), 1, 64, 1.0);
    assert_eq!(found.occupancy, 1.0);
    let vertices: usize = found.histogram[1..].iter().sum();
    assert_eq!(found.failures, found.histogram[PROBES + 1] as f64 / vertices as f64);
    assert!(found.failures > 0.5, "{:?}", found.histogram);
}

/// A table half full, in whatever order its keys come: many samples are not at home, since only one of two keys with one home can be.
#[test]
fn in_a_table_that_is_half_full_samples_go_far() {
    let found = statistics(&with(&[("hpsf.cells", "0.4"), ("hpsf.width", "4"), ("hpsf.levels", "1")]), 1, 2074, 1.0);
    assert!((0.4..0.6).contains(&found.occupancy), "occupancy {}", found.occupancy);
    assert!(found.failures < 0.05, "failures {}", found.failures);
    let away: usize = found.histogram[2..=PROBES].iter().sum();
    assert!(away > found.histogram[1] / 10 && found.histogram[4..=PROBES].iter().sum::<usize>() > 0, "{:?}", found.histogram);
}
