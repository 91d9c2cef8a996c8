//! glTF 2.0 metallic-roughness materials with the extensions that `scene::gltf` reads. Colours are linear.

/// Factors multiply their textures. Defaults are glTF's.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    pub name: String,
    pub base_color: [f32; 4],
    pub base_color_texture: Option<TextureRef>,
    pub metallic: f32,
    pub roughness: f32,
    /// Metalness in blue, roughness in green.
    pub metallic_roughness_texture: Option<TextureRef>,
    pub normal_scale: f32,
    pub normal_texture: Option<TextureRef>,
    /// Radiance: emissiveFactor x emissiveStrength, W/(sr m^2).
    pub emission: [f32; 3],
    pub emission_texture: Option<TextureRef>,
    pub alpha_mode: AlphaMode,
    pub double_sided: bool,
    pub unlit: bool,
    /// Index of refraction; 0 means infinity (KHR_materials_ior).
    pub ior: f32,
    pub specular: f32,
    /// In alpha.
    pub specular_texture: Option<TextureRef>,
    pub specular_color: [f32; 3],
    pub specular_color_texture: Option<TextureRef>,
    pub transmission: f32,
    /// In red.
    pub transmission_texture: Option<TextureRef>,
    /// KHR_materials_volume: 0 is thin-walled (light passes unrefracted), above 0 the mesh bounds a refracting volume.
    pub thickness: f32,
    /// Metres after which white light has the attenuation colour; infinity: no absorption.
    pub attenuation_distance: f32,
    pub attenuation_color: [f32; 3],
    pub clearcoat: f32,
    /// In red.
    pub clearcoat_texture: Option<TextureRef>,
    pub clearcoat_roughness: f32,
    /// In green.
    pub clearcoat_roughness_texture: Option<TextureRef>,
    pub clearcoat_normal_texture: Option<TextureRef>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AlphaMode {
    Opaque,
    Mask { cutoff: f32 },
    Blend,
}

/// A texture as one material uses it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureRef {
    /// Index into [`super::Scene::textures`].
    pub texture: u32,
    /// 0 or 1.
    pub uv_set: u32,
    /// KHR_texture_transform as a 2x3 matrix, row by row: uv' = (m[0] . (u, v, 1), m[1] . (u, v, 1)).
    pub transform: [[f32; 3]; 2],
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [1.0; 4],
            base_color_texture: None,
            metallic: 1.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            normal_scale: 1.0,
            normal_texture: None,
            emission: [0.0; 3],
            emission_texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            unlit: false,
            ior: 1.5,
            specular: 1.0,
            specular_texture: None,
            specular_color: [1.0; 3],
            specular_color_texture: None,
            transmission: 0.0,
            transmission_texture: None,
            thickness: 0.0,
            attenuation_distance: f32::INFINITY,
            attenuation_color: [1.0; 3],
            clearcoat: 0.0,
            clearcoat_texture: None,
            clearcoat_roughness: 0.0,
            clearcoat_roughness_texture: None,
            clearcoat_normal_texture: None,
        }
    }
}

impl Material {
    /// Radiance is emitted somewhere on it.
    pub fn is_emissive(&self) -> bool {
        self.emission.iter().any(|&e| e > 0.0)
    }
}
