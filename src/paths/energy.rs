//! Tables for the energy that one bounce between GGX microfacets loses. `shaders_glsl/lib/energy.glsl` says what they are for and reads them.
//!
//! One `Vec<f32>` in this order, cosine fastest:
//! - GGX reflection [ROUGHNESSES][COSINES][2]: albedo for F = 1, and for F = Schlick's rise (1 - cos)^5 alone;
//! - their averages over the cosine-weighted hemisphere [ROUGHNESSES][2];
//! - where asked for, a refracting boundary [GLASS_IORS][GLASS_ROUGHNESSES][GLASS_COSINES][3]: k with albedo = k0 + k1 f0 + k2 f90 of
//!   reflection and refraction together;
//! - their averages [GLASS_IORS][GLASS_ROUGHNESSES][3].
//!
//! Axes are uniform in sqrt(cos), in roughness (alpha = roughness^2) and, for the index of refraction, in the signed square root of
//! (eta - 1) / (eta + 1), in which the critical angle's cosine is nearly linear. Integrals are lattice rules over visible normals (Dupuy and
//! Benyoub 2023; for reflection bounded, Eto and Tokuyoshi 2023), so that each sample weighs G2 / G1. They run in eight lanes of single
//! precision without branches, which compilers turn into vector code. Averages integrate the linear interpolant exactly, as shaders
//! will see it: the returned energy is then complete whatever the table's own error.

use rayon::prelude::*;
use std::f32::consts::PI;

pub const COSINES: usize = 32;
pub const ROUGHNESSES: usize = 32;
pub const GLASS_COSINES: usize = 26;
pub const GLASS_ROUGHNESSES: usize = 26;
/// Odd: eta = 1 is a node.
pub const GLASS_IORS: usize = 33;
/// Largest signed square root of (eta - 1) / (eta + 1), up to eta = 3.1, chosen so that eta = 1.5, the usual one, is a node: 8/5 sqrt(1/5).
pub const GLASS_IOR_RANGE: f64 = 0.715_541_752_799_933;

/// 17 kB, or with `refraction`, which only rough transmission needs, 290 kB.
pub fn energy_tables(refraction: bool) -> Vec<f32> {
    let ggx_lattice = Lattice::new(608, 377);
    let ggx = (0..ROUGHNESSES).into_par_iter().map(|i| {
        let alpha = node(i, ROUGHNESSES).powi(2);
        (0..COSINES).map(|c| reflected(node(c, COSINES).powi(2), alpha, &ggx_lattice)).collect()
    });
    let mut table = with_averages::<2>(ggx.collect());
    if refraction {
        let lattice = Lattice::new(440, 273);
        let lines = (0..GLASS_IORS * GLASS_ROUGHNESSES).into_par_iter().map(|line| {
            let (eta, alpha) = (node_eta(line / GLASS_ROUGHNESSES), node(line % GLASS_ROUGHNESSES, GLASS_ROUGHNESSES).powi(2));
            (0..GLASS_COSINES).map(|c| boundary(node(c, GLASS_COSINES).powi(2), alpha, eta, &lattice)).collect()
        });
        table.extend(with_averages::<3>(lines.collect()));
    }
    table
}

/// Coordinate of a node of an axis of `count` nodes over 0..1.
fn node(i: usize, count: usize) -> f32 {
    i as f32 / (count - 1) as f32
}

/// Index of refraction of a node of the third axis.
fn node_eta(i: usize) -> f32 {
    let x = GLASS_IOR_RANGE * (2.0 * i as f64 / (GLASS_IORS - 1) as f64 - 1.0);
    let r = x * x.abs();
    ((1.0 + r) / (1.0 - r)) as f32
}

/// All entries, then the average of each line.
fn with_averages<const N: usize>(lines: Vec<Vec<[f64; N]>>) -> Vec<f32> {
    let averages = lines.iter().flat_map(|line| average(line));
    lines.iter().flatten().flatten().copied().chain(averages).map(|value| value as f32).collect()
}

/// Integral of a line's linear interpolant in x = sqrt(cos) times 2 cos dcos = 4 x^3 dx.
fn average<const N: usize>(line: &[[f64; N]]) -> [f64; N] {
    let step = 1.0 / (line.len() - 1) as f64;
    let mut sum = [0.0; N];
    for (i, pair) in line.windows(2).enumerate() {
        let (x0, x1) = (i as f64 * step, (i + 1) as f64 * step);
        let (volume, moment) = (x1.powi(4) - x0.powi(4), 0.8 * (x1.powi(5) - x0.powi(5)));
        for k in 0..N {
            let slope = (pair[1][k] - pair[0][k]) / step;
            sum[k] += (pair[0][k] - slope * x0) * volume + slope * moment;
        }
    }
    sum
}

/// Albedo of reflection for F = 1 and for F = Schlick's rise.
fn reflected(cosine: f32, alpha: f32, lattice: &Lattice) -> [f64; 2] {
    let rise = |cosine: f32| (1.0 - cosine).powi(5);
    if alpha == 0.0 {
        return [1.0, rise(cosine).into()];
    }
    let view = View::new(cosine, alpha);
    let bound = view.reflection_bound();
    let scale = (bound * view.cosine + view.stretched) / (view.cosine + view.stretched);
    lattice.mean(|azimuth, height| {
        let (oh, normal_z) = view.visible_normal(bound, azimuth, height);
        let weight = scale * view.masked(2.0 * oh * normal_z - view.cosine);
        [weight, weight * rise(oh)]
    })
}

/// Albedo k0 + k1 f0 + k2 f90 of a boundary to a medium of relative index `eta`, by F = f0 + (f90 - f0) rise, total reflection apart.
fn boundary(cosine: f32, alpha: f32, eta: f32, lattice: &Lattice) -> [f64; 3] {
    if alpha == 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let view = View::new(cosine, alpha);
    let f0 = ((1.0 - eta) / (1.0 + eta)).powi(2);
    lattice.mean(|azimuth, height| {
        let (oh, normal_z) = view.visible_normal(1.0, azimuth, height);
        let reflection = view.masked(2.0 * oh * normal_z - view.cosine);
        let cos2 = 1.0 - (1.0 - oh * oh) / (eta * eta);
        let refracted = cos2.max(0.0).sqrt();
        let transmission = view.masked(view.cosine / eta - (oh / eta - refracted) * normal_z);
        let perpendicular = (oh - eta * refracted) / (oh + eta * refracted);
        let parallel = (eta * oh - refracted) / (eta * oh + refracted);
        let rise = (0.5 * (perpendicular * perpendicular + parallel * parallel) - f0) / (1.0 - f0);
        let difference = if cos2 <= 0.0 { 0.0 } else { reflection - transmission };
        [reflection - difference, (1.0 - rise) * difference, rise * difference]
    })
}

/// A direction above a rough surface, in the plane of azimuth 0.
struct View {
    cosine: f32,
    sine: f32,
    alpha: f32,
    /// Length of the direction stretched by alpha.
    stretched: f32,
}

impl View {
    fn new(cosine: f32, alpha: f32) -> Self {
        let cosine = cosine.max(1e-4);
        Self { cosine, sine: (1.0 - cosine * cosine).sqrt(), alpha, stretched: stretched(alpha, cosine) }
    }

    /// Eto and Tokuyoshi, equation 5.
    fn reflection_bound(&self) -> f32 {
        let (s2, a2) = ((1.0 + self.sine).powi(2), self.alpha * self.alpha);
        (1.0 - a2) * s2 / (s2 + a2 * self.cosine * self.cosine)
    }

    /// Cosines of the normal that a point of the unit square stands for with the view and with the mean normal. Bounded as
    /// lib/microfacet.glsl's; `azimuth` is the cosine of the point's.
    #[inline(always)]
    fn visible_normal(&self, bound: f32, azimuth: f32, height: f32) -> (f32, f32) {
        let (x, z) = (self.alpha * self.sine / self.stretched, self.cosine / self.stretched);
        let cap_z = 1.0 - height * (1.0 + bound * z);
        let cap_radius2 = (1.0 - cap_z * cap_z).max(0.0);
        let (h_x, h_z) = (cap_radius2.sqrt() * azimuth + x, (cap_z + z).max(0.0));
        let h_y2 = cap_radius2 * (1.0 - azimuth * azimuth);
        let length = (self.alpha * self.alpha * (h_x * h_x + h_y2) + h_z * h_z).sqrt();
        let (normal_x, normal_z) = (self.alpha * h_x / length, h_z / length);
        ((self.sine * normal_x + self.cosine * normal_z).min(1.0), normal_z)
    }

    /// G2 / G1: what height-correlated masking leaves of light that a visible normal sends to a direction of this cosine; 0 below the horizon.
    #[inline(always)]
    fn masked(&self, cos_i: f32) -> f32 {
        let (cos_i, ratio) = (cos_i.max(0.0), self.stretched / self.cosine);
        (1.0 + ratio) * cos_i / (ratio * cos_i + stretched(self.alpha, cos_i))
    }
}

#[inline(always)]
fn stretched(alpha: f32, cosine: f32) -> f32 {
    (alpha * alpha * (1.0 - cosine * cosine).max(0.0) + cosine * cosine).sqrt()
}

const LANES: usize = 8;

/// A rank-1 lattice of the unit square: point i is (i, i * generator mod points) / points. The first coordinate is half an azimuth, of which
/// the cosine is kept: both halves are alike.
struct Lattice(Vec<[[f32; LANES]; 2]>);

impl Lattice {
    fn new(points: usize, generator: usize) -> Self {
        let place = |i: usize| (i as f32 + 0.5) / points as f32;
        let lanes = |first: usize| {
            let azimuth = std::array::from_fn(|lane| (PI * place(first + lane)).cos());
            [azimuth, std::array::from_fn(|lane| place((first + lane) * generator % points))]
        };
        Self((0..points).step_by(LANES).map(lanes).collect())
    }

    #[inline(always)]
    fn mean<const N: usize>(&self, value: impl Fn(f32, f32) -> [f32; N]) -> [f64; N] {
        let mut sums = [[0.0f32; LANES]; N];
        for [azimuths, heights] in &self.0 {
            for lane in 0..LANES {
                let values = value(azimuths[lane], heights[lane]);
                for k in 0..N {
                    sums[k][lane] += values[k];
                }
            }
        }
        sums.map(|lanes| lanes.iter().map(|&sum| f64::from(sum)).sum::<f64>() / (LANES * self.0.len()) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_have_the_size_that_the_shader_indexes_and_hold_albedos() {
        let ggx = 2 * ROUGHNESSES * (COSINES + 1);
        let glass = 3 * GLASS_IORS * GLASS_ROUGHNESSES * (GLASS_COSINES + 1);
        assert_eq!(energy_tables(false).len(), ggx);
        let tables = energy_tables(true);
        assert_eq!(tables.len(), ggx + glass);
        assert!(tables[..ggx].iter().all(|albedo| (0.0..=1.0001).contains(albedo)));
        assert!(tables[ggx..].chunks(3).all(|k| (0.0..=1.0001).contains(&(k[0] + 0.04 * k[1] + k[2]))));
    }

    #[test]
    fn a_mirror_loses_nothing_and_the_loss_grows_with_roughness() {
        let tables = energy_tables(false);
        let averages: Vec<f32> = tables[2 * ROUGHNESSES * COSINES..].chunks(2).map(|pair| pair[0]).collect();
        assert_eq!(averages[0], 1.0);
        assert!(averages.windows(2).all(|pair| pair[1] < pair[0] + 1e-3), "{averages:?}");
    }

    /// The constants that both sides state.
    #[test]
    fn the_shader_states_the_same_sizes() {
        let glsl = include_str!("../../shaders_glsl/lib/energy.glsl");
        for (name, value) in [
            ("COSINES", COSINES),
            ("ROUGHNESSES", ROUGHNESSES),
            ("GLASS_COSINES", GLASS_COSINES),
            ("GLASS_ROUGHNESSES", GLASS_ROUGHNESSES),
            ("GLASS_IORS", GLASS_IORS),
        ] {
            assert!(glsl.contains(&format!("const uint {name} = {value}u;")), "{name}");
        }
        assert!(glsl.contains(&format!("const float GLASS_IOR_RANGE = {GLASS_IOR_RANGE:.10};")));
    }
}
