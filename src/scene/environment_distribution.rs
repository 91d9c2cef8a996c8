//! An environment map as lib/lights.glsl samples it: texels chosen in proportion to the light that comes through them.
//!
//! Radiance is looked up bilinearly, so that a texel's share is the mean of the interpolated radiance over it: the map filtered with
//! (1/8, 6/8, 1/8) along both axes, times the texel's solid angle. A black texel beside a bright one has a share, too.
//! 24 bytes per texel.

use super::Environment;
use super::alias::AliasBuilder;
use crate::shared::AliasEntry;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Device data of one environment map.
#[derive(Debug, Clone, Default)]
pub struct EnvironmentDistribution {
    /// Columns, rows; 0 for a constant environment.
    pub size: [u32; 2],
    /// Radiance, and probability density over the unit square, of each texel.
    pub texels: Vec<[f32; 4]>,
    pub alias: Vec<AliasEntry>,
    /// Radiance, mean of the channels, integrated over the sphere: W/m^2.
    pub integral: f64,
}

impl EnvironmentDistribution {
    pub fn new(environment: &Environment) -> Self {
        match environment {
            Environment::Constant(radiance) => Self { integral: 4.0 * PI * mean(*radiance), ..Self::default() },
            Environment::Map { width, height, pixels } => Self::of_map([*width, *height], pixels),
        }
    }

    fn of_map(size: [u32; 2], pixels: &[[f32; 3]]) -> Self {
        let [width, height] = size.map(|edge| edge as usize);
        let texel = |column: usize, row: usize| mean(pixels[row * width + column]);
        let filtered = |i: usize| {
            let (column, row) = (i % width, i / width);
            let across = |row: usize| tent(texel((column + width - 1) % width, row), texel(column, row), texel((column + 1) % width, row));
            tent(across(row.saturating_sub(1)), across(row), across((row + 1).min(height - 1)))
        };
        let solid_angle = |row: usize| {
            let latitude = |edge: usize| (PI * edge as f64 / height as f64).cos();
            (latitude(row) - latitude(row + 1)) * 2.0 * PI / width as f64
        };
        let shares: Vec<f64> = (0..pixels.len()).into_par_iter().map(|i| filtered(i) * solid_angle(i / width)).collect();
        let mut alias = Vec::new();
        let integral = AliasBuilder::default().build(&shares, &mut alias);
        let density = if integral > 0.0 { pixels.len() as f64 / integral } else { 0.0 };
        let texels = pixels.iter().zip(&shares).map(|(&[r, g, b], share)| [r, g, b, (share * density) as f32]).collect();
        Self { size, texels, alias, integral }
    }
}

fn mean([r, g, b]: [f32; 3]) -> f64 {
    (f64::from(r) + f64::from(g) + f64::from(b)) / 3.0
}

fn tent(before: f64, at: f64, after: f64) -> f64 {
    0.125 * before + 0.75 * at + 0.125 * after
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(width: u32, height: u32, pixels: Vec<[f32; 3]>) -> EnvironmentDistribution {
        EnvironmentDistribution::new(&Environment::Map { width, height, pixels })
    }

    #[test]
    fn a_white_map_holds_what_a_white_constant_does() {
        let white = map(16, 8, vec![[1.0; 3]; 128]);
        assert!((white.integral - EnvironmentDistribution::new(&Environment::Constant([1.0; 3])).integral).abs() < 1e-12);
    }

    #[test]
    fn the_density_integrates_to_one_over_the_square() {
        let pixels = (0..128).map(|i| [(i * 37 % 11) as f32, 0.5, (i % 3) as f32]).collect();
        let distribution = map(16, 8, pixels);
        let mean = distribution.texels.iter().map(|texel| f64::from(texel[3])).sum::<f64>() / 128.0;
        assert!((mean - 1.0).abs() < 1e-6, "{mean}");
    }

    #[test]
    fn neighbours_of_a_bright_texel_can_be_chosen_around_the_seam_too() {
        let mut pixels = vec![[0.0; 3]; 128];
        pixels[4 * 16] = [1000.0; 3];
        let distribution = map(16, 8, pixels);
        for (column, row) in [(0, 4), (15, 4), (1, 4), (0, 3), (15, 5)] {
            assert!(distribution.texels[row * 16 + column][3] > 0.0, "({column}, {row})");
        }
        assert_eq!(distribution.texels[8][3], 0.0);
    }
}
