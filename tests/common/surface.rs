//! Surfaces for tests of lib/bsdf.glsl: what a kernel needs to make one, and the options that switch the model.
//!
//! Each test binary uses its own part of this.
#![allow(dead_code)]

use crate::common::KernelOptions;
use bytemuck::{Pod, Zeroable};
use pathspace::gpu::{Buffer, Gpu, vk};
use pathspace::paths::energy::energy_tables;
use pathspace::shared::FrameData;

/// glTF's parameters of a surface, and directions: the `Case` of [`CASE`].
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Case {
    pub base_color: [f32; 3],
    pub metallic: f32,
    pub roughness: f32,
    /// 0: infinite.
    pub ior: f32,
    pub specular: f32,
    pub specular_color: [f32; 3],
    pub transmission: f32,
    /// 1: thin-walled.
    pub thin: u32,
    /// 1: seen from within.
    pub inside: u32,
    pub clearcoat: f32,
    pub clearcoat_roughness: f32,
    pub normal: [f32; 3],
    pub geometric_normal: [f32; 3],
    pub wo: [f32; 3],
    pub wi: [f32; 3],
    pub u: [f32; 3],
}

impl Default for Case {
    fn default() -> Self {
        Self {
            base_color: [1.0; 3],
            metallic: 0.0,
            roughness: 1.0,
            ior: 1.5,
            specular: 1.0,
            specular_color: [1.0; 3],
            transmission: 0.0,
            thin: 1,
            inside: 0,
            clearcoat: 0.0,
            clearcoat_roughness: 0.0,
            normal: [0.0, 0.0, 1.0],
            geometric_normal: [0.0, 0.0, 1.0],
            wo: [0.0, 0.0, 1.0],
            wi: [0.0, 0.0, 1.0],
            u: [0.5; 3],
        }
    }
}

impl Case {
    pub fn metal(roughness: f32) -> Self {
        Self { metallic: 1.0, roughness, ..Self::default() }
    }

    pub fn dielectric(roughness: f32, ior: f32) -> Self {
        Self { roughness, ior, ..Self::default() }
    }

    pub fn thin_glass(roughness: f32, ior: f32) -> Self {
        Self { roughness, ior, transmission: 1.0, ..Self::default() }
    }

    pub fn glass(roughness: f32, ior: f32, inside: bool) -> Self {
        Self { roughness, ior, transmission: 1.0, thin: 0, inside: inside.into(), ..Self::default() }
    }

    /// Seen under an angle of this cosine.
    pub fn seen_at(self, cosine: f32) -> Self {
        Self { wo: [(1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine], ..self }
    }
}

/// `Case`, and `surface_of`, which a kernel includes after lib/bsdf.glsl.
pub const CASE: &str = "
#include \"lib/bsdf.glsl\"
struct Case {
    vec3 base_color; float metallic; float roughness; float ior; float specular; vec3 specular_color; float transmission;
    uint thin; uint inside; float clearcoat; float clearcoat_roughness; vec3 normal; vec3 geometric_normal; vec3 wo; vec3 wi; vec3 u;
};
Surface surface_of(Case c) {
    Surface s = surface_default(c.normal);
    s.geometric_normal_ws = c.geometric_normal;
    s.base_color = c.base_color;
    s.metallic = c.metallic;
    s.alpha = c.roughness * c.roughness;
    s.dielectric_f0 = min(f0_from_ior(c.ior) * c.specular_color, 1.0) * c.specular;
    s.dielectric_f90 = c.specular;
    s.transmission = c.transmission;
    s.thin = c.thin != 0u;
    s.eta = relative_ior(c.ior, c.inside == 0u);
    s.clearcoat = c.clearcoat;
    s.clearcoat_alpha = c.clearcoat_roughness * c.clearcoat_roughness;
    return s;
}
";

/// Ids of shaders_glsl/shared/parameters.glsl.
pub const DIFFUSE_MODEL: u32 = 105;
pub const ENERGY_COMPENSATION: u32 = 106;

/// Options with the energy tables, which live as long as the buffer.
pub fn options(gpu: &Gpu, compensated: bool) -> (KernelOptions<'static>, Buffer) {
    let tables = gpu.upload("energy tables", &energy_tables(true), vk::BufferUsageFlags::empty()).unwrap();
    let frame = FrameData { energy_tables: tables.address(), environment_light: u32::MAX, ..Default::default() };
    (KernelOptions { constants: vec![(ENERGY_COMPENSATION, compensated.into())], frame, ..Default::default() }, tables)
}
