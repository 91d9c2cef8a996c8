//! Node transforms, composed in double precision, so that a scene placed 10^6 m away keeps its millimetres.

use glam::{DMat3, DMat4, DQuat, DVec3};

#[derive(Debug, Clone)]
pub struct Node {
    pub name: String,
    /// Always smaller than the node's own index.
    pub parent: Option<u32>,
    pub local: Local,
}

/// A node's transform relative to its parent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Local {
    Trs { translation: DVec3, rotation: DQuat, scale: DVec3 },
    Matrix(DMat4),
}

impl Local {
    pub fn to_matrix(self) -> DMat4 {
        match self {
            Local::Trs { translation, rotation, scale } => DMat4::from_scale_rotation_translation(scale, rotation, translation),
            Local::Matrix(matrix) => matrix,
        }
    }
}

/// World matrix of each node. `locals` gives the animated local transform of each node, in the order of `nodes`.
pub fn world_transforms(nodes: &[Node], locals: &[Local]) -> Vec<DMat4> {
    let mut world = vec![DMat4::IDENTITY; nodes.len()];
    compose(nodes, locals, &mut world);
    world
}

/// The same into memory that is there already.
pub fn compose(nodes: &[Node], locals: &[Local], world: &mut [DMat4]) {
    for (index, (node, local)) in nodes.iter().zip(locals).enumerate() {
        let local = local.to_matrix();
        world[index] = match node.parent {
            Some(parent) => world[parent as usize] * local,
            None => local,
        };
    }
}

/// Whether a mesh placed by `world` has an area and an inverse in single precision. Not so where a scale is zero, even on one axis:
/// such a mesh is no surface with two sides any more, and acceleration structures do not take it.
pub fn is_invertible(world: &DMat4) -> bool {
    let linear = DMat3::from_mat4(*world);
    let lengths = [linear.x_axis.length(), linear.y_axis.length(), linear.z_axis.length()];
    let volume = linear.determinant().abs() / (lengths[0] * lengths[1] * lengths[2]);
    world.is_finite() && lengths.iter().all(|length| (1e-18..1e18).contains(length)) && volume > 1e-9
}

/// A mirrored instance: its triangles wind clockwise as seen from their front.
pub fn flips_winding(world: &DMat4) -> bool {
    DMat3::from_mat4(*world).determinant() < 0.0
}
