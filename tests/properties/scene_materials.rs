//! Materials and textures as the loader reads them.

use pathspace::scene::{
    AlphaMode, Material, Scene, Texture, TextureRef,
    texture::{Filter, Wrap},
};
use serde_json::{Value, json};

use crate::glb::{Glb, png};

const AS_IT_IS: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// A triangle with one material, and texture 0, half red.
fn scene(material: Value) -> Scene {
    let mut glb = Glb::triangle();
    glb.texture(&png(1, 1, &[128, 0, 0, 255]), "image/png");
    glb.json["materials"] = json!([material]);
    glb.primitive()["material"] = json!(0);
    glb.load().unwrap()
}

#[test]
fn an_empty_material_is_the_default_one() {
    assert_eq!(scene(json!({})).materials[0], Material::default());
}

#[test]
fn every_factor_is_read() {
    let material = scene(json!({
        "name": "all", "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true, "emissiveFactor": [1.0, 0.5, 0.0],
        "pbrMetallicRoughness": { "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.6 },
        "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": 8.0 }, "KHR_materials_ior": { "ior": 1.33 },
            "KHR_materials_specular": { "specularFactor": 0.7, "specularColorFactor": [0.1, 2.0, 0.3] },
            "KHR_materials_transmission": { "transmissionFactor": 0.8 }, "KHR_materials_unlit": {},
            "KHR_materials_volume": { "thicknessFactor": 0.01, "attenuationDistance": 2.0, "attenuationColor": [0.5, 0.6, 0.7] },
            "KHR_materials_clearcoat": { "clearcoatFactor": 0.9, "clearcoatRoughnessFactor": 0.3 },
        },
    }));
    let expected = Material {
        name: "all".into(),
        base_color: [0.1, 0.2, 0.3, 0.4],
        metallic: 0.5,
        roughness: 0.6,
        emission: [8.0, 4.0, 0.0],
        alpha_mode: AlphaMode::Mask { cutoff: 0.25 },
        double_sided: true,
        unlit: true,
        ior: 1.33,
        specular: 0.7,
        specular_color: [0.1, 2.0, 0.3],
        transmission: 0.8,
        thickness: 0.01,
        attenuation_distance: 2.0,
        attenuation_color: [0.5, 0.6, 0.7],
        clearcoat: 0.9,
        clearcoat_roughness: 0.3,
        ..Material::default()
    };
    assert_eq!(material.materials[0], expected);
    assert!(material.warnings.is_empty());
}

#[test]
fn colour_and_data_of_one_image_are_two_textures_and_equal_uses_share_one() {
    let info = json!({ "index": 0 });
    let loaded = scene(json!({
        "emissiveFactor": [1.0, 1.0, 1.0], "emissiveTexture": info, "normalTexture": { "index": 0, "scale": 0.5, "texCoord": 1 },
        "pbrMetallicRoughness": { "baseColorTexture": info, "metallicRoughnessTexture": info },
        "extensions": {
            "KHR_materials_specular": { "specularTexture": info, "specularColorTexture": info },
            "KHR_materials_transmission": { "transmissionTexture": info },
            "KHR_materials_clearcoat": { "clearcoatTexture": info, "clearcoatRoughnessTexture": info, "clearcoatNormalTexture": info },
        },
    }));
    let material = &loaded.materials[0];
    let texture = |reference: &Option<TextureRef>| &loaded.textures[reference.unwrap().texture as usize];
    for color in [&material.base_color_texture, &material.emission_texture, &material.specular_color_texture] {
        assert!(texture(color).srgb);
        assert_eq!(color.unwrap(), material.base_color_texture.unwrap());
    }
    let data = [
        &material.metallic_roughness_texture,
        &material.specular_texture,
        &material.transmission_texture,
        &material.clearcoat_texture,
        &material.clearcoat_roughness_texture,
    ];
    assert!(data.iter().all(|data| !texture(data).srgb && **data == material.metallic_roughness_texture));
    assert!(!texture(&material.clearcoat_normal_texture).srgb && material.normal_scale == 0.5);
    assert_eq!(material.normal_texture.unwrap().uv_set, 1);
    assert_eq!(texture(&material.base_color_texture).mips, [vec![128, 0, 0, 255]]);
    assert!(loaded.textures.len() <= 3);
}

#[test]
fn texture_transforms_move_turn_and_scale_as_the_extension_defines() {
    let loaded = |transform: Value| {
        let info = json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
        scene(json!({ "pbrMetallicRoughness": { "baseColorTexture": info } })).materials[0].base_color_texture.unwrap()
    };
    assert_eq!(loaded(json!({})), TextureRef { texture: 0, uv_set: 0, transform: AS_IT_IS });
    let moved = loaded(json!({ "offset": [0.5, 0.25], "scale": [2.0, 4.0], "texCoord": 1 }));
    assert_eq!(moved, TextureRef { texture: 0, uv_set: 1, transform: [[2.0, 0.0, 0.5], [0.0, 4.0, 0.25]] });
    let turned = loaded(json!({ "offset": [0.0, 1.0], "rotation": std::f32::consts::FRAC_PI_2, "scale": [0.5, 0.25] }));
    assert_eq!(turned.transform, [[0.0, 0.25, 0.0], [-0.5, 0.0, 1.0]]);
}

#[test]
fn samplers_wrap_and_filter() {
    let mut glb = Glb::triangle();
    let texture = glb.texture(&png(1, 1, &[1, 2, 3, 4]), "image/png");
    glb.json["samplers"] = json!([{ "wrapS": 33071, "wrapT": 33648, "magFilter": 9728 }]);
    glb.json["textures"][0]["sampler"] = json!(0);
    glb.json["materials"] = json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": texture } } }]);
    let loaded = &glb.load().unwrap().textures[0];
    assert_eq!((loaded.wrap, loaded.filter), ([Wrap::Clamp, Wrap::Mirror], Filter::Nearest));
}

#[test]
fn images_in_files_and_data_uris_are_the_same_as_in_the_buffer() {
    let folder = tempfile::tempdir().unwrap();
    let image = png(2, 1, &[10, 20, 30, 40, 50, 60, 70, 80]);
    std::fs::write(folder.path().join("a picture.png"), &image).unwrap();
    let data_uri = format!("data:image/png;base64,{}", base64::Engine::encode(&base64::engine::general_purpose::STANDARD, &image));
    let mut glb = Glb::triangle();
    let texture = glb.texture(&image, "image/png");
    glb.json["materials"] = json!([{ "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": texture } } }]);
    for source in [glb.json["images"][0].clone(), json!({ "uri": "a%20picture.png" }), json!({ "uri": data_uri })] {
        glb.json["images"][0] = source;
        let scene = pathspace::scene::gltf::load_slice(&glb.bytes(), Some(folder.path()), "test").unwrap();
        assert_eq!(scene.textures[0].mips, [vec![10, 20, 30, 40, 50, 60, 70, 80], vec![30, 40, 50, 60]]);
    }
}

#[test]
fn factors_outside_their_ranges_are_clamped_and_counted() {
    let loaded = scene(json!({
        "pbrMetallicRoughness": { "baseColorFactor": [2.0, -1.0, 0.5, 1.0], "roughnessFactor": 3.0 },
        "emissiveFactor": [1e39, -1.0, 1.0], "extensions": { "KHR_materials_ior": { "ior": 0.5 } },
    }));
    let material = &loaded.materials[0];
    assert_eq!((material.base_color, material.roughness, material.ior), ([1.0, 0.0, 0.5, 1.0], 1.0, 1.5));
    assert_eq!(material.emission, [0.0, 0.0, 1.0]);
    assert_eq!(loaded.warnings.len(), 1);
}

#[test]
fn specular_glossiness_becomes_a_dielectric_of_infinite_index_of_refraction() {
    let factors = json!({ "diffuseFactor": [0.1, 0.2, 0.3, 1.0], "specularFactor": [0.4, 0.5, 0.6], "glossinessFactor": 0.75 });
    let loaded = scene(json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": factors } }));
    let expected = Material {
        base_color: [0.1, 0.2, 0.3, 1.0],
        specular_color: [0.4, 0.5, 0.6],
        roughness: 0.25,
        metallic: 0.0,
        ior: 0.0,
        ..Material::default()
    };
    assert_eq!(loaded.materials[0], expected);
}

/// Mean of a level in linear light.
fn mean(texture: &Texture, level: usize) -> [f64; 4] {
    let linear = |code: f64| if code <= 0.04045 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) };
    let texels = texture.mips[level].as_chunks::<4>().0;
    std::array::from_fn(|channel| {
        let value = |texel: &[u8; 4]| f64::from(texel[channel]) / 255.0;
        let light = |texel| if texture.srgb && channel < 3 { linear(value(texel)) } else { value(texel) };
        texels.iter().map(light).sum::<f64>() / texels.len() as f64
    })
}

#[test]
fn mip_levels_keep_the_mean_in_linear_light_at_every_size() {
    for (width, height) in [(1, 1), (2, 2), (8, 4), (7, 5), (1, 9), (37, 64), (3, 1)] {
        let pixels: Vec<u8> = (0..width * height * 4).map(|i: u32| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
        for srgb in [true, false] {
            let texture = Texture::new("noise".into(), [width, height], pixels.clone(), srgb, Default::default());
            assert_eq!(texture.mips.len() as u32, width.max(height).ilog2() + 1);
            for level in 0..texture.mips.len() {
                let size = (width >> level).max(1) * (height >> level).max(1) * 4;
                assert_eq!(texture.mips[level].len() as u32, size);
                for (mean, whole) in mean(&texture, level).into_iter().zip(mean(&texture, 0)) {
                    // Rounding to 8 bits: half a code, at most 0.0088 / 2 of linear light near white.
                    assert!((mean - whole).abs() <= 0.0045, "{width}x{height} level {level}: {mean} instead of {whole}");
                }
            }
        }
    }
}

#[test]
fn black_and_white_average_to_half_the_light_not_half_the_code() {
    let checks = [[0u8, 0, 0, 255], [255; 4], [255; 4], [0, 0, 0, 255]].concat();
    let level = |srgb: bool| Texture::new("checks".into(), [2, 2], checks.clone(), srgb, Default::default()).mips[1].clone();
    assert_eq!((level(true), level(false)), (vec![188, 188, 188, 255], vec![128, 128, 128, 255]));
}

#[test]
fn a_uniform_texture_stays_exactly_uniform() {
    for code in 0..=255u8 {
        let texture = Texture::new("flat".into(), [5, 3], [code; 60].to_vec(), true, Default::default());
        assert!(texture.mips.iter().flatten().all(|&texel| texel == code), "code {code}");
    }
}
