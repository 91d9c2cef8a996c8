//! Materials with their extensions.

use std::f32::consts::FRAC_PI_2;

use gltf::json::{
    Index, Root,
    extensions::texture::TextureTransform,
    material::{AlphaMode as JsonAlphaMode, Material as Json},
    texture::Info,
};
use serde::Deserialize;

use super::{
    document::label,
    images::{Role, Textures},
    warnings::Warnings,
};
use crate::scene::{AlphaMode, Material, Problem, TextureRef};

/// KHR_materials_clearcoat, which the JSON library does not know.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Clearcoat {
    clearcoat_factor: f32,
    clearcoat_texture: Option<Info>,
    clearcoat_roughness_factor: f32,
    clearcoat_roughness_texture: Option<Info>,
    clearcoat_normal_texture: Option<Info>,
}

/// KHR_materials_pbrSpecularGlossiness, archived but still required by files.
#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct SpecularGlossiness {
    diffuse_factor: [f32; 4],
    diffuse_texture: Option<Info>,
    specular_factor: [f32; 3],
    glossiness_factor: f32,
    specular_glossiness_texture: Option<Info>,
}

impl Default for SpecularGlossiness {
    fn default() -> Self {
        Self {
            diffuse_factor: [1.0; 4],
            diffuse_texture: None,
            specular_factor: [1.0; 3],
            glossiness_factor: 1.0,
            specular_glossiness_texture: None,
        }
    }
}

pub(super) struct Reader<'a> {
    pub root: &'a Root,
    pub textures: &'a mut Textures,
    pub warnings: &'a mut Warnings,
}

impl Reader<'_> {
    /// The file's materials, and glTF's default one after them.
    pub fn read_all(&mut self) -> Result<Vec<Material>, Problem> {
        let root = self.root;
        let mut materials = Vec::with_capacity(root.materials.len() + 1);
        for (index, json) in root.materials.iter().enumerate() {
            let place = label("material", Index::<Json>::new(index as u32), &json.name);
            let material = self.read(json).map_err(|what| Problem::invalid(&place, what))?;
            materials.push(self.bounded(material, &place));
        }
        materials.push(Material { name: "default".into(), ..Material::default() });
        Ok(materials)
    }

    fn read(&mut self, json: &Json) -> Result<Material, String> {
        let surface = &json.pbr_metallic_roughness;
        let mut material = Material {
            name: json.name.clone().unwrap_or_default(),
            base_color: surface.base_color_factor.0,
            base_color_texture: self.texture(&surface.base_color_texture, Role::Color)?,
            metallic: surface.metallic_factor.0,
            roughness: surface.roughness_factor.0,
            metallic_roughness_texture: self.texture(&surface.metallic_roughness_texture, Role::Data)?,
            emission: json.emissive_factor.0,
            emission_texture: self.texture(&json.emissive_texture, Role::Color)?,
            alpha_mode: alpha_mode(json),
            double_sided: json.double_sided,
            ..Material::default()
        };
        if let Some(normal) = &json.normal_texture {
            let transform = normal.extensions.as_ref().and_then(|extensions| extensions.others.get("KHR_texture_transform"));
            let transform = transform.map(|value| TextureTransform::deserialize(value).map_err(|error| error.to_string())).transpose()?;
            material.normal_scale = normal.scale;
            material.normal_texture = Some(self.reference(normal.index, normal.tex_coord, transform.as_ref(), Role::Normal)?);
        }
        self.read_extensions(json, &mut material)?;
        Ok(material)
    }

    fn read_extensions(&mut self, json: &Json, material: &mut Material) -> Result<(), String> {
        let Some(extensions) = &json.extensions else { return Ok(()) };
        material.unlit = extensions.unlit.is_some();
        material.ior = extensions.ior.as_ref().map_or(material.ior, |ior| ior.ior.0);
        if let Some(strength) = &extensions.emissive_strength {
            material.emission = material.emission.map(|emission| emission * strength.emissive_strength.0);
        }
        if let Some(specular) = &extensions.specular {
            material.specular = specular.specular_factor.0;
            material.specular_texture = self.texture(&specular.specular_texture, Role::Data)?;
            material.specular_color = specular.specular_color_factor.0;
            material.specular_color_texture = self.texture(&specular.specular_color_texture, Role::Color)?;
        }
        if let Some(transmission) = &extensions.transmission {
            material.transmission = transmission.transmission_factor.0;
            material.transmission_texture = self.texture(&transmission.transmission_texture, Role::Data)?;
        }
        if let Some(volume) = &extensions.volume {
            material.thickness = volume.thickness_factor.0;
            material.attenuation_distance = volume.attenuation_distance.0;
            material.attenuation_color = volume.attenuation_color.0;
            let textured = usize::from(volume.thickness_texture.is_some());
            self.warnings.add_count("thickness textures ignored: paths measure the thickness itself", textured);
        }
        if let Some(value) = extensions.others.get("KHR_materials_clearcoat") {
            let clearcoat = Clearcoat::deserialize(value).map_err(|error| format!("KHR_materials_clearcoat: {error}"))?;
            self.read_clearcoat(&clearcoat, material)?;
        }
        if let Some(value) = extensions.others.get("KHR_materials_pbrSpecularGlossiness") {
            let surface =
                SpecularGlossiness::deserialize(value).map_err(|error| format!("KHR_materials_pbrSpecularGlossiness: {error}"))?;
            self.read_specular_glossiness(&surface, material)?;
        }
        Ok(())
    }

    /// The same surface as a dielectric of infinite index of refraction, whose reflectance at normal incidence is the specular colour
    /// (KHR_materials_ior, "Implementation": what its index 0 is for).
    fn read_specular_glossiness(&mut self, surface: &SpecularGlossiness, material: &mut Material) -> Result<(), String> {
        (material.metallic, material.ior, material.roughness) = (0.0, 0.0, 1.0 - surface.glossiness_factor);
        material.metallic_roughness_texture = None;
        material.base_color = surface.diffuse_factor;
        material.base_color_texture = self.texture(&surface.diffuse_texture, Role::Color)?;
        material.specular_color = surface.specular_factor;
        material.specular_color_texture = self.texture(&surface.specular_glossiness_texture, Role::Color)?;
        let textured = usize::from(surface.specular_glossiness_texture.is_some());
        self.warnings.add_count("glossiness textures ignored: their factor is used", textured);
        Ok(())
    }

    fn read_clearcoat(&mut self, clearcoat: &Clearcoat, material: &mut Material) -> Result<(), String> {
        material.clearcoat = clearcoat.clearcoat_factor;
        material.clearcoat_texture = self.texture(&clearcoat.clearcoat_texture, Role::Data)?;
        material.clearcoat_roughness = clearcoat.clearcoat_roughness_factor;
        material.clearcoat_roughness_texture = self.texture(&clearcoat.clearcoat_roughness_texture, Role::Data)?;
        material.clearcoat_normal_texture = self.texture(&clearcoat.clearcoat_normal_texture, Role::Normal)?;
        Ok(())
    }

    fn texture(&mut self, info: &Option<Info>, role: Role) -> Result<Option<TextureRef>, String> {
        let Some(info) = info else { return Ok(None) };
        let transform = info.extensions.as_ref().and_then(|extensions| extensions.texture_transform.as_ref());
        self.reference(info.index, info.tex_coord, transform, role).map(Some)
    }

    fn reference(
        &mut self,
        index: Index<gltf::json::Texture>,
        tex_coord: u32,
        transform: Option<&TextureTransform>,
        role: Role,
    ) -> Result<TextureRef, String> {
        let json =
            self.root.textures.get(index.value()).ok_or_else(|| format!("refers to texture {}, which does not exist", index.value()))?;
        let mut uv_set = transform.and_then(|transform| transform.tex_coord).unwrap_or(tex_coord);
        if uv_set > 1 {
            self.warnings.add(format!("texture coordinate set {uv_set} is not supported: set 0 used"));
            uv_set = 0;
        }
        let texture = self.textures.request(self.root, index, json, role);
        Ok(TextureRef { texture, uv_set, transform: transform.map_or(IDENTITY, matrix) })
    }

    /// Brings factors into the ranges that glTF allows, where they conserve energy.
    fn bounded(&mut self, mut material: Material, place: &str) -> Material {
        let original = material.clone();
        let unit = |value: f32| if value.is_finite() { value.clamp(0.0, 1.0) } else { 1.0 };
        let positive = |value: f32| if value.is_finite() { value.max(0.0) } else { 0.0 };
        material.base_color = material.base_color.map(unit);
        material.emission = material.emission.map(positive);
        material.specular_color = material.specular_color.map(positive);
        material.attenuation_color = material.attenuation_color.map(unit);
        for factor in [
            &mut material.metallic,
            &mut material.roughness,
            &mut material.specular,
            &mut material.transmission,
            &mut material.clearcoat,
            &mut material.clearcoat_roughness,
        ] {
            *factor = unit(*factor);
        }
        material.thickness = positive(material.thickness);
        material.normal_scale = if material.normal_scale.is_finite() { material.normal_scale } else { 1.0 };
        if material.attenuation_distance <= 0.0 {
            material.attenuation_distance = f32::INFINITY;
        }
        if material.ior != 0.0 && !(1.0..1e4).contains(&material.ior) {
            material.ior = 1.5;
        }
        self.warnings.add_count(format!("factors outside glTF's ranges clamped in {place}"), usize::from(material != original));
        material
    }
}

const IDENTITY: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Translation x rotation x scale (KHR_texture_transform); a rotation turns the picture clockwise, as v points down.
fn matrix(transform: &TextureTransform) -> [[f32; 3]; 2] {
    let ([offset_u, offset_v], [scale_u, scale_v]) = (transform.offset.0, transform.scale.0);
    let (sin, cos) = quarter_exact_sin_cos(transform.rotation.0);
    [[cos * scale_u, sin * scale_v, offset_u], [-sin * scale_u, cos * scale_v, offset_v]]
}

/// Exact zeros and ones at multiples of a right angle, so that texels stay aligned.
fn quarter_exact_sin_cos(angle: f32) -> (f32, f32) {
    let quarters = angle / FRAC_PI_2;
    if (quarters - quarters.round()).abs() > 1e-6 {
        return angle.sin_cos();
    }
    match (quarters.round() as i64).rem_euclid(4) {
        0 => (0.0, 1.0),
        1 => (1.0, 0.0),
        2 => (0.0, -1.0),
        _ => (-1.0, 0.0),
    }
}

fn alpha_mode(json: &Json) -> AlphaMode {
    match json.alpha_mode.as_ref().unwrap() {
        JsonAlphaMode::Opaque => AlphaMode::Opaque,
        JsonAlphaMode::Mask => AlphaMode::Mask { cutoff: json.alpha_cutoff.unwrap_or_default().0 },
        JsonAlphaMode::Blend => AlphaMode::Blend,
    }
}
