//! White furnace: objects that absorb nothing, in an environment of radiance 1 from everywhere. Whatever conserves energy is invisible.

use super::Options;
use super::cornell::lambert;
use super::document::Document;
use super::surface::Surface;
use glam::Vec3;
use serde_json::{Value, json};

pub const ENVIRONMENT: [f32; 3] = [1.0; 3];

/// A row of spheres, far enough apart that light seldom goes from one to another.
pub fn make(_: &Options) -> Vec<u8> {
    let mut document = Document::new("furnace");
    document.set_environment(ENVIRONMENT);
    let sphere = document.add_geometry(&Surface::sphere(0.4, 96, 48));
    let materials = [
        ("Lambert", lambert([1.0; 3])),
        ("dielectric", plain(0.0, 0.5)),
        ("metal", plain(1.0, 0.5)),
        ("mirror", plain(1.0, 0.0)),
        ("glass", glass()),
    ];
    for (i, (name, material)) in materials.into_iter().enumerate() {
        let material = document.add_material(name, material);
        let mesh = document.add_mesh(name, &[(&sphere, material)]);
        document.add_node(json!({ "name": name, "mesh": mesh, "translation": [(i as f32 - 2.0) * 1.2, 0.0, 0.0] }));
    }
    document.add_camera(Vec3::Z * 8.0, Vec3::ZERO, 0.5);
    document.into_glb()
}

fn plain(metallic: f32, roughness: f32) -> Value {
    json!({ "pbrMetallicRoughness": { "metallicFactor": metallic, "roughnessFactor": roughness } })
}

fn glass() -> Value {
    let mut material = plain(0.0, 0.0);
    material["extensions"] = json!({
        "KHR_materials_transmission": { "transmissionFactor": 1.0 },
        "KHR_materials_volume": { "thicknessFactor": 0.8 },
    });
    material
}
