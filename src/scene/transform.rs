//! Node transforms, composed in double precision, so that a scene placed 10^6 m away keeps its millimetres.

use glam::{DMat4, DQuat, DVec3};

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
    let mut world: Vec<DMat4> = Vec::with_capacity(nodes.len());
    for (node, local) in nodes.iter().zip(locals) {
        let local = local.to_matrix();
        world.push(match node.parent {
            Some(parent) => world[parent as usize] * local,
            None => local,
        });
    }
    world
}
