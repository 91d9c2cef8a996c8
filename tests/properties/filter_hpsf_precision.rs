//! hpsf's cells in half precision: half the bytes, no mean that stalls or drifts.

use crate::common::floor::{floor, from_above};
use crate::common::render::{builtin, filtered, output, render_frames, set, settings};
use crate::common::{self, KernelOptions, run_kernel_with};
use pathspace::display::Image;
use pathspace::gpu::Gpu;
use pathspace::metrics::{Pair, relmse};
use pathspace::scene::Environment;
use pathspace::technique::{Parameters, Renderer};
use std::collections::BTreeMap;

const PRECISIONS: [&str; 2] = ["fp32", "fp16"];
/// Between halves, relative to them at most.
const HALF_ULP: f32 = 1.0 / 1024.0;

/// What a kernel is compiled with whose cells are in half precision.
fn narrow() -> KernelOptions<'static> {
    let mut parameters = Parameters::default();
    parameters.set("frame.precision", "fp16").unwrap();
    KernelOptions {
        constants: parameters.constants(),
        defines: vec![("CELL_WORDS".to_owned(), "uvec2".to_owned())],
        ..KernelOptions::default()
    }
}

const TWICE: &str = r#"
#include "filter/hpsf/stored_cell.glsl"
struct In { vec3 mean; uint count; uint age; uint limit; };
struct Out { vec3 mean; uint count; uint age; uint same; uint lowered; };
void kernel(uint i) {
    uvec2 words = pack_cell(Cell(inputs[i].mean, inputs[i].count, inputs[i].age));
    Cell once = unpack_cell(words);
    bool same = pack_cell(once) == words;
    words.y = min(words.y, with_count(words.y, inputs[i].limit));
    Cell lowered = unpack_cell(words);
    same = same && lowered.mean == once.mean && lowered.age == once.age;
    outputs[i] = Out(once.mean, once.count, once.age, same ? 1u : 0u, lowered.count);
}
"#;

#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Stored {
    mean: [f32; 3],
    count: u32,
    age: u32,
    same: u32,
    lowered: u32,
}

/// Of all magnitudes; what has been stored once is stored exactly from then on, and a lower count changes nothing else.
#[test]
fn a_stored_cell_is_as_near_as_halves_are() {
    const LIMIT: u32 = 1000;
    let magnitude = |i: i32| 2.0f32.powf(0.37 * i as f32 - 30.0);
    let cell = |i: i32| {
        let count = (magnitude(i % 64 + 80) as u32).min(0x00ff_ffff);
        let mean = [magnitude(i), magnitude(i + 5), if i % 2 == 0 { 0.0 } else { magnitude(149 - i) }];
        (mean.map(f32::to_bits), count, i as u32 % 256, LIMIT)
    };
    let cells: Vec<_> = (0..150).map(cell).collect();
    let inputs: Vec<[u32; 6]> = cells.iter().map(|&([r, g, b], count, age, limit)| [r, g, b, count, age, limit]).collect();
    let found: Vec<Stored> = run_kernel_with(&common::gpu(), TWICE, &inputs, &narrow());
    for ((mean, count, age, _), found) in cells.into_iter().zip(found) {
        for (value, stored) in mean.map(f32::from_bits).into_iter().zip(found.mean) {
            let exact = value.min(65504.0);
            assert!((stored - exact).abs() <= (exact * HALF_ULP).max(6e-8), "{value}: {stored}");
        }
        assert!(found.count.abs_diff(count) <= count / 64 && (count > 128 || found.count == count), "{count}: {}", found.count);
        assert_eq!((found.age, found.same), (age, 1), "{mean:?}");
        assert!(found.lowered.abs_diff(count.min(LIMIT)) <= count.min(LIMIT) / 64, "{count}: {}", found.lowered);
    }
}

/// As filter/hpsf/merge.comp does, frames of 100 samples each: the first differs by `first`, all by up to `noise` either way.
const INTEGRATES: &str = r#"
#include "filter/hpsf/stored_cell.glsl"
struct In { float first; float noise; };
struct Out { float stored; float nearest; float exact; float count; };
void kernel(uint i) {
    Cell cell = EMPTY_CELL;
    float nearest = 0.0;
    float exact = 0.0;
    for (uint n = 0u; n < 4096u; n++) {
        uvec3 bits = pcg3d(uvec3(i, n, 0u));
        float now = 0.7 + inputs[i].noise * (2.0 * unit_float(bits.x) - 1.0) + (n == 0u ? inputs[i].first : 0.0);
        float weight = 1.0 / float(n + 1u);
        float known = 100.0 / float(cell.count + 100u);
        // The other channels are anything: the frame's number, which else makes cells of like content round apart, is the same here.
        cell.mean += known * (vec3(now, unit_float(bits.yz)) - cell.mean);
        cell.count += 100u;
        cell = unpack_cell(pack_cell(cell));
        nearest = from_short(short_rounding_at_random(nearest + weight * (now - nearest), HALF, 0.5), HALF);
        exact += weight * (now - exact);
    }
    outputs[i] = Out(cell.mean.x, nearest, exact, float(cell.count));
}
"#;

/// After 4096 frames, over 1024 cells: the errors' variance is u s / 2 (stored_cell.glsl), s the noise's standard deviation and u = 2^-11, and a
/// little more for counts that are rounded, too; their mean is within five standard errors of none. Rounded to the nearest, a mean that began
/// too bright stays so, farther from it than that.
#[test]
fn means_of_thousands_of_frames_neither_stall_nor_drift() {
    const CELLS: usize = 1024;
    let gpu = common::gpu();
    for (first, noise) in [(0.0f32, 0.1f32), (0.7, 0.1), (0.7, 0.01)] {
        let inputs = vec![[first, noise]; CELLS];
        let found: Vec<[f32; 4]> = run_kernel_with(&gpu, INTEGRATES, &inputs, &narrow());
        let mean = |value: &dyn Fn([f64; 4]) -> f64| found.iter().map(|cell| value(cell.map(f64::from))).sum::<f64>() / CELLS as f64;
        let bias = mean(&|[stored, _, exact, _]| stored - exact);
        let variance = mean(&|[stored, _, exact, _]| (stored - exact).powi(2));
        let expected = f64::from(noise) / 3.0f64.sqrt() / 2048.0 / 2.0;
        assert!(variance < 1.5 * expected, "{first}, {noise}: variance {variance}, {expected} expected");
        let chance = (variance / CELLS as f64).sqrt();
        assert!(bias.abs() < 5.0 * chance, "{first}, {noise}: bias {bias} +- {chance}");
        let stalled = mean(&|[_, nearest, exact, _]| nearest - exact);
        assert!(first == 0.0 || stalled > 5.0 * chance, "{first}, {noise}: the nearest would do, {stalled} +- {chance}");
        let count = mean(&|[.., count]| count) / 409_600.0;
        assert!((count - 1.0).abs() < 0.02, "{count} of the samples are counted");
    }
}

fn rendered(gpu: &Gpu, technique: &str, precision: &str, extent: [u32; 2], frames: u32) -> Renderer {
    let mut settings = settings(extent[0], extent[1]);
    set(&mut settings, &[("frame.precision", precision), ("hpsf.cells", "4")]);
    render_frames(gpu, &builtin("cornell"), &settings, technique, frames)
}

#[test]
fn cells_of_half_the_precision_are_half_the_bytes() {
    let gpu = common::gpu();
    let [wide, narrow] = PRECISIONS.map(|precision| {
        let timings = rendered(&gpu, "hpsf", precision, [64, 36], 1).timings().unwrap();
        let merge = timings.passes.into_iter().find(|pass| pass.name == "hpsf merge").unwrap();
        [merge.bytes_read, merge.bytes_written]
    });
    let slots = 4 * 64 * 36;
    // Seeds and cells are read, cells are written; keys and sums are as before.
    assert_eq!([wide[0] - narrow[0], wide[1] - narrow[1]], [slots * 16, slots * 8]);
}

#[test]
fn constant_radiance_comes_out_as_halves_have_it() {
    let gpu = common::gpu();
    let sky = [0.3, 0.7, 1.9];
    let mut scene = floor(5.0);
    scene.environment = Environment::Constant(sky);
    for technique in ["anhpsf", "hpsf+"] {
        let mut settings = settings(40, 24);
        settings.view = from_above(0.5);
        set(&mut settings, &[("paths.direct", "bsdf"), ("frame.precision", "fp16")]);
        for pixel in filtered(&render_frames(&gpu, &scene, &settings, technique, 8)).pixels {
            // Of the sample, the cell, the means of cells before and after they are smoothed.
            let near = (0..3).all(|c| (pixel[c] / sky[c] - 1.0).abs() < 4.0 * HALF_ULP);
            assert!(near, "{technique}: {pixel:?}");
        }
    }
}

/// Of a picture and what it is over, after so many frames more.
fn picture_after(renderer: &mut Renderer, frames: u32) -> (Image, Vec<f64>) {
    (0..frames).for_each(|_| renderer.render_frame().unwrap());
    renderer.finish().unwrap();
    let samples = output(renderer, "hpsf_samples").pixels.iter().map(|pixel| f64::from(pixel[0])).collect();
    (renderer.picture().unwrap(), samples)
}

/// Relative standard deviation of the sum over pixels. A count grows by units of 2^-6 to 2^-7 of itself at random, each with a variance of their size
/// times what is added: sqrt(1 / 184) of the count in the end. Pixels of one count share a cell.
fn chance_of_counts(of: &[f64]) -> f64 {
    let mut of_cells = BTreeMap::new();
    of.iter().for_each(|&count| *of_cells.entry(count as u64).or_insert(0.0) += count);
    (of_cells.values().map(|sum| sum * sum).sum::<f64>() / 184.0).sqrt() / of.iter().sum::<f64>()
}

/// Also after many frames, and in half precision the same in every run. Truth is three orders of magnitude farther away.
#[test]
fn pictures_of_both_precisions_agree() {
    let gpu = common::gpu();
    for (technique, later) in [("hpsf", 496), ("hpsf+", 16)] {
        let [mut wide, mut narrow] = PRECISIONS.map(|precision| rendered(&gpu, technique, precision, [32, 18], 0));
        let mut first = Vec::new();
        for frames in [16, later] {
            let [(exact, of), (rounded, of_rounded)] = [&mut wide, &mut narrow].map(|renderer| picture_after(renderer, frames));
            let error = relmse(&Pair::new(&rounded, &exact).unwrap(), 0.0);
            assert!(error > 0.0 && error < 2e-5, "{technique}, {frames} frames more: {error}");
            let samples = of_rounded.iter().sum::<f64>() / of.iter().sum::<f64>();
            let chance = chance_of_counts(&of);
            assert!((samples - 1.0).abs() < 3.0 * chance, "{technique}, {frames} frames more: {samples} +- {chance} of the samples");
            first.push(rounded);
        }
        narrow.restart(1, 0).unwrap();
        assert_eq!(picture_after(&mut narrow, 16).0.pixels, first[0].pixels, "{technique}");
    }
}
