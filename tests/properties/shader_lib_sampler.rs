//! lib/rng.glsl and lib/sampler.glsl against twins written here from the papers: integers, so that the bits must be the same.

use crate::common::{self, KernelOptions};
use bytemuck::{Pod, Zeroable};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;

const SAMPLER: u32 = 102;
const SOBOL: u32 = 0;
const R2: u32 = 1;
const INDEPENDENT: u32 = 2;

/// Integers as the shader counts: modulo 2^32.
mod twin {
    use super::*;

    pub fn pcg(value: u32) -> u32 {
        let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
        (word >> 22) ^ word
    }

    /// pcg2d, pcg3d and pcg4d differ in which component multiplies which: `rounds` lists (changed, a, b) for v[changed] += v[a] * v[b].
    fn pcg_nd<const N: usize>(v: [u32; N], rounds: &[(usize, usize, usize)]) -> [u32; N] {
        let mut v = v.map(|x| x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
        for half in 0..2 {
            for &(changed, a, b) in rounds {
                v[changed] = v[changed].wrapping_add(v[a].wrapping_mul(v[b]));
            }
            if half == 0 {
                v = v.map(|x| x ^ (x >> 16));
            }
        }
        v
    }

    pub fn pcg2d([x, y]: [u32; 2]) -> [u32; 2] {
        let scramble = |[x, y]: [u32; 2]| {
            let x = x.wrapping_add(y.wrapping_mul(1_664_525));
            [x, y.wrapping_add(x.wrapping_mul(1_664_525))]
        };
        let start = [x, y].map(|x: u32| x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
        scramble(scramble(start).map(|x| x ^ (x >> 16))).map(|x| x ^ (x >> 16))
    }

    pub fn pcg3d(v: [u32; 3]) -> [u32; 3] {
        pcg_nd(v, &[(0, 1, 2), (1, 2, 0), (2, 0, 1)])
    }

    pub fn pcg4d(v: [u32; 4]) -> [u32; 4] {
        pcg_nd(v, &[(0, 1, 3), (1, 2, 0), (2, 0, 1), (3, 1, 2)])
    }

    fn owen(bits: u32, seed: u32) -> u32 {
        let mut x = bits.reverse_bits();
        x ^= x.wrapping_mul(0x3d20_adea);
        x = x.wrapping_add(seed).wrapping_mul((seed >> 16) | 1);
        x ^= x.wrapping_mul(0x0552_6c56);
        x ^= x.wrapping_mul(0x53a2_2864);
        x.reverse_bits()
    }

    /// By direction numbers, one bit of the index at a time: 1/2, 1/4, .. and v, v ^ (v >> 1), ..
    fn sobol(index: u32) -> [u32; 2] {
        let (mut point, mut second) = ([0, 0], 1u32 << 31);
        for bit in 0..32 {
            if index >> bit & 1 == 1 {
                point[0] ^= 1 << (31 - bit);
                point[1] ^= second;
            }
            second ^= second >> 1;
        }
        point
    }

    /// Call `dimension` of a pixel's sample.
    pub fn sample(sampler: u32, [x, y]: [u32; 2], index: u32, seed: u32, dimension: u32) -> [u32; 2] {
        let scramble = pcg3d([x, y, seed])[0];
        let key = pcg3d([scramble, dimension, if sampler == INDEPENDENT { index } else { 0x9e37_79b9 }]);
        if sampler == INDEPENDENT {
            return [key[0], key[1]];
        }
        let shuffled = owen(index, key[2]);
        match sampler {
            R2 => [0xc13f_a9a9, 0x91e1_0da5].map(|step: u32| step.wrapping_mul(shuffled)).into_iter().zip(key).map(add).collect::<Vec<_>>(),
            _ => sobol(shuffled).into_iter().zip(key).map(|(bits, seed)| owen(bits, seed)).collect(),
        }
        .try_into()
        .unwrap()
    }

    fn add((a, b): (u32, u32)) -> u32 {
        a.wrapping_add(b)
    }
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
struct Key {
    pixel: [u32; 2],
    index: u32,
    seed: u32,
}

/// Four pairs and then a single number of one sample.
const KERNEL: &str = "
#include \"lib/sampler.glsl\"
struct In { uvec2 pixel; uint index; uint seed; };
struct Out { uvec2 bits[4]; vec2 pairs[4]; float single; };
void kernel(uint i) {
    Sampler s = sampler_begin(inputs[i].pixel, inputs[i].index, inputs[i].seed);
    Sampler again = s;
    for (int k = 0; k < 4; k++) {
        outputs[i].bits[k] = sampler_next(s);
        outputs[i].pairs[k] = sample_2d(again);
    }
    outputs[i].single = sample_1d(again);
}
";

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
struct Sample {
    bits: [[u32; 2]; 4],
    pairs: [[f32; 2]; 4],
    single: f32,
}

fn sample(sampler: u32, keys: &[Key]) -> Vec<Sample> {
    let options = KernelOptions { constants: vec![(SAMPLER, sampler)], ..Default::default() };
    common::run_kernel_with(&common::gpu(), KERNEL, keys, &options)
}

fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 / 16_777_216.0
}

#[test]
fn hashes_are_bit_identical_to_their_twins() {
    const SOURCE: &str = "
        #include \"lib/rng.glsl\"
        struct In { uvec4 v; };
        struct Out { uint one; uvec2 two; uvec3 three; uvec4 four; };
        void kernel(uint i) {
            uvec4 v = inputs[i].v;
            outputs[i] = Out(pcg_hash(v.x), pcg2d(v.xy), pcg3d(v.xyz), pcg4d(v));
        }";
    let mut rng = Pcg32::seed_from_u64(1);
    let mut inputs: Vec<[u32; 4]> = (0..10_000).map(|_| [0; 4].map(|_| rng.random())).collect();
    inputs.extend([[0; 4], [u32::MAX; 4], [1, 0, 0, 0], [0, 0, 0, 1 << 31]]);
    let outputs: Vec<[u32; 10]> = common::run_kernel(&common::gpu(), SOURCE, &inputs);
    for (&v, out) in inputs.iter().zip(outputs) {
        assert_eq!(out[0], twin::pcg(v[0]));
        assert_eq!(out[1..3], twin::pcg2d([v[0], v[1]]));
        assert_eq!(out[3..6], twin::pcg3d([v[0], v[1], v[2]]));
        assert_eq!(out[6..10], twin::pcg4d(v));
    }
}

#[test]
fn samplers_are_bit_identical_to_their_twins_and_below_one() {
    let mut rng = Pcg32::seed_from_u64(2);
    let mut keys: Vec<Key> = (0..5000)
        .map(|_| Key {
            pixel: [rng.random_range(0..4096), rng.random_range(0..4096)],
            index: rng.random_range(0..100_000),
            seed: rng.random(),
        })
        .collect();
    keys.push(Key { pixel: [u32::MAX; 2], index: u32::MAX, seed: u32::MAX });
    for sampler in [SOBOL, R2, INDEPENDENT] {
        for (key, out) in keys.iter().zip(sample(sampler, &keys)) {
            for dimension in 0..4u32 {
                let expected = twin::sample(sampler, key.pixel, key.index, key.seed, dimension);
                assert_eq!(out.bits[dimension as usize], expected, "sampler {sampler}, dimension {dimension}: {key:?}");
                assert_eq!(out.pairs[dimension as usize], expected.map(unit));
            }
            let all = out.pairs.iter().flatten().chain([&out.single]);
            assert!(all.into_iter().all(|value| (0.0..1.0).contains(value)));
            assert_eq!(out.single, unit(twin::sample(sampler, key.pixel, key.index, key.seed, 4)[0]));
        }
    }
}

/// The largest number that any bits can become.
#[test]
fn all_ones_become_the_largest_float_below_one() {
    assert_eq!(unit(u32::MAX), 1.0f32.next_down());
}

/// 4^k successive samples of a pair of Sobol dimensions, from any multiple of it on, have exactly one in each elementary interval:
/// scrambling and shuffling keep the (0,2)-sequence one.
#[test]
fn sobol_pairs_stay_a_zero_two_sequence() {
    for (first, log_count) in [(0, 8), (256, 8), (4096, 6)] {
        let count = 1u32 << log_count;
        let keys: Vec<Key> = (first..first + count).map(|index| Key { pixel: [17, 4], index, seed: 3 }).collect();
        let samples = sample(SOBOL, &keys);
        for pair in 0..4 {
            for columns in 0..=log_count {
                let mut seen = vec![0; count as usize];
                for sample in &samples {
                    let [x, y] = sample.bits[pair].map(u64::from);
                    let (column, row) = ((x << columns) >> 32, (y << (log_count - columns)) >> 32);
                    seen[((column << (log_count - columns)) + row) as usize] += 1;
                }
                assert!(seen.iter().all(|&count| count == 1), "pair {pair}, 2^{columns} columns");
            }
        }
    }
}

/// Successive pairs of a path must not repeat each other: over 4096 samples the correlation of any two coordinates of different
/// pairs is below 5 standard errors (1/64 each); 24 correlations in each of 3 samplers would fail by chance once in 24,000.
#[test]
fn pairs_of_dimensions_are_uncorrelated() {
    let keys: Vec<Key> = (0..4096).map(|index| Key { pixel: [5, 9], index, seed: 1 }).collect();
    for sampler in [SOBOL, R2, INDEPENDENT] {
        let samples = sample(sampler, &keys);
        let coordinate = |k: usize| samples.iter().map(move |sample| f64::from(sample.pairs[k / 2][k % 2]) - 0.5);
        for a in 0..8 {
            for b in (a / 2 + 1) * 2..8 {
                let correlation = coordinate(a).zip(coordinate(b)).map(|(x, y)| 12.0 * x * y).sum::<f64>() / 4096.0;
                assert!(correlation.abs() < 5.0 / 64.0, "sampler {sampler}: coordinates {a} and {b} have correlation {correlation}");
            }
        }
    }
}

const TILE: &str = r#"
#include "lib/sampler.glsl"
struct In { uint pixel[2]; };
struct Out { vec2 point; };
void kernel(uint i) {
    Sampler numbers = sampler_of_tile(uvec2(inputs[i].pixel[0], inputs[i].pixel[1]), 5u, 3u);
    numbers.dimension = 6u;
    outputs[i] = Out(sample_2d(numbers));
}
"#;

/// One sample each of 16x16 pixels is a (0, 8, 2)-net, of 8x8 and 4x4 of them smaller ones, where chance fills two thirds of the intervals.
#[test]
fn pixels_of_a_tile_share_out_a_net() {
    let pixels: Vec<[u32; 2]> = (0..256).map(|i| [48 + i % 16, 16 + i / 16]).collect();
    let points: Vec<[f32; 2]> = common::run_kernel(&common::gpu(), TILE, &pixels);
    for (side, log2) in [(16, 8), (8, 6), (4, 4)] {
        let within = pixels.iter().zip(&points).filter(|([x, y], _)| x - 48 < side && y - 16 < side);
        let points: Vec<[f32; 2]> = within.map(|(_, point)| *point).collect();
        for columns in 0..=log2 {
            let interval = |[x, y]: [f32; 2]| [(x * f32::exp2(columns as f32)) as u32, (y * f32::exp2((log2 - columns) as f32)) as u32];
            let filled: std::collections::HashSet<[u32; 2]> = points.iter().map(|&point| interval(point)).collect();
            assert_eq!(filled.len(), 1 << log2, "{side}x{side} pixels, 2^{columns} columns");
        }
    }
}
