//! A white floor and a view of it: scenes whose light is known.

use glam::DVec3;
use pathspace::scene::{CameraView, Instance, Local, Material, Mesh, Node, Scene};
use pathspace::technique::ViewChoice;

pub fn node(translation: DVec3) -> Node {
    let local = Local::Trs { translation, rotation: glam::DQuat::IDENTITY, scale: DVec3::ONE };
    Node { name: String::new(), parent: None, local }
}

/// A square of `half` metres around the origin in the xz plane, facing up, with a Lambert albedo of 1/2.
pub fn floor(half: f32) -> Scene {
    let material = Material { base_color: [0.5, 0.5, 0.5, 1.0], metallic: 0.0, specular: 0.0, ..Default::default() };
    let mesh = Mesh {
        positions: vec![[-half, 0.0, -half], [-half, 0.0, half], [half, 0.0, half], [half, 0.0, -half]],
        normals: vec![[0.0, 1.0, 0.0]; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        triangle_materials: vec![0, 0],
        ..Default::default()
    };
    Scene {
        meshes: vec![mesh],
        materials: vec![material],
        nodes: vec![node(DVec3::ZERO)],
        instances: vec![Instance { mesh: 0, node: 0 }],
        ..Default::default()
    }
}

/// Straight down on the origin from 1 m, a picture of about `width` metres.
pub fn from_above(width: f64) -> ViewChoice {
    ViewChoice::Fixed(CameraView::look_at(DVec3::new(0.0, 1.0, 1e-7), DVec3::ZERO, (2.0 * (0.5 * width).atan()) as f32))
}
