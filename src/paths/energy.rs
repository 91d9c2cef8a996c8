//! Tables for the energy that one bounce between GGX microfacets loses. `shaders_glsl/lib/energy.glsl` says what they are for and reads them.
//!
//! Takes nothing, returns one `Vec<f32>` (about 70 kB) in this order, cosine fastest:
//! - GGX reflection [ROUGHNESSES][COSINES][2]: albedo for F = 1, and for F = Schlick's rise (1 - cos)^5 alone;
//! - their averages over the cosine-weighted hemisphere [ROUGHNESSES][2];
//! - a refracting boundary [GLASS_IORS][GLASS_ROUGHNESSES][GLASS_COSINES][3]: k with albedo = k0 + k1 f0 + k2 f90 of reflection and refraction together;
//! - their averages [GLASS_IORS][GLASS_ROUGHNESSES][3].
//!
//! Axes are uniform in sqrt(cos), in roughness (alpha = roughness^2) and, for the index of refraction, in the signed square root of
//! (eta - 1) / (eta + 1), in which the critical angle's cosine is nearly linear. Integrals are lattice rules over visible normals (Dupuy and
//! Benyoub 2023; for reflection bounded, Eto and Tokuyoshi 2023), so that each sample weighs G2 / G1. Averages integrate the linear interpolant exactly, as shaders will see it:
//! the returned energy is then complete whatever the table's own error.

use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::PI;

pub const COSINES: usize = 32;
pub const ROUGHNESSES: usize = 32;
pub const GLASS_COSINES: usize = 16;
pub const GLASS_ROUGHNESSES: usize = 16;
/// Odd: eta = 1 is a node.
pub const GLASS_IORS: usize = 17;
/// Largest signed square root of (eta - 1) / (eta + 1), up to eta = 3.1, chosen so that eta = 1.5, the usual one, is a node: 8/5 sqrt(1/5).
pub const GLASS_IOR_RANGE: f64 = 0.715_541_752_799_933;

const REFLECTION_LATTICE: Lattice = Lattice { points: 610, generator: 377 };
const BOUNDARY_LATTICE: Lattice = Lattice { points: 377, generator: 233 };

/// Fibonacci lattice of the unit square: point i is (i, i * generator mod points) / points.
struct Lattice {
    points: usize,
    generator: usize,
}

/// The tables, as the shaders index them.
pub fn energy_tables() -> Vec<f32> {
    let ggx = rows(ROUGHNESSES, COSINES, |roughness, cosine| reflected(cosine, roughness * roughness));
    let glass: Vec<Vec<[f64; 3]>> = (0..GLASS_IORS)
        .flat_map(|i| {
            let eta = node_eta(i);
            rows(GLASS_ROUGHNESSES, GLASS_COSINES, move |roughness, cosine| boundary(cosine, roughness * roughness, eta))
        })
        .collect();
    let ggx_averages = ggx.iter().flat_map(|row| average(row));
    let glass_averages = glass.iter().flat_map(|row| average(row));
    let ggx_part = ggx.iter().flatten().flatten().copied().chain(ggx_averages);
    let glass_part = glass.iter().flatten().flatten().copied().chain(glass_averages);
    ggx_part.chain(glass_part).map(|v| v as f32).collect()
}

/// Index of refraction of a node of the third axis.
fn node_eta(i: usize) -> f64 {
    let x = GLASS_IOR_RANGE * (2.0 * i as f64 / (GLASS_IORS - 1) as f64 - 1.0);
    let r = x * x.abs();
    (1.0 + r) / (1.0 - r)
}

/// A row of entries along the cosine for each roughness.
fn rows<const N: usize>(roughnesses: usize, cosines: usize, entry: impl Fn(f64, f64) -> [f64; N] + Sync) -> Vec<Vec<[f64; N]>> {
    (0..roughnesses)
        .into_par_iter()
        .map(|r| {
            let roughness = r as f64 / (roughnesses - 1) as f64;
            (0..cosines).map(|c| entry(roughness, (c as f64 / (cosines - 1) as f64).powi(2))).collect()
        })
        .collect()
}

/// Integral of the row's linear interpolant in x = sqrt(cos) times 2 cos dcos = 4 x^3 dx.
fn average<const N: usize>(row: &[[f64; N]]) -> [f64; N] {
    let step = 1.0 / (row.len() - 1) as f64;
    let mut sum = [0.0; N];
    for (i, pair) in row.windows(2).enumerate() {
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
fn reflected(cosine: f64, alpha: f64) -> [f64; 2] {
    if alpha == 0.0 {
        return [1.0, schlick_rise(cosine)];
    }
    let view = View::new(cosine, alpha);
    let bound = view.reflection_bound();
    let stretched = (alpha * alpha * (1.0 - view.wo.z * view.wo.z) + view.wo.z * view.wo.z).sqrt();
    let scale = (bound * view.wo.z + stretched) / (view.wo.z + stretched);
    view.over_normals(&REFLECTION_LATTICE, bound, |h| {
        let oh = view.wo.dot(h);
        let weight = scale * view.masked((2.0 * oh * h - view.wo).z);
        [weight, weight * schlick_rise(oh)]
    })
}

/// Albedo k0 + k1 f0 + k2 f90 of a boundary to a medium of relative index `eta`, by F = f0 + (f90 - f0) rise, total reflection apart.
fn boundary(cosine: f64, alpha: f64, eta: f64) -> [f64; 3] {
    if alpha == 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let view = View::new(cosine, alpha);
    view.over_normals(&BOUNDARY_LATTICE, 1.0, |h| {
        let oh = view.wo.dot(h);
        let reflection = view.masked((2.0 * oh * h - view.wo).z);
        let sin2 = (1.0 - oh * oh) / (eta * eta);
        if sin2 >= 1.0 {
            return [reflection, 0.0, 0.0];
        }
        let transmitted = (1.0 - sin2).sqrt();
        let refracted = (oh / eta - transmitted) * h - view.wo / eta;
        let transmission = view.masked(-refracted.z);
        let rise = dielectric_rise(oh, transmitted, eta);
        [transmission, (1.0 - rise) * (reflection - transmission), rise * (reflection - transmission)]
    })
}

fn schlick_rise(cosine: f64) -> f64 {
    (1.0 - cosine).clamp(0.0, 1.0).powi(5)
}

fn dielectric_rise(cosine: f64, transmitted: f64, eta: f64) -> f64 {
    let perpendicular = (cosine - eta * transmitted) / (cosine + eta * transmitted);
    let parallel = (eta * cosine - transmitted) / (eta * cosine + transmitted);
    let f0 = ((1.0 - eta) / (1.0 + eta)).powi(2);
    (0.5 * (perpendicular * perpendicular + parallel * parallel) - f0) / (1.0 - f0)
}

/// A direction above a rough surface.
struct View {
    wo: DVec3,
    alpha: f64,
}

impl View {
    fn new(cosine: f64, alpha: f64) -> Self {
        let cosine = cosine.max(1e-4);
        Self { wo: DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine), alpha }
    }

    /// Eto and Tokuyoshi, equation 5.
    fn reflection_bound(&self) -> f64 {
        let (s2, a2) = ((1.0 + self.wo.x).powi(2), self.alpha * self.alpha);
        (1.0 - a2) * s2 / (s2 + a2 * self.wo.z * self.wo.z)
    }

    /// G2 / G1: what masking leaves of light that a visible normal sends to a direction of this cosine.
    fn masked(&self, cos_i: f64) -> f64 {
        if cos_i <= 0.0 {
            return 0.0;
        }
        let lambda = |cosine: f64| 0.5 * ((1.0 + self.alpha * self.alpha * (1.0 / (cosine * cosine) - 1.0)).sqrt() - 1.0);
        (1.0 + lambda(self.wo.z)) / (1.0 + lambda(self.wo.z) + lambda(cos_i))
    }

    /// Mean of a function over visible normals, bounded as lib/microfacet.glsl's; those of positive y stand for both halves.
    fn over_normals<const N: usize>(&self, lattice: &Lattice, bound: f64, value: impl Fn(DVec3) -> [f64; N]) -> [f64; N] {
        let stretched = DVec3::new(self.alpha * self.wo.x, 0.0, self.wo.z).normalize();
        let lower = bound * stretched.z;
        let mut sum = [0.0; N];
        for i in 0..lattice.points {
            let place = |i: usize| (i as f64 + 0.5) / lattice.points as f64;
            let (sin_phi, cos_phi) = (PI * place(i)).sin_cos();
            let z = 1.0 - place(i * lattice.generator % lattice.points) * (1.0 + lower);
            let radius = (1.0 - z * z).max(0.0).sqrt();
            let h = DVec3::new(radius * cos_phi, radius * sin_phi, z) + stretched;
            let h = DVec3::new(self.alpha * h.x, self.alpha * h.y, h.z).normalize();
            for (total, term) in sum.iter_mut().zip(value(h)) {
                *total += term;
            }
        }
        sum.map(|v| v / lattice.points as f64)
    }
}
