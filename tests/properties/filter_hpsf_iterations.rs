//! hpsf.iterations: what is filtered, filtered again, with nothing lost, made or remembered.

use crate::common;
use crate::common::render::{builtin, output, render_frames, set, settings};
use pathspace::display::Image;
use pathspace::gpu::Gpu;
use pathspace::metrics::statistics::BatchMeans;
use pathspace::technique::{Renderer, Settings};

fn with(values: &[(&str, &str)]) -> Settings {
    let mut settings = settings(64, 36);
    set(&mut settings, values);
    settings
}

fn rendered(gpu: &Gpu, values: &[(&str, &str)], frames: u32) -> Renderer {
    render_frames(gpu, &builtin("cornell"), &with(values), "hpsf", frames)
}

fn bits(image: &Image) -> Vec<[u32; 3]> {
    image.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

/// Over all pixels and channels.
fn sum(renderer: &Renderer, name: &str) -> f64 {
    output(renderer, name).pixels.iter().flatten().map(|&value| f64::from(value)).sum()
}

/// Each pixel reads the cell that its own mean went to, whatever the jitter: each filtering keeps the sum over pixels. Where the table is too
/// small for all keys, pixels without a cell keep what they had.
#[test]
fn each_filtering_keeps_the_sum_of_all_light() {
    let gpu = common::gpu();
    let own = [("hpsf.lookups", "0"), ("hpsf.levels", "1"), ("hpsf.time", "frame"), ("hpsf.largest", "256"), ("hpsf.width", "4")];
    let switches: [&[(&str, &str)]; 5] = [
        &[("hpsf.sums", "float")],
        &[("hpsf.cells", "0.001")],
        &[("hpsf.insertion", "ordered"), ("hpsf.jitter_by", "sampler")],
        &[("hpsf.table", "swapped"), ("hpsf.keys", "exact")],
        &[("hpsf.eviction", "priority"), ("hpsf.table", "swapped")],
    ];
    for switch in switches {
        let renderer = rendered(&gpu, &[&own[..], switch, &[("hpsf.iterations", "3")]].concat(), 2);
        let (filtered, raw) = (sum(&renderer, "diffuse"), sum(&renderer, "diffuse_direct") + sum(&renderer, "diffuse_indirect"));
        assert!((filtered / raw - 1.0).abs() < 4e-6, "{switch:?}: {filtered} {raw}");
        assert_ne!(bits(&output(&renderer, "diffuse")), bits(&output(&renderer, "diffuse_before")), "{switch:?}");
    }
}

/// After 16 frames, the first filtering's means, which the second one takes, and its samples are what they are without it, to the bit. Nor does
/// the second one remember: each pixel reads the cell that its own mean went to, and the sum of these stays what it is.
#[test]
fn filtering_again_has_no_history_and_enters_none() {
    let gpu = common::gpu();
    for (table, time) in [("persistent", "integrate"), ("swapped", "integrate"), ("persistent", "average")] {
        let history = [("hpsf.table", table), ("hpsf.time", time), ("hpsf.cells", "8"), ("hpsf.probes", "32")];
        let own = [("hpsf.lookups", "0"), ("hpsf.levels", "1"), ("hpsf.largest", "256")];
        let [once, twice] = ["1", "2"].map(|n| rendered(&gpu, &[&history[..], &own, &[("hpsf.iterations", n)]].concat(), 16));
        assert_eq!(bits(&output(&once, "diffuse")), bits(&output(&twice, "diffuse_before")), "{table}, {time}");
        assert_eq!(bits(&output(&once, "hpsf_samples")), bits(&output(&twice, "hpsf_samples")), "{table}, {time}");
        let [before, after] = ["diffuse_before", "diffuse"].map(|name| sum(&twice, name));
        assert!((after / before - 1.0).abs() < 4e-6, "{table}, {time}: {before} {after}");
    }
}

#[test]
fn where_it_is_filtered_once_there_is_no_further_pass_or_image() {
    let gpu = common::gpu();
    let [once, twice] = ["1", "2"].map(|n| rendered(&gpu, &[("hpsf.iterations", n)], 1));
    assert!(once.output("diffuse_before").unwrap().is_none() && twice.output("diffuse_before").unwrap().is_some());
}

/// Of the light behind filter vertices: the variance over seeds, the mean over pixels and channels.
fn variance(gpu: &Gpu, values: &[(&str, &str)]) -> f64 {
    const SEEDS: u64 = 24;
    let mut renderer = rendered(gpu, values, 0);
    let mut pixels = vec![[BatchMeans::default(); 3]; 64 * 36];
    for seed in 0..SEEDS {
        renderer.restart(seed as u32, 0).unwrap();
        renderer.render_frame().unwrap();
        renderer.finish().unwrap();
        for (pixel, value) in pixels.iter_mut().zip(output(&renderer, "diffuse").pixels) {
            (0..3).for_each(|c| pixel[c].add(f64::from(value[c])));
        }
    }
    pixels.iter().flatten().map(BatchMeans::variance_of_mean).sum()
}

/// By two and by three times here; chance moves the ratios by some hundredths. Without jitter, means that go through the same cells again stay
/// what they are.
#[test]
fn each_filtering_leaves_less_variance_where_there_is_jitter() {
    let gpu = common::gpu();
    let of = |jitter, iterations| {
        variance(&gpu, &[("hpsf.width", "4"), ("hpsf.levels", "1"), ("hpsf.jitter", jitter), ("hpsf.iterations", iterations)])
    };
    let [once, twice, thrice] = ["1", "2", "3"].map(|iterations| of("0.6", iterations));
    assert!(twice < 0.7 * once && thrice < 0.85 * twice, "{once} {twice} {thrice}");
    let [once, twice] = ["1", "2"].map(|iterations| of("0", iterations));
    assert!((twice / once - 1.0).abs() < 1e-3, "{once} {twice}");
}
