//! Which effects a scene calls for, and why: what is not in the set is compiled out of every shader (specialization constants of
//! shaders_glsl/shared/effects.glsl).
//!
//! The set is conservative: it may hold an effect that changes no pixel, and never lacks one that does. Only what an instance shows
//! counts; a texture counts where its factor lets it through.

use super::{AlphaMode, Environment, LightKind, Material, Mesh, Scene, TextureRef};

/// GGX lobes with alpha (roughness squared) below this are delta lobes: perfectly specular, never evaluated, only sampled. The lobe's
/// half-width is then under 0.06 degrees, less than a pixel; pbrt-v4 draws the same line. The shaders': lib/microfacet.glsl.
pub const MIRROR_ALPHA: f32 = 1e-3;

/// Indices of refraction closer than this count as equal: lib/fresnel.glsl.
const LEAST_REFRACTION: f32 = 1e-3;

/// One specialization constant each: its id is the variant's place, its name `EFFECT_` and [`Effect::name`] in capitals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Effect {
    Glossy,
    Mirror,
    SmoothTransmission,
    RoughTransmission,
    Clearcoat,
    Textures,
    NormalMaps,
    AlphaMask,
    AlphaBlend,
    PunctualLight,
    SphereLight,
    EmissiveLight,
    EnvironmentLight,
    CameraAnimation,
    ObjectAnimation,
    Unlit,
    VertexColors,
    SoleLight,
}

impl Effect {
    pub const ALL: [Effect; 18] = [
        Effect::Glossy,
        Effect::Mirror,
        Effect::SmoothTransmission,
        Effect::RoughTransmission,
        Effect::Clearcoat,
        Effect::Textures,
        Effect::NormalMaps,
        Effect::AlphaMask,
        Effect::AlphaBlend,
        Effect::PunctualLight,
        Effect::SphereLight,
        Effect::EmissiveLight,
        Effect::EnvironmentLight,
        Effect::CameraAnimation,
        Effect::ObjectAnimation,
        Effect::Unlit,
        Effect::VertexColors,
        Effect::SoleLight,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Effect::Glossy => "glossy",
            Effect::Mirror => "mirror",
            Effect::SmoothTransmission => "smooth transmission",
            Effect::RoughTransmission => "rough transmission",
            Effect::Clearcoat => "clearcoat",
            Effect::Textures => "textures",
            Effect::NormalMaps => "normal maps",
            Effect::AlphaMask => "alpha mask",
            Effect::AlphaBlend => "alpha blend",
            Effect::PunctualLight => "punctual light",
            Effect::SphereLight => "sphere light",
            Effect::EmissiveLight => "emissive light",
            Effect::EnvironmentLight => "environment light",
            Effect::CameraAnimation => "camera animation",
            Effect::ObjectAnimation => "object animation",
            Effect::Unlit => "unlit",
            Effect::VertexColors => "vertex colors",
            Effect::SoleLight => "sole light",
        }
    }

    pub fn constant_id(self) -> u32 {
        self as u32
    }

    /// Changes how a surface scatters light, other than Lambert reflection does.
    fn scatters(self) -> bool {
        use Effect::*;
        matches!(self, Glossy | Mirror | SmoothTransmission | RoughTransmission | Clearcoat | Unlit)
    }
}

/// Effects in the order of [`Effect::ALL`], each with the reason why it is on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EffectSet {
    reasons: Vec<(Effect, String)>,
}

impl EffectSet {
    /// What `scene` calls for.
    pub fn derive(scene: &Scene) -> Self {
        let uses = visible_uses(scene);
        let reason = |effect| {
            reason_in_materials(scene, &uses, effect)
                .or_else(|| reason_in_lights(scene, effect))
                .or_else(|| reason_in_motion(scene, effect))
        };
        Self { reasons: Effect::ALL.into_iter().filter_map(|effect| Some((effect, reason(effect)?))).collect() }
    }

    /// Everything on, as `--effects all` asks: the picture is the same, the time is not.
    pub fn all() -> Self {
        Self { reasons: Effect::ALL.into_iter().map(|effect| (effect, "asked for".to_owned())).collect() }
    }

    pub fn contains(&self, effect: Effect) -> bool {
        self.reasons.iter().any(|(on, _)| *on == effect)
    }

    pub fn iter(&self) -> impl Iterator<Item = (Effect, &str)> {
        self.reasons.iter().map(|(effect, reason)| (*effect, reason.as_str()))
    }

    /// No surface does anything but reflect diffusely.
    pub fn is_diffuse_only(&self) -> bool {
        !self.reasons.iter().any(|(effect, _)| effect.scatters())
    }

    /// (constant id, 0 or 1) of every effect.
    pub fn specialization(&self) -> Vec<(u32, u32)> {
        Effect::ALL.into_iter().map(|effect| (effect.constant_id(), u32::from(self.contains(effect)))).collect()
    }
}

/// A material on some triangles of a mesh that an instance shows.
struct Use<'a> {
    material: &'a Material,
    lobes: Lobes,
    mesh: &'a Mesh,
    node: &'a str,
}

/// Each (mesh, material) pair that is in the picture, named by the first node that shows it.
fn visible_uses(scene: &Scene) -> Vec<Use<'_>> {
    let mut mesh_is_done = vec![false; scene.meshes.len()];
    let mut lobes: Vec<Option<Lobes>> = vec![None; scene.materials.len()];
    let mut uses = Vec::new();
    for instance in &scene.instances {
        if std::mem::replace(&mut mesh_is_done[instance.mesh as usize], true) {
            continue;
        }
        let mesh = &scene.meshes[instance.mesh as usize];
        let mut is_used = vec![false; scene.materials.len()];
        mesh.triangle_materials.iter().for_each(|&material| is_used[material as usize] = true);
        for i in (0..is_used.len()).filter(|&i| is_used[i]) {
            let material = &scene.materials[i];
            let lobes = *lobes[i].get_or_insert_with(|| Lobes::of(material, scene));
            uses.push(Use { material, lobes, mesh, node: &scene.nodes[instance.node as usize].name });
        }
    }
    uses
}

/// What a material's factors and textures let through at most.
#[derive(Debug, Clone, Copy)]
struct Lobes {
    reflects: bool,
    transmits: bool,
    has_coat: bool,
    emits: bool,
    /// Transmits without bending the light, whatever its roughness: refraction into the same medium has no lobe.
    is_straight: bool,
    /// Smallest and largest GGX alpha over the surface.
    alpha: [f32; 2],
}

impl Lobes {
    fn of(material: &Material, scene: &Scene) -> Self {
        let [red, green, blue, alpha] = [0, 1, 2, 3];
        let range = |texture: Option<TextureRef>, channel: usize, factor: f32| channel_range(scene, texture, channel).map(|x| x * factor);
        let metallic_roughness = material.metallic_roughness_texture;
        let metallic = range(metallic_roughness, blue, material.metallic);
        let roughness = range(metallic_roughness, green, material.roughness);
        let [_, specular] = range(material.specular_texture, alpha, material.specular);
        let transmission = range(material.transmission_texture, red, material.transmission);
        let [_, clearcoat] = range(material.clearcoat_texture, red, material.clearcoat);
        let emission = |channel: usize| range(material.emission_texture, channel, material.emission[channel])[1];
        Self {
            reflects: !material.unlit && (metallic[1] > 0.0 || (specular > 0.0 && transmission[0] < 1.0)),
            transmits: !material.unlit && transmission[1] > 0.0 && metallic[0] < 1.0,
            has_coat: !material.unlit && clearcoat > 0.0,
            emits: [red, green, blue].into_iter().any(|channel| emission(channel) > 0.0),
            is_straight: material.thickness > 0.0 && (material.ior - 1.0).abs() < 2.0 * LEAST_REFRACTION,
            alpha: roughness.map(|r| r * r),
        }
    }

    fn is_partly_smooth(&self) -> bool {
        self.alpha[0] < MIRROR_ALPHA
    }

    fn is_partly_rough(&self) -> bool {
        self.alpha[1] >= MIRROR_ALPHA
    }
}

/// Smallest and largest value, 0 to 1, of a channel; its mip levels lie in between.
fn channel_range(scene: &Scene, texture: Option<TextureRef>, channel: usize) -> [f32; 2] {
    let Some(texture) = texture else { return [1.0; 2] };
    let texels = &scene.textures[texture.texture as usize].mips[0];
    let [low, high] =
        texels.chunks_exact(4).fold([255, 0], |[low, high]: [u8; 2], texel| [low.min(texel[channel]), high.max(texel[channel])]);
    [low, high].map(|value| f32::from(value) / 255.0)
}

fn reason_in_materials(scene: &Scene, uses: &[Use], effect: Effect) -> Option<String> {
    let calls_for = |used: &&Use| match effect {
        Effect::Glossy => used.lobes.reflects && used.lobes.is_partly_rough(),
        Effect::Mirror => used.lobes.reflects && used.lobes.is_partly_smooth(),
        Effect::SmoothTransmission => used.lobes.transmits && (used.lobes.is_partly_smooth() || used.lobes.is_straight),
        Effect::RoughTransmission => used.lobes.transmits && used.lobes.is_partly_rough(),
        Effect::Clearcoat => used.lobes.has_coat,
        Effect::Textures => reads_a_texture(used),
        Effect::NormalMaps => has_normal_map(used),
        Effect::AlphaMask => matches!(used.material.alpha_mode, AlphaMode::Mask { cutoff } if least_alpha(scene, used) < cutoff),
        Effect::AlphaBlend => used.material.alpha_mode == AlphaMode::Blend && least_alpha(scene, used) < 1.0,
        Effect::EmissiveLight => used.lobes.emits,
        Effect::Unlit => used.material.unlit,
        Effect::VertexColors => used.mesh.colors.iter().any(|color| *color != [1.0; 4]),
        _ => false,
    };
    let used = uses.iter().find(calls_for)?;
    Some(match effect {
        Effect::VertexColors => format!("mesh '{}' used by node '{}'", used.mesh.name, used.node),
        _ => format!("material '{}' used by node '{}'", used.material.name, used.node),
    })
}

/// Some texture of the material can change what is seen.
fn reads_a_texture(used: &Use) -> bool {
    let (m, lobes) = (used.material, used.lobes);
    let has_color = m.base_color[..3].iter().any(|&x| x > 0.0);
    let has_specular = !m.unlit && m.specular > 0.0;
    let read = [
        (m.base_color_texture, has_color || m.alpha_mode != AlphaMode::Opaque),
        (m.metallic_roughness_texture, !m.unlit && (m.metallic > 0.0 || m.roughness > 0.0)),
        (m.emission_texture, m.is_emissive()),
        (m.specular_texture, has_specular),
        (m.specular_color_texture, has_specular),
        (m.transmission_texture, !m.unlit && m.transmission > 0.0),
        (m.clearcoat_texture, lobes.has_coat),
        (m.clearcoat_roughness_texture, lobes.has_coat && m.clearcoat_roughness > 0.0),
    ];
    has_normal_map(used) || read.iter().any(|(texture, counts)| texture.is_some() && *counts)
}

fn has_normal_map(used: &Use) -> bool {
    let m = used.material;
    (!m.unlit && m.normal_texture.is_some() && m.normal_scale != 0.0) || (used.lobes.has_coat && m.clearcoat_normal_texture.is_some())
}

fn least_alpha(scene: &Scene, used: &Use) -> f32 {
    let vertices = used.mesh.colors.iter().map(|color| color[3]).fold(1.0, f32::min);
    used.material.base_color[3] * vertices * channel_range(scene, used.material.base_color_texture, 3)[0]
}

fn reason_in_lights(scene: &Scene, effect: Effect) -> Option<String> {
    let shines = |color: [f32; 3]| color.iter().any(|&x| x > 0.0);
    let light_that = |is_kind: fn(LightKind) -> bool| {
        let light = scene.lights.iter().find(|light| is_kind(light.kind) && shines(light.color))?;
        Some(format!("light '{}' at node '{}'", light.name, scene.nodes[light.node as usize].name))
    };
    match effect {
        Effect::PunctualLight => light_that(|kind| !matches!(kind, LightKind::Sphere { .. })),
        Effect::SoleLight => {
            let light = &scene.lights[super::lights::sole_light(scene)? as usize];
            Some(format!("light '{}', the only one without a size", light.name))
        }
        Effect::SphereLight => light_that(|kind| matches!(kind, LightKind::Sphere { .. })),
        Effect::EnvironmentLight => match &scene.environment {
            Environment::Constant(radiance) => shines(*radiance).then(|| "constant environment".to_owned()),
            Environment::Map { width, height, pixels } => {
                pixels.iter().any(|&p| shines(p)).then(|| format!("environment map of {width}x{height}"))
            }
        },
        _ => None,
    }
}

fn reason_in_motion(scene: &Scene, effect: Effect) -> Option<String> {
    if scene.animation.is_empty() {
        return None;
    }
    let moving = scene.animation.moving_nodes(&scene.nodes);
    let moves = |node: &u32| moving[*node as usize];
    let node = match effect {
        Effect::CameraAnimation => scene.cameras.iter().map(|camera| camera.node).find(moves),
        Effect::ObjectAnimation => {
            let lights = scene.lights.iter().map(|light| light.node);
            scene.instances.iter().map(|instance| instance.node).chain(lights).find(moves)
        }
        _ => None,
    };
    Some(format!("node '{}' moves", scene.nodes[node? as usize].name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glsl(file: &str) -> String {
        std::fs::read_to_string(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders_glsl").join(file)).unwrap()
    }

    #[test]
    fn every_effect_is_the_constant_of_its_name_and_id_and_no_other_exists() {
        let text = glsl("shared/effects.glsl");
        for effect in Effect::ALL {
            let name = effect.name().to_uppercase().replace(' ', "_");
            let line = format!("layout(constant_id = {}) const bool EFFECT_{name} = true;", effect.constant_id());
            assert!(text.contains(&line), "{line}");
        }
        assert_eq!(text.matches("constant_id").count(), Effect::ALL.len());
    }

    #[test]
    fn limits_are_those_of_the_shaders() {
        assert!(glsl("lib/microfacet.glsl").contains(&format!("const float MIRROR_ALPHA = {MIRROR_ALPHA:e};")));
        assert!(glsl("lib/fresnel.glsl").contains(&format!("const float LEAST_REFRACTION = {LEAST_REFRACTION:e};")));
    }
}
