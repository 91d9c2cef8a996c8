//! Keys of cells and their hashes against integers in Rust.

use crate::common;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use std::collections::{HashMap, HashSet};

const CELL: &str = r#"
#include "lib/hash_key.glsl"
struct In { vec3 local; ivec3 steps; int log2_step; int level; };
struct Out { ivec3 cell; };
void kernel(uint i) {
    In v = inputs[i];
    outputs[i] = Out(cell_of(v.local, v.steps, v.log2_step, v.level));
}
"#;

#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Place {
    local: [f32; 3],
    steps: [i32; 3],
    log2_step: i32,
    level: i32,
}

/// floor((local + steps 2^log2_step) / 2^level + 1/3) modulo 2^32, 2/3 at odd levels, exactly: everything is a whole number of thirds of 2^-40
/// metres.
fn oracle(place: &Place) -> [i32; 3] {
    let unit = 40;
    std::array::from_fn(|axis| {
        let local = (f64::from(place.local[axis]) * 2f64.powi(unit)) as i128;
        let world = local + (i128::from(place.steps[axis]) << (unit + place.log2_step));
        let cell = 1 << (unit + place.level);
        (3 * world + cell * (1 + i128::from(place.level & 1))).div_euclid(3 * cell) as i32
    })
}

/// Positions that are multiples of 2^-10 metres, on both sides of the origin, whose step is 2^3 metres.
fn places(seed: u64) -> Vec<Place> {
    let mut rng = Pcg32::seed_from_u64(seed);
    let place = |_| Place {
        local: [0; 3].map(|_| rng.random_range(-16_384..16_384) as f32 / 1024.0),
        steps: [0; 3].map(|_| rng.random_range(-200_000..200_000)),
        log2_step: 3,
        level: rng.random_range(-12..=5),
    };
    (0..50_000).map(place).collect()
}

#[test]
fn cells_are_shifted_floors_of_world_positions_on_both_sides_of_zero_and_a_million_metres_away() {
    let mut places = places(1);
    places.extend([-1.0f32, -0.25, 0.0, 0.25].map(|x| Place { local: [x, -x, 2.0 * x], steps: [0; 3], log2_step: 0, level: -1 }));
    let cells: Vec<[i32; 3]> = common::run_kernel(&common::gpu(), CELL, &places);
    for (place, cell) in places.iter().zip(cells) {
        assert_eq!(cell, oracle(place), "{place:?}");
    }
}

const FAMILY: &str = r#"
#include "lib/hash_key.glsl"
struct In { vec3 local; ivec3 steps; int log2_step; int level; };
struct Out { ivec3 parent; ivec3 coarser; uint among_children; };
void kernel(uint i) {
    In v = inputs[i];
    CellKey key = CellKey(cell_of(v.local, v.steps, v.log2_step, v.level), v.level, 0u, 0u);
    ivec3 coarser = cell_of(v.local, v.steps, v.log2_step, v.level + 1);
    uint found = 0u;
    for (uint child = 0u; child < 8u; child++) {
        found += child_of(CellKey(coarser, v.level + 1, 0u, 0u), child) == key ? 1u : 0u;
    }
    outputs[i] = Out(parent_of(key).cell, coarser, found);
}
"#;

#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Family {
    parent: [i32; 3],
    coarser: [i32; 3],
    among_children: u32,
}

#[test]
fn a_cell_is_one_of_eight_of_the_next_level() {
    // Coordinates below 2^31, of which none loses the bit that its parent needs.
    let places: Vec<Place> = places(5).into_iter().map(|place| Place { level: place.level.max(-8), ..place }).collect();
    let families: Vec<Family> = common::run_kernel(&common::gpu(), FAMILY, &places);
    for (place, family) in places.iter().zip(families) {
        assert!(family.parent == family.coarser && family.among_children == 1, "{place:?}: {family:?}");
    }
}

/// Walls and floors are where somebody has measured them off: at zero, and at eighths and tenths.
#[test]
fn round_measures_are_in_no_border_of_cells() {
    let gpu = common::gpu();
    let at = |i: i32, level| Place { local: [0.125 * i as f32, 0.0, 0.1 * i as f32], steps: [0; 3], log2_step: 3, level };
    let exact: Vec<Place> = (-12..=5).flat_map(|level| (-8..8).map(move |i| at(i, level))).collect();
    for off in [-1e-6, 1e-6] {
        let moved: Vec<Place> = exact.iter().map(|place| Place { local: place.local.map(|x| x + off), ..*place }).collect();
        let cells = [&exact, &moved].map(|places| common::run_kernel::<_, [i32; 3]>(&gpu, CELL, places));
        assert_eq!(cells[0], cells[1], "{off} m");
    }
}

#[test]
fn a_move_of_the_origin_changes_no_key() {
    let mut rng = Pcg32::seed_from_u64(2);
    let before = places(3);
    let moved = |place: &Place| {
        let by = [0; 3].map(|_| rng.random_range(-3..=3));
        let local = std::array::from_fn(|axis| place.local[axis] - (8 * by[axis]) as f32);
        Place { local, steps: std::array::from_fn(|axis| place.steps[axis] + by[axis]), ..*place }
    };
    let after: Vec<Place> = before.iter().map(moved).collect();
    let gpu = common::gpu();
    let cells: [Vec<[i32; 3]>; 2] = [&before, &after].map(|places| common::run_kernel(&gpu, CELL, places));
    assert_eq!(cells[0], cells[1]);
}

const HASHES: &str = r#"
#include "lib/hash_key.glsl"
struct In { ivec3 cell; int level; uint normal; uint layer; };
struct Out { uint index; uint fingerprint; uint without_normal; };
void kernel(uint i) {
    CellKey key = CellKey(inputs[i].cell, inputs[i].level, inputs[i].normal, inputs[i].layer);
    outputs[i] = Out(hash_index(key, true), hash_fingerprint(key), hash_index(key, false));
}
"#;

/// 64,000 neighbouring keys around zero, half of them of a glossy layer. By chance two of them share a fingerprint with probability 0.48, ten pairs with 10^-9; 256 bins
/// of an even index exceed a chi-square of 400 with 10^-8.
#[test]
fn hashes_differ_across_negative_coordinates_levels_normals_and_layers() {
    let mut keys = Vec::new();
    for (x, y, z) in (-10..10).flat_map(|x| (-10..10).flat_map(move |y| (-5..5).map(move |z| (x, y, z)))) {
        let layers = [0, 1 << 8].into_iter().flat_map(|layer| [-5, 2].map(|level| (level, layer)));
        keys.extend(layers.flat_map(|(level, layer)| [0, 1, 2, 255].map(|normal| [x, y, z, level, normal, layer])));
    }
    let hashes: Vec<[u32; 3]> = common::run_kernel(&common::gpu(), HASHES, &keys);
    let fingerprints: HashSet<u32> = hashes.iter().map(|hash| hash[1]).collect();
    assert!(fingerprints.len() + 10 > keys.len() && !fingerprints.contains(&0), "{} fingerprints", fingerprints.len());
    let both: HashSet<[u32; 2]> = hashes.iter().map(|hash| [hash[0], hash[1]]).collect();
    assert_eq!(both.len(), keys.len());
    for column in 0..2 {
        let mut bins = [0u32; 256];
        hashes.iter().for_each(|hash| bins[(hash[column] >> 24) as usize] += 1);
        let expected = keys.len() as f64 / 256.0;
        let chi_square: f64 = bins.iter().map(|&count| (f64::from(count) - expected).powi(2) / expected).sum();
        assert!(chi_square < 400.0, "{chi_square}");
    }
    for (key, hash) in keys.chunks(4).zip(hashes.chunks(4)) {
        assert!(hash.iter().all(|h| h[2] == hash[0][2]), "{key:?}: normals share a place where only the fingerprint has them");
    }
}

const MIDDLES: &str = r#"
#include "lib/hash_key.glsl"
struct In { uint bits; uint normal; };
struct Out { uint normal; vec3 middle; };
void kernel(uint i) {
    vec3 middle = middle_of_normals(inputs[i].normal, inputs[i].bits);
    outputs[i] = Out(quantise_normal(middle, inputs[i].bits), middle);
}
"#;

#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Middle {
    normal: u32,
    middle: [f32; 3],
}

#[test]
fn the_middle_of_a_cell_of_normals_is_a_unit_vector_in_it() {
    let cells: Vec<[u32; 2]> = (0..=8).flat_map(|bits| (0..1 << bits).map(move |normal| [bits, normal])).collect();
    let middles: Vec<Middle> = common::run_kernel(&common::gpu(), MIDDLES, &cells);
    for ([bits, normal], Middle { normal: found, middle }) in cells.into_iter().zip(middles) {
        let length = middle.iter().map(|x| x * x).sum::<f32>().sqrt();
        assert!(found == normal && (length - 1.0).abs() < 1e-3, "{normal} of {bits} bits: {found}, {middle:?}");
    }
}

const LEVELS: &str = r#"
#include "filter/hpsf/cell.glsl"
struct In { float distance; float number; };
struct Out { int level; };
void kernel(uint i) {
    outputs[i] = Out(level_at(inputs[i].distance, inputs[i].number));
}
"#;

/// Over all numbers the level is log2(width) - 1/2 in the mean, and one of the two around it; without blending it is rounded down.
#[test]
fn blended_levels_follow_the_width_without_a_step() {
    let (numbers, widths) = (256, 40);
    let width = |i: usize| 0.01 * (i as f64 * 0.17).exp2();
    let pairs = (0..widths).flat_map(|i| (0..numbers).map(move |n| [width(i) as f32, (n as f32 + 0.5) / numbers as f32]));
    let inputs: Vec<[f32; 2]> = pairs.collect();
    let mut options = common::kernel::KernelOptions::default();
    // A pixel at 1 m is 1/16 m high, and cells are 16 pixels wide: as wide as they are far away.
    options.frame.extent = [32, 32];
    options.frame.camera.up = [0.0, 1.0, 0.0];
    options.frame.camera.projection = 1;
    options.parameters.hpsf_width = 16.0;
    for blend in [0, 1] {
        options.constants = vec![(145, blend)];
        let levels: Vec<i32> = common::run_kernel_with(&common::gpu(), LEVELS, &inputs, &options);
        for (i, levels) in levels.chunks(numbers).enumerate() {
            let exact = width(i).log2();
            let (low, high) = (*levels.iter().min().unwrap(), *levels.iter().max().unwrap());
            let mean = levels.iter().map(|&level| f64::from(level)).sum::<f64>() / numbers as f64;
            if blend == 0 {
                assert_eq!((low, high), (exact.floor() as i32, exact.floor() as i32), "2^{exact} m");
            } else {
                assert!((mean - (exact - 0.5)).abs() <= 1.0 / numbers as f64 && high - low <= 1, "2^{exact} m: {mean}");
            }
        }
    }
}

const EXACT: &str = r#"
#include "lib/hash_key.glsl"
struct In { ivec3 cell; int level; uint normal; };
struct Out { uvec2 words; };
void kernel(uint i) {
    outputs[i] = Out(exact_key(CellKey(inputs[i].cell, inputs[i].level, inputs[i].normal, 0u)));
}
"#;

/// Every bit of what identifies a key within a view is there once; neither word is ever the empty slot's.
#[test]
fn exact_keys_hold_all_of_a_key() {
    let mut rng = Pcg32::seed_from_u64(4);
    let key = |_| {
        let cell = [0; 3].map(|_| rng.random_range(-1_000_000..1_000_000));
        [cell[0], cell[1], cell[2], rng.random_range(-100..=100), rng.random_range(0..256)]
    };
    let keys: Vec<[i32; 5]> = (0..50_000).map(key).chain([[0; 5]]).collect();
    let words: Vec<[u32; 2]> = common::run_kernel(&common::gpu(), EXACT, &keys);
    for ([x, y, z, level, normal], words) in keys.into_iter().zip(words) {
        assert!(words.iter().all(|word| word >> 31 == 1));
        let bits = u64::from(words[0] & 0x7fff_ffff) | u64::from(words[1] & 0x7fff_ffff) << 31;
        let field = |value: i32, width: u32, at: u32| u64::from(value as u32 & ((1 << width) - 1)) << at;
        let expected = field(x, 16, 0) | field(y, 16, 16) | field(z, 16, 32) | field(level, 6, 48) | field(normal, 8, 54);
        assert_eq!(bits, expected, "{x} {y} {z}, level {level}, normal {normal}");
    }
}

/// hpsf.probes by default.
const PROBES: usize = 8;

/// A floor of cells with a wall, as scenes have them, at two levels and with four normals each.
fn keys(count: usize) -> Vec<[i32; 6]> {
    let mut rng = Pcg32::seed_from_u64(11);
    let mut key = |i: usize| {
        let [u, v] = [0; 2].map(|_| rng.random_range(-500..500));
        let cell = if i.is_multiple_of(3) { [u, v, -3] } else { [u, 0, v] };
        [cell[0], cell[1], cell[2], -4 + (i % 2) as i32, rng.random_range(0..4), 0]
    };
    (0..count).map(&mut key).collect()
}

/// Inserts keys one by one as filter/hpsf/collect.glsl, remembering the whole key of each slot; counts those that are taken for another.
fn collisions(keys: &[[i32; 6]], hashes: &[[u32; 3]], slots: usize, fingerprint_bits: u32) -> usize {
    let mut table: HashMap<usize, (u32, [i32; 6])> = HashMap::new();
    let mut taken_for_another = 0;
    for (key, [index, fingerprint, _]) in keys.iter().zip(hashes) {
        let home = ((u64::from(*index) * slots as u64) >> 32) as usize;
        let fingerprint = fingerprint >> (32 - fingerprint_bits);
        let probes = || (0..PROBES).map(|i| (home + i) % slots);
        match probes().find(|slot| table.get(slot).is_some_and(|(held, _)| *held == fingerprint)) {
            Some(slot) => taken_for_another += usize::from(table[&slot].1 != *key),
            None => {
                if let Some(free) = probes().find(|slot| !table.contains_key(slot)) {
                    table.insert(free, (fingerprint, *key));
                }
            }
        }
    }
    taken_for_another
}

/// 200,000 keys in a table of as many slots: each is held against at most 8 fingerprints, so that one of 32 bits is taken for another's
/// with 200,000 * 8 / 2^32 = 0.0004 at most in all. With 16 bits the same count finds some: up to 24, and at half load about half of it.
#[test]
fn fingerprints_tell_keys_apart_as_exact_keys_do() {
    let keys = keys(200_000);
    let hashes: Vec<[u32; 3]> = common::run_kernel(&common::gpu(), HASHES, &keys);
    assert_eq!(collisions(&keys, &hashes, keys.len(), 32), 0);
    let short = collisions(&keys, &hashes, keys.len(), 16);
    assert!((1..=48).contains(&short), "{short} collisions of 16 bits");
}
