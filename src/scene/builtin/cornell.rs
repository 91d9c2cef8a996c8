//! The Cornell box: <https://www.graphics.cornell.edu/online/box/data.html>, its millimetres as metres, with the usual RGB fit of its spectra.
//! Purely diffuse. The camera looks along +z, so +x is the picture's left.
//!
//! Two more have something that moves to the left, right and back again: 0.5 m/s, which is 3 to 4 pixels per frame at 30 frames per second and
//! 144 pixels of height.

use super::Options;
use super::document::Document;
use super::surface::Surface;
use glam::{Vec3, vec3};
use serde_json::{Value, json};

const WHITE: [f32; 3] = [0.725, 0.71, 0.68];
const RED: [f32; 3] = [0.63, 0.065, 0.05];
const GREEN: [f32; 3] = [0.14, 0.45, 0.091];
/// Radiance of the lamp is 15 times this.
const LAMP: [f32; 3] = [1.0, 0.8, 0.5];

type Quad = [[f32; 3]; 4];

// Front faces are counter-clockwise; in millimetres.
const FLOOR: Quad = [[552.8, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 559.2], [549.6, 0.0, 559.2]];
const CEILING: Quad = [[556.0, 548.8, 0.0], [556.0, 548.8, 559.2], [0.0, 548.8, 559.2], [0.0, 548.8, 0.0]];
const BACK: Quad = [[549.6, 0.0, 559.2], [0.0, 0.0, 559.2], [0.0, 548.8, 559.2], [556.0, 548.8, 559.2]];
const RIGHT: Quad = [[0.0, 0.0, 559.2], [0.0, 0.0, 0.0], [0.0, 548.8, 0.0], [0.0, 548.8, 559.2]];
const LEFT: Quad = [[552.8, 0.0, 0.0], [549.6, 0.0, 559.2], [556.0, 548.8, 559.2], [556.0, 548.8, 0.0]];
const SHORT_TOP: Quad = [[130.0, 165.0, 65.0], [82.0, 165.0, 225.0], [240.0, 165.0, 272.0], [290.0, 165.0, 114.0]];
const TALL_TOP: Quad = [[423.0, 330.0, 247.0], [265.0, 330.0, 296.0], [314.0, 330.0, 456.0], [472.0, 330.0, 406.0]];
/// One millimetre below the ceiling.
const LAMP_QUAD: Quad = [[343.0, 547.8, 227.0], [343.0, 547.8, 332.0], [213.0, 547.8, 332.0], [213.0, 547.8, 227.0]];
/// Hides the lamp's back, so that renderers which emit on both sides agree with those which emit on one.
const LAMP_BACK_HEIGHT: f32 = 547.81;

/// Metres to either side.
const SWING: f32 = 0.15;
/// Seconds, there and back on both sides.
const PERIOD: f32 = 1.2;

pub fn make(_: &Options) -> Vec<u8> {
    build("cornell").document.into_glb()
}

/// The lamp moves below the ceiling.
pub fn make_moving_light(_: &Options) -> Vec<u8> {
    let CornellBox { mut document, lamp, .. } = build("cornell-light");
    lamp.iter().for_each(|&node| swing(&mut document, node, Vec3::ZERO));
    document.into_glb()
}

/// A sphere moves before the tall block and above the short one.
pub fn make_moving_object(_: &Options) -> Vec<u8> {
    let CornellBox { mut document, white, .. } = build("cornell-object");
    let place = vec3(0.278, 0.4, 0.14);
    let geometry = document.add_geometry(&Surface::sphere(0.07, 64, 32));
    let mesh = document.add_mesh("sphere", &[(&geometry, white)]);
    let node = document.add_node(json!({ "name": "sphere", "mesh": mesh, "translation": place.to_array() }));
    swing(&mut document, node, place);
    document.into_glb()
}

fn swing(document: &mut Document, node: usize, place: Vec3) {
    let keys = [0.0, SWING, -SWING, 0.0].map(|offset| (place + Vec3::X * offset).to_array().to_vec());
    document.animate(node, "translation", &[0.0, 0.25 * PERIOD, 0.75 * PERIOD, PERIOD], &keys);
}

/// The box under construction, and what some scene changes in it.
struct CornellBox {
    document: Document,
    /// Material.
    white: usize,
    /// Nodes of the lamp and its back.
    lamp: [usize; 2],
}

fn build(name: &str) -> CornellBox {
    let mut document = Document::new(name);
    let white = document.add_material("white", lambert(WHITE));
    let green = document.add_material("green", lambert(GREEN));
    let red = document.add_material("red", lambert(RED));
    let black = document.add_material("black", lambert([0.0; 3]));
    let mut lamp = lambert([0.0; 3]);
    lamp["emissiveFactor"] = json!(LAMP);
    lamp["extensions"]["KHR_materials_emissive_strength"] = json!({ "emissiveStrength": 15.0 });
    let lamp = document.add_material("lamp", lamp);

    let objects: [(&str, Surface, usize); 7] = [
        ("floor", wall(FLOOR, Vec3::Y), white),
        ("ceiling", wall(CEILING, Vec3::NEG_Y), white),
        ("back wall", wall(BACK, Vec3::NEG_Z), white),
        ("right wall", wall(RIGHT, Vec3::X), green),
        ("left wall", wall(LEFT, Vec3::NEG_X), red),
        ("short block", block(SHORT_TOP), white),
        ("tall block", block(TALL_TOP), white),
    ];
    for (name, surface, material) in &objects {
        document.add_object(name, surface, *material);
    }
    let lamp_back = wall(LAMP_QUAD.map(|[x, _, z]| [x, LAMP_BACK_HEIGHT, z]), Vec3::NEG_Y);
    let lamp = [document.add_object("lamp back", &lamp_back, black), document.add_object("lamp", &wall(LAMP_QUAD, Vec3::NEG_Y), lamp)];
    // 25 mm film behind a 35 mm lens.
    document.add_camera(vec3(0.278, 0.273, -0.8), vec3(0.278, 0.273, 0.0), 2.0 * (12.5f32 / 35.0).atan());
    CornellBox { document, white, lamp }
}

/// Without KHR_materials_specular's factor of 0, a dielectric has a specular coat.
pub fn lambert(albedo: [f32; 3]) -> Value {
    let [r, g, b] = albedo;
    json!({
        "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0 },
        "extensions": { "KHR_materials_specular": { "specularFactor": 0.0 } },
    })
}

/// A quadrilateral that faces `towards`.
fn wall(corners_mm: Quad, towards: Vec3) -> Surface {
    let mut corners = corners_mm.map(|corner| Vec3::from(corner) / 1000.0);
    if (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(towards) < 0.0 {
        corners.reverse();
    }
    Surface::quad(corners)
}

/// A block that stands on the floor, open below: its top and the four sides under the top's edges.
fn block(top: Quad) -> Surface {
    let centre = top.iter().map(|&corner| Vec3::from(corner)).sum::<Vec3>() / 4.0;
    let side = |i: usize| {
        let (a, b) = (top[i], top[(i + 1) % 4]);
        let foot = |[x, _, z]: [f32; 3]| [x, 0.0, z];
        let outwards = (Vec3::from(a) + Vec3::from(b)) / 2.0 - centre;
        wall([foot(a), foot(b), b, a], outwards)
    };
    std::iter::once(wall(top, Vec3::Y)).chain((0..4).map(side)).sum()
}
