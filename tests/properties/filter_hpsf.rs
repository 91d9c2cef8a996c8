//! hpsf's table: the same in every run, exact in its sums, harmless when full, forgotten by a restart.

use crate::common;
use crate::common::render::{builtin, output, render_frames, set, settings};
use pathspace::display::Image;
use pathspace::technique::Settings;

fn with(values: &[(&str, &str)]) -> Settings {
    let mut settings = settings(64, 36);
    set(&mut settings, values);
    settings
}

fn bits(image: &Image) -> Vec<[u32; 3]> {
    image.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

/// Of the radiance behind the filter vertices, all pixels and channels.
fn sums(gpu: &pathspace::gpu::Gpu, settings: &Settings) -> ([f64; 2], Image) {
    let renderer = render_frames(gpu, &builtin("cornell"), settings, "hpsf", 1);
    let sum = |name: &str| output(&renderer, name).pixels.iter().flatten().map(|&v| f64::from(v)).sum::<f64>();
    ([sum("diffuse"), sum("diffuse_direct") + sum("diffuse_indirect")], output(&renderer, "hpsf_samples"))
}

#[test]
fn fixed_point_gives_the_same_bits_in_every_run() {
    let gpu = common::gpu();
    let scene = builtin("cornell");
    for (table, keys) in [("persistent", "fingerprint"), ("swapped", "fingerprint"), ("persistent", "exact"), ("swapped", "exact")] {
        let settings = with(&[("hpsf.table", table), ("hpsf.cells", "4"), ("hpsf.keys", keys)]);
        let [a, b] = [0, 1].map(|_| render_frames(&gpu, &scene, &settings, "hpsf", 4));
        assert_eq!(bits(&a.picture().unwrap()), bits(&b.picture().unwrap()), "{table}");
        let seen = output(&a, "attenuation").pixels.iter().filter(|pixel| pixel[0] > 0.0).count();
        let filtered = output(&a, "hpsf_samples").pixels.iter().filter(|pixel| pixel[0] > 0.0).count();
        assert!(filtered >= seen && seen > 500, "{table}: {filtered} of {seen} pixels are filtered");
    }
}

/// Each pixel reads the cell that its sample went to: the sum over pixels is that of the samples, whatever the cells are. With a unit of
/// 2^-32 the low words of fixed point overflow into the high ones again and again.
#[test]
fn cells_hold_exactly_what_went_in() {
    let gpu = common::gpu();
    for sums_in in ["fixed", "float"] {
        let own = [("hpsf.lookups", "0"), ("hpsf.levels", "1"), ("hpsf.time", "frame"), ("hpsf.sums", sums_in), ("hpsf.largest", "256")];
        let ([filtered, raw], samples) = sums(&gpu, &with(&own));
        assert!((filtered / raw - 1.0).abs() < 2e-6, "{sums_in}: {filtered} {raw}");
        assert!(samples.pixels.iter().any(|pixel| pixel[0] > 20.0), "{sums_in}: cells of many samples");
    }
}

/// A fingerprint that two keys share would mix their cells: then pictures would differ. Some 10^4 keys, 32 probes, of which one or two are
/// looked at: 10^-5 by chance. With 8 probes, a few keys find no slot, and which ones depends on their order.
#[test]
fn fingerprints_give_the_picture_of_exact_keys() {
    let gpu = common::gpu();
    let scene = builtin("hall-flight");
    let picture = |keys: &str, table: &str| {
        let cells = [("hpsf.cells", "8"), ("hpsf.probes", "32"), ("hpsf.width", "2"), ("hpsf.normal_bits", "8")];
        let mut settings = with(&[&cells[..], &[("hpsf.keys", keys), ("hpsf.table", table)]].concat());
        settings.outputs = vec!["hpsf_failed".to_owned()];
        let renderer = render_frames(&gpu, &scene, &settings, "hpsf", 4);
        let failed = output(&renderer, "hpsf_failed").pixels.iter().map(|pixel| pixel[0]).sum::<f32>();
        assert_eq!(failed, 0.0, "{keys}, {table}: keys without a slot");
        bits(&renderer.picture().unwrap())
    };
    for table in ["persistent", "swapped"] {
        assert_eq!(picture("fingerprint", table), picture("exact", table), "{table}");
    }
}

/// What is in a cell does not depend on its slot.
#[test]
fn where_there_is_room_for_all_keys_their_order_does_not_matter() {
    let gpu = common::gpu();
    let picture = |values: &[(&str, &str)]| {
        let settings = with(&[&[("hpsf.cells", "8"), ("hpsf.normal_bits", "0")], values].concat());
        bits(&render_frames(&gpu, &builtin("hall-flight"), &settings, "hpsf", 4).picture().unwrap())
    };
    for table in ["persistent", "swapped"] {
        let first = picture(&[("hpsf.table", table)]);
        assert_eq!(first, picture(&[("hpsf.table", table), ("hpsf.insertion", "ordered")]), "{table}");
        assert_eq!(first, picture(&[("hpsf.table", table), ("hpsf.eviction", "priority")]), "{table}");
    }
}

/// 64 slots for hundreds of cells of a camera that moves.
#[test]
fn an_ordered_table_gives_the_same_bits_in_every_run_also_when_it_is_full() {
    let gpu = common::gpu();
    let tiny = [("hpsf.cells", "0.02"), ("hpsf.width", "4"), ("hpsf.probes", "4")];
    for switch in [("hpsf.insertion", "ordered"), ("hpsf.eviction", "priority")] {
        for table in ["persistent", "swapped"] {
            let mut settings = with(&[&tiny[..], &[switch, ("hpsf.table", table)]].concat());
            settings.outputs = vec!["hpsf_failed".to_owned()];
            let [a, b] = [0, 1].map(|_| render_frames(&gpu, &builtin("hall-flight"), &settings, "hpsf", 3));
            assert_eq!(bits(&a.picture().unwrap()), bits(&b.picture().unwrap()), "{switch:?}, {table}");
            let failed = output(&a, "hpsf_failed").pixels.iter().filter(|pixel| pixel[0] > 0.0).count();
            assert!(failed > 200, "{switch:?}, {table}: {failed} pixels have failed insertions");
        }
    }
}

/// A table that cells of earlier frames fill up, which are long out of sight: new ones take their slots.
#[test]
fn cells_out_of_sight_give_way_by_priority() {
    let gpu = common::gpu();
    let failures = |eviction: &str| {
        let mut settings = with(&[("hpsf.age", "254"), ("hpsf.cells", "0.7"), ("hpsf.width", "6"), ("hpsf.eviction", eviction)]);
        settings.outputs = vec!["hpsf_failed".to_owned()];
        let renderer = render_frames(&gpu, &builtin("hall-flight"), &settings, "hpsf", 24);
        output(&renderer, "hpsf_failed").pixels.iter().map(|pixel| pixel[0]).sum::<f32>()
    };
    let (kept, evicted) = (failures("age"), failures("priority"));
    assert!(kept > 100.0 && evicted < 0.25 * kept, "{kept} insertions fail, and {evicted}");
}

/// With all normals of a place taken in, cells are what they are without normals in the key, whose number at a place is 16.
#[test]
fn cells_of_all_similar_normals_are_those_without_normals() {
    let gpu = common::gpu();
    let scene = builtin("cornell-object");
    let all = [("hpsf.seed", "off"), ("hpsf.cells", "8"), ("hpsf.probes", "64"), ("hpsf.few", "100000")];
    let own = [&all[..], &[("hpsf.lookups", "0"), ("hpsf.levels", "1")]].concat();
    for keys in [("hpsf.keys", "fingerprint"), ("hpsf.keys", "exact"), ("hpsf.insertion", "ordered")] {
        let rendered = |values: &[(&str, &str)]| render_frames(&gpu, &scene, &with(&[&own[..], &[keys], values].concat()), "hpsf", 2);
        let merged = rendered(&[("hpsf.normals", "similar"), ("hpsf.similar", "180"), ("hpsf.normal_bits", "4")]);
        let plain = rendered(&[("hpsf.normal_bits", "0")]);
        let apart = rendered(&[("hpsf.normals", "similar"), ("hpsf.similar", "1"), ("hpsf.normal_bits", "4")]);
        let samples = |renderer| output(renderer, "hpsf_samples");
        assert_eq!(bits(&samples(&merged)), bits(&samples(&plain)), "{keys:?}");
        assert_ne!(bits(&samples(&merged)), bits(&samples(&apart)), "{keys:?}");
        let pairs = output(&merged, "diffuse").pixels.into_iter().zip(output(&plain, "diffuse").pixels);
        let far = pairs.filter(|(a, b)| (0..3).any(|c| (a[c] - b[c]).abs() > 1e-5 * b[c].abs().max(1e-3))).count();
        assert_eq!(far, 0, "{keys:?}: {far} pixels differ");
    }
}

/// 64 slots for some hundreds of cells: the pixels that find none keep their own sample, and not one is lost.
#[test]
fn a_full_table_leaves_pixels_unfiltered_and_darkens_nothing() {
    let gpu = common::gpu();
    let tiny = [("hpsf.cells", "0.001"), ("hpsf.width", "4"), ("hpsf.lookups", "0"), ("hpsf.levels", "1")];
    for keys in ["fingerprint", "exact"] {
        let ([filtered, raw], samples) = sums(&gpu, &with(&[&tiny[..], &[("hpsf.keys", keys)]].concat()));
        assert!((filtered / raw - 1.0).abs() < 2e-6, "{keys}: {filtered} {raw}");
        let found = samples.pixels.iter().filter(|pixel| pixel[0] > 0.0).count();
        assert!(found > 0 && found < samples.pixels.len() / 3, "{keys}: {found} pixels are filtered");
    }
}

#[test]
fn a_restart_forgets_every_frame_before_it() {
    let gpu = common::gpu();
    let scene = builtin("cornell");
    for (technique, table) in
        [("hpsf", "persistent"), ("hpsf", "swapped"), ("hpsf+", "persistent"), ("nhpsf", "persistent"), ("nhpsf", "swapped")]
    {
        let settings = with(&[("hpsf.table", table), ("hpsf.cells", "4")]);
        let mut used = render_frames(&gpu, &scene, &settings, technique, 3);
        used.restart(7, 0).unwrap();
        used.render_frame().unwrap();
        let fresh = render_frames(&gpu, &scene, &Settings { seed: 7, ..settings }, technique, 1);
        assert_eq!(bits(&used.picture().unwrap()), bits(&fresh.picture().unwrap()), "{technique}, {table}");
    }
}

/// Frames of a still camera are integrated: cells know the samples of all of them, and less noise is left.
#[test]
fn frames_add_up_where_time_is_integrated() {
    let gpu = common::gpu();
    let scene = builtin("cornell");
    let most = |time: &str, table: &str, frames| {
        let settings = with(&[("hpsf.time", time), ("hpsf.table", table), ("hpsf.jitter", "0"), ("hpsf.levels", "1")]);
        let samples = output(&render_frames(&gpu, &scene, &settings, "hpsf", frames), "hpsf_samples");
        samples.pixels.iter().map(|pixel| pixel[0]).fold(0.0, f32::max)
    };
    let one = most("integrate", "persistent", 1);
    assert_eq!(most("integrate", "persistent", 4), 4.0 * one);
    assert_eq!(most("integrate", "swapped", 4), 4.0 * one);
    assert_eq!(most("frame", "persistent", 4), one);
}
