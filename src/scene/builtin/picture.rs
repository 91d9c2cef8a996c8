//! Textures from formulas. Coordinates run over the unit square, v downwards, and repeat without a seam.

use glam::{Vec2, Vec3, vec2};
use image::{DynamicImage, Rgb, RgbImage};
use std::f32::consts::TAU;

/// 8-bit RGB of `side` squared texels, `color` in 0 to 1 as stored: sRGB for colours, linear for data.
pub fn paint(side: u32, color: impl Fn(Vec2) -> Vec3) -> DynamicImage {
    let texel = |x: u32, y: u32| color((vec2(x as f32, y as f32) + 0.5) / side as f32);
    let quantize = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    RgbImage::from_fn(side, side, |x, y| Rgb(texel(x, y).to_array().map(quantize))).into()
}

/// Tangent-space normal map of a height field, in units of the texture's width; +y is up in the picture, as glTF has it.
pub fn paint_normals(side: u32, height: impl Fn(Vec2) -> f32) -> DynamicImage {
    let step = 0.5 / side as f32;
    paint(side, |uv| {
        let along_u = (height(uv + vec2(step, 0.0)) - height(uv - vec2(step, 0.0))) / (2.0 * step);
        let along_v = (height(uv + vec2(0.0, step)) - height(uv - vec2(0.0, step))) / (2.0 * step);
        Vec3::new(-along_u, along_v, 1.0).normalize() * 0.5 + 0.5
    })
}

/// 0 or 1 over `cells` by `cells` squares; `cells` is even, so that it repeats.
pub fn checker(uv: Vec2, cells: f32) -> f32 {
    let cell = (uv * cells).floor();
    (cell.x + cell.y).rem_euclid(2.0)
}

/// Smooth value noise in -1 to 1 that repeats after `period` cells of size 1.
pub fn noise(point: Vec2, period: u32, seed: u32) -> f32 {
    let cell = point.floor();
    let f = point - cell;
    let blend = f * f * (3.0 - 2.0 * f);
    let corner = |x: f32, y: f32| {
        let wrap = |value: f32| (value as i32).rem_euclid(period as i32) as u32;
        random(wrap(cell.x + x), wrap(cell.y + y), seed) * 2.0 - 1.0
    };
    let lower = corner(0.0, 0.0) + (corner(1.0, 0.0) - corner(0.0, 0.0)) * blend.x;
    let upper = corner(0.0, 1.0) + (corner(1.0, 1.0) - corner(0.0, 1.0)) * blend.x;
    lower + (upper - lower) * blend.y
}

/// Octaves of [`noise`], about -1 to 1.
pub fn fractal(point: Vec2, period: u32, seed: u32, octaves: u32) -> f32 {
    (0..octaves).map(|i| noise(point * (1 << i) as f32, period << i, seed + i) * 0.5f32.powi(i as i32)).sum::<f32>() * 0.6
}

/// Uniform in 0 to 1, the same on every machine (PCG's output permutation).
pub fn random(x: u32, y: u32, seed: u32) -> f32 {
    let hash = |value: u32| {
        let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
        (word >> 22) ^ word
    };
    (hash(x.wrapping_add(hash(y.wrapping_add(hash(seed))))) >> 8) as f32 / (1u32 << 24) as f32
}

/// Rounded studs in a square grid of `count` by `count`, `height` high.
pub fn studs(uv: Vec2, count: f32, height: f32) -> f32 {
    let wave = ((uv.x * count * TAU).cos() * (uv.y * count * TAU).cos()).max(0.0);
    height * wave.sqrt().min(0.8)
}
