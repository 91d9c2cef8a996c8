//! Rows of spheres on a checkered floor, one property of the material changing along each row; and what an independent renderer can
//! reproduce of them by itself: the reflecting rows, the glass.

use super::Options;
use super::document::{Document, Geometry};
use super::picture::{checker, fractal, paint, paint_normals, studs};
use super::surface::Surface;
use glam::{Affine3A, Quat, Vec2, Vec3, vec2, vec3};
use serde_json::{Value, json};
use std::f32::consts::{FRAC_PI_2, PI};

pub const ENVIRONMENT: [f32; 3] = [0.16, 0.2, 0.27];

const RADIUS: f32 = 0.13;
const COLUMNS: usize = 7;
const GOLD: [f32; 3] = [1.0, 0.77, 0.34];
const COPPER: [f32; 3] = [0.95, 0.64, 0.54];
const ENAMEL: [f32; 3] = [0.55, 0.04, 0.05];
const TEAL: [f32; 3] = [0.03, 0.28, 0.32];

/// Name and material of one sphere.
type Sample = (String, Value);

pub fn make(_: &Options) -> Vec<u8> {
    let mut studio = Studio::new("material");
    let studded = studio.studded();
    let [smooth, frosted, milky] = [0.0, 0.25, 0.5].map(glass);
    let specials = [
        ("mirror", metal([0.95; 3], 0.0)),
        ("smooth glass", smooth),
        ("frosted glass", frosted),
        ("studded", studded),
        ("milky glass", milky),
        ("lacquer", lacquer()),
        ("coated gold", coated(metal(GOLD, 0.6))),
    ];
    studio.row(0, specials.map(|(name, material)| (name.to_owned(), material)));
    studio.row(1, dielectric_ramp());
    studio.row(2, metal_ramp());
    studio.row(3, metalness_ramp());
    studio.finish()
}

/// Without glass, coats and textures of data: glTF appendix B, and nothing else.
pub fn make_glossy(_: &Options) -> Vec<u8> {
    let mut studio = Studio::new("material-glossy");
    studio.row(0, dielectric_ramp());
    studio.row(1, metal_ramp());
    studio.row(2, metalness_ramp());
    studio.finish()
}

/// Solid glass, from smooth to rough, on a diffuse floor.
pub fn make_glass(_: &Options) -> Vec<u8> {
    let mut studio = Studio::new("material-glass");
    studio.row(1, std::array::from_fn(|i| (format!("glass {i}"), glass(ramp(i) * 0.6))));
    studio.finish()
}

fn ramp(column: usize) -> f32 {
    column as f32 / (COLUMNS - 1) as f32
}

fn dielectric_ramp() -> [Sample; COLUMNS] {
    std::array::from_fn(|i| (format!("dielectric {i}"), plain(TEAL, 0.0, ramp(i))))
}

fn metal_ramp() -> [Sample; COLUMNS] {
    std::array::from_fn(|i| (format!("gold {i}"), metal(GOLD, ramp(i))))
}

fn metalness_ramp() -> [Sample; COLUMNS] {
    std::array::from_fn(|i| (format!("metalness {i}"), plain(COPPER, ramp(i), 0.3)))
}

fn plain([r, g, b]: [f32; 3], metallic: f32, roughness: f32) -> Value {
    json!({ "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": metallic, "roughnessFactor": roughness } })
}

fn metal(color: [f32; 3], roughness: f32) -> Value {
    plain(color, 1.0, roughness)
}

fn lacquer() -> Value {
    coated(plain(ENAMEL, 0.0, 0.7))
}

fn coated(mut base: Value) -> Value {
    base["extensions"] = json!({ "KHR_materials_clearcoat": { "clearcoatFactor": 1.0, "clearcoatRoughnessFactor": 0.05 } });
    base
}

/// A thickness above zero makes it a solid that refracts.
pub fn glass(roughness: f32) -> Value {
    let mut material = plain([1.0; 3], 0.0, roughness);
    material["extensions"] = json!({
        "KHR_materials_transmission": { "transmissionFactor": 1.0 },
        "KHR_materials_volume": { "thicknessFactor": 2.0 * RADIUS },
    });
    material
}

/// Diffuse material that shows a texture.
pub fn textured(texture: usize) -> Value {
    json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": texture }, "metallicFactor": 0.0, "roughnessFactor": 1.0 },
        "extensions": { "KHR_materials_specular": { "specularFactor": 0.0 } },
    })
}

pub fn lamp(color: [f32; 3], strength: f32) -> Value {
    json!({
        "pbrMetallicRoughness": { "baseColorFactor": [0.0, 0.0, 0.0, 1.0], "metallicFactor": 0.0 },
        "emissiveFactor": color,
        "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": strength },
            "KHR_materials_specular": { "specularFactor": 0.0 },
        },
    })
}

/// The set around the spheres: backdrop, floor, two area lights, camera.
struct Studio {
    document: Document,
    sphere: Geometry,
}

impl Studio {
    fn new(name: &str) -> Self {
        let mut document = Document::new(name);
        document.set_environment(ENVIRONMENT);
        let sphere = document.add_geometry(&Surface::sphere(RADIUS, 96, 48));
        let mut studio = Self { document, sphere };
        studio.add_ground();
        studio.add_lamps();
        studio
    }

    fn add_ground(&mut self) {
        let document = &mut self.document;
        let backdrop = super::cornell::lambert([0.42, 0.4, 0.38]);
        let backdrop = document.add_material("backdrop", backdrop);
        document.add_object("backdrop", &cyclorama(), backdrop);
        let tiles = document.add_texture("tiles", &paint(256, tile_color));
        let tiles = document.add_material("tiles", textured(tiles));
        let floor = Surface::quad([vec3(-1.4, 0.0, 0.4), vec3(1.4, 0.0, 0.4), vec3(1.4, 0.0, -1.65), vec3(-1.4, 0.0, -1.65)]);
        document.add_object("floor", &floor.tiled(vec2(4.0, 2.05 / 0.7)), tiles);
    }

    fn add_lamps(&mut self) {
        let document = &mut self.document;
        let key = document.add_material("key light", lamp([1.0, 0.86, 0.7], 22.0));
        document.add_object("key light", &panel(vec3(-1.3, 2.1, 0.5), vec2(0.9, 0.6)), key);
        let rim = document.add_material("rim light", lamp([0.6, 0.8, 1.0], 14.0));
        document.add_object("rim light", &panel(vec3(2.4, 1.3, -1.2), vec2(0.4, 1.2)), rim);
    }

    /// A sphere with a relief of studs, in a normal map, over brushed steel.
    fn studded(&mut self) -> Value {
        let relief = self.document.add_texture("studs", &paint_normals(256, |uv| studs(uv, 4.0, 0.03)));
        let mut material = metal([0.56, 0.57, 0.58], 0.35);
        material["normalTexture"] =
            json!({ "index": relief, "scale": 0.8, "extensions": { "KHR_texture_transform": { "scale": [4.0, 2.0] } } });
        material
    }

    /// Spheres from left to right; row 0 is the nearest.
    fn row(&mut self, row: usize, samples: [Sample; COLUMNS]) {
        for (column, (name, material)) in samples.into_iter().enumerate() {
            let material = self.document.add_material(&name, material);
            let mesh = self.document.add_mesh(&name, &[(&self.sphere, material)]);
            let x = (column as f32 - (COLUMNS - 1) as f32 / 2.0) * 0.36;
            self.document.add_node(json!({ "name": name, "mesh": mesh, "translation": [x, RADIUS, -0.45 * row as f32] }));
        }
    }

    fn finish(mut self) -> Vec<u8> {
        self.document.add_camera(vec3(0.0, 2.05, 2.75), vec3(0.0, 0.04, -0.52), 0.46);
        self.document.into_glb()
    }
}

/// A floor that curves up into a wall, as in a photographer's studio.
fn cyclorama() -> Surface {
    const BEND: f32 = 0.8;
    let profile = |v: f32| -> Vec2 {
        let along = v * (5.0 + BEND * FRAC_PI_2 + 2.0);
        let angle = ((along - 5.0) / BEND).clamp(0.0, FRAC_PI_2);
        let wall = (along - 5.0 - BEND * FRAC_PI_2).max(0.0);
        vec2(along.min(5.0) + BEND * angle.sin(), BEND * (1.0 - angle.cos()) + wall)
    };
    Surface::patch(1, 160, |u, v| vec3((u - 0.5) * 9.0, profile(v).y - 0.003, 3.2 - profile(v).x))
}

/// A rectangle of `size` metres that looks at the spheres.
fn panel(position: Vec3, size: Vec2) -> Surface {
    let half = size / 2.0;
    let rotation = super::document::look_rotation(vec3(0.0, 0.0, -0.6) - position) * Quat::from_rotation_y(PI);
    let corners = [vec3(-half.x, -half.y, 0.0), vec3(half.x, -half.y, 0.0), vec3(half.x, half.y, 0.0), vec3(-half.x, half.y, 0.0)];
    Surface::quad(corners).transformed(Affine3A::from_rotation_translation(rotation, position))
}

/// Two by two tiles with dark joints and a little stain, sRGB.
fn tile_color(uv: Vec2) -> Vec3 {
    let base = if checker(uv, 2.0) > 0.5 { vec3(0.82, 0.79, 0.74) } else { vec3(0.27, 0.29, 0.33) };
    let in_tile = (uv * 2.0).fract();
    let to_joint = in_tile.min(1.0 - in_tile).min_element();
    let stain = 1.0 + 0.07 * fractal(uv * 8.0, 8, 3, 4);
    if to_joint < 0.012 { Vec3::splat(0.2) } else { base * stain }
}
