//! The set of effects is what a scene shows, not what its file mentions.

use pathspace::scene::effects::{Effect, EffectSet};
use pathspace::scene::texture::{Filter, Wrap};
use pathspace::scene::{
    AlphaMode, Environment, Instance, Light, LightKind, Local, Material, Mesh, Node, Scene, Texture, TextureRef, builtin,
};

/// One triangle of one material: white Lambert, in the dark.
fn scene(change: impl FnOnce(&mut Material)) -> Scene {
    let mut material = Material { name: "paint".into(), metallic: 0.0, specular: 0.0, ..Material::default() };
    change(&mut material);
    let mesh = Mesh {
        name: "sheet".into(),
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        normals: vec![[0.0, 0.0, 1.0]; 3],
        triangles: vec![[0, 1, 2]],
        triangle_materials: vec![0],
        ..Mesh::default()
    };
    Scene {
        meshes: vec![mesh],
        materials: vec![material],
        nodes: vec![Node { name: "wall".into(), parent: None, local: Local::Matrix(glam::DMat4::IDENTITY) }],
        instances: vec![Instance { mesh: 0, node: 0 }],
        ..Scene::default()
    }
}

fn one_texel(texel: [u8; 4]) -> Texture {
    Texture {
        name: "texel".into(),
        width: 1,
        height: 1,
        srgb: false,
        mips: vec![texel.to_vec()],
        wrap: [Wrap::Repeat; 2],
        filter: Filter::Linear,
    }
}

fn texture(index: u32) -> Option<TextureRef> {
    Some(TextureRef { texture: index, uv_set: 0, transform: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] })
}

fn effects(scene: &Scene) -> Vec<Effect> {
    EffectSet::derive(scene).iter().map(|(effect, _)| effect).collect()
}

fn effects_of(change: impl FnOnce(&mut Material)) -> Vec<Effect> {
    effects(&scene(change))
}

#[test]
fn lambert_in_the_dark_calls_for_nothing() {
    let set = EffectSet::derive(&scene(|_| ()));
    assert_eq!(set.iter().count(), 0);
    assert!(set.is_diffuse_only());
    assert!(set.specialization().iter().all(|&(_, on)| on == 0));
}

#[test]
fn roughness_decides_between_glossy_and_mirror() {
    assert_eq!(effects_of(|m| m.metallic = 1.0), [Effect::Glossy]);
    assert_eq!(effects_of(|m| (m.metallic, m.roughness) = (1.0, 0.0)), [Effect::Mirror]);
    assert_eq!(effects_of(|m| (m.specular, m.roughness) = (0.5, 0.5)), [Effect::Glossy]);
}

#[test]
fn a_roughness_texture_calls_for_what_its_darkest_and_brightest_texels_are() {
    let mut scene = scene(|m| (m.metallic, m.metallic_roughness_texture) = (1.0, texture(0)));
    scene.textures = vec![Texture { mips: vec![vec![0, 0, 255, 255, 0, 255, 255, 255]], width: 2, ..one_texel([0; 4]) }];
    assert_eq!(effects(&scene), [Effect::Glossy, Effect::Mirror, Effect::Textures]);
    scene.textures[0].mips[0][1] = 128;
    assert_eq!(effects(&scene), [Effect::Glossy, Effect::Textures]);
}

#[test]
fn glass_calls_for_the_transmission_of_its_roughness_and_for_no_other_reflection() {
    let glass = |roughness: f32| effects_of(|m| (m.transmission, m.specular, m.roughness) = (1.0, 1.0, roughness));
    assert_eq!(glass(0.0), [Effect::SmoothTransmission]);
    assert_eq!(glass(0.4), [Effect::RoughTransmission]);
}

#[test]
fn glass_of_the_index_of_air_bends_no_light_and_is_smooth_too() {
    let straight = effects_of(|m| (m.transmission, m.roughness, m.thickness, m.ior) = (1.0, 0.4, 0.1, 1.0));
    assert_eq!(straight, [Effect::SmoothTransmission, Effect::RoughTransmission]);
}

#[test]
fn metal_lets_no_light_through() {
    assert_eq!(effects_of(|m| (m.metallic, m.transmission) = (1.0, 1.0)), [Effect::Glossy]);
}

#[test]
fn the_reason_names_material_and_node() {
    let scene = scene(|m| (m.transmission, m.roughness, m.name) = (1.0, 0.4, "Glass".into()));
    let set = EffectSet::derive(&scene);
    assert_eq!(set.iter().next(), Some((Effect::RoughTransmission, "material 'Glass' used by node 'wall'")));
}

#[test]
fn what_no_instance_shows_does_not_count() {
    let mut scene = scene(|m| (m.emission, m.metallic) = ([1.0; 3], 1.0));
    assert_eq!(effects(&scene), [Effect::Glossy, Effect::EmissiveLight]);
    scene.instances.clear();
    assert_eq!(effects(&scene), []);
}

#[test]
fn a_texture_whose_factor_is_zero_does_not_count() {
    let mut scene = scene(|m| {
        (m.transmission_texture, m.emission_texture, m.clearcoat_texture, m.specular_texture) =
            (texture(0), texture(0), texture(0), texture(0));
        (m.normal_texture, m.normal_scale) = (texture(0), 0.0);
    });
    scene.textures = vec![one_texel([255; 4])];
    assert_eq!(effects(&scene), []);
}

#[test]
fn a_black_texture_hides_what_its_factor_asks_for() {
    let mut scene = scene(|m| (m.clearcoat, m.clearcoat_texture, m.emission, m.emission_texture) = (1.0, texture(0), [1.0; 3], texture(0)));
    scene.textures = vec![one_texel([0, 0, 0, 255])];
    assert!(!effects(&scene).contains(&Effect::Clearcoat) && !effects(&scene).contains(&Effect::EmissiveLight));
    scene.textures = vec![one_texel([255; 4])];
    assert_eq!(effects(&scene), [Effect::Clearcoat, Effect::Textures, Effect::EmissiveLight]);
}

#[test]
fn normal_maps_are_textures_too() {
    let mut scene = scene(|m| m.normal_texture = texture(0));
    scene.textures = vec![one_texel([128, 128, 255, 255])];
    assert_eq!(effects(&scene), [Effect::Textures, Effect::NormalMaps]);
}

#[test]
fn alpha_counts_where_something_is_seen_through() {
    let mask = |alpha: f32| effects_of(|m| (m.alpha_mode, m.base_color[3]) = (AlphaMode::Mask { cutoff: 0.5 }, alpha));
    assert_eq!((mask(1.0), mask(0.25)), (vec![], vec![Effect::AlphaMask]));
    let blend = |alpha: f32| effects_of(|m| (m.alpha_mode, m.base_color[3]) = (AlphaMode::Blend, alpha));
    assert_eq!((blend(1.0), blend(0.75)), (vec![], vec![Effect::AlphaBlend]));
    assert_eq!(effects_of(|m| m.base_color[3] = 0.25), []);
}

#[test]
fn unlit_surfaces_have_no_lobes() {
    assert_eq!(effects_of(|m| (m.unlit, m.metallic, m.transmission, m.clearcoat) = (true, 1.0, 1.0, 1.0)), [Effect::Unlit]);
}

#[test]
fn vertex_colors_count_unless_they_are_white() {
    let mut scene = scene(|_| ());
    scene.meshes[0].colors = vec![[1.0; 4]; 3];
    assert_eq!(effects(&scene), []);
    scene.meshes[0].colors[1][0] = 0.5;
    assert_eq!(effects(&scene), [Effect::VertexColors]);
}

#[test]
fn lights_count_by_kind_where_they_shine() {
    let lit = |kind: LightKind, color: [f32; 3]| {
        let light = Light { name: "lamp".into(), node: 0, color, kind, range: None };
        effects(&Scene { lights: vec![light], ..scene(|_| ()) })
    };
    assert_eq!(lit(LightKind::Directional, [1.0; 3]), [Effect::PunctualLight, Effect::SoleLight]);
    assert_eq!(lit(LightKind::Sphere { radius: 0.1 }, [1.0; 3]), [Effect::SphereLight]);
    assert_eq!(lit(LightKind::Point, [0.0; 3]), []);
    let light = |kind| Light { name: "lamp".into(), node: 0, color: [1.0; 3], kind, range: None };
    let two = Scene { lights: vec![light(LightKind::Point), light(LightKind::Directional)], ..scene(|_| ()) };
    assert_eq!(effects(&two), [Effect::PunctualLight]);
    assert_eq!(effects(&Scene { environment: Environment::Constant([0.0, 0.1, 0.0]), ..scene(|_| ()) }), [Effect::EnvironmentLight]);
}

#[test]
fn built_in_scenes_call_for_what_they_show() {
    let of = |name: &str| effects(&builtin::find(name).unwrap().unwrap().load().unwrap());
    assert_eq!(of("cornell"), [Effect::EmissiveLight]);
    assert!(EffectSet::derive(&builtin::find("cornell").unwrap().unwrap().load().unwrap()).is_diffuse_only());
    let material = of("material");
    for effect in [Effect::Mirror, Effect::SmoothTransmission, Effect::RoughTransmission, Effect::Clearcoat, Effect::NormalMaps] {
        assert!(material.contains(&effect), "{}", effect.name());
    }
    let hall = of("hall:10000");
    assert!(hall.contains(&Effect::ObjectAnimation) && !hall.contains(&Effect::CameraAnimation));
}

#[test]
fn all_effects_are_all_on() {
    assert!(EffectSet::all().specialization().iter().all(|&(_, on)| on == 1));
    assert_eq!(EffectSet::all().iter().count(), Effect::ALL.len());
}
