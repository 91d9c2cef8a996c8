//! The level over instances, rebuilt in the same memory whenever something moves.

use super::order::MeshTree;
use super::tree::{Item, Limits, Tree};
use crate::shared::{BVH_TOP_DEPTH, Instance};
use glam::{DMat4, DVec3, DVec4};

const LIMITS: Limits = Limits { leaf: 1, depth: BVH_TOP_DEPTH };
/// Roundings that a ray's origin and direction go through on their way into an instance, with some to spare.
const ROUNDINGS: f64 = 16.0;

#[derive(Default)]
pub struct TopLevel {
    items: Vec<Item>,
    pub tree: Tree,
}

impl TopLevel {
    /// The tree's leaves name instances by index; those of empty meshes are left out.
    pub fn rebuild(&mut self, instances: &[Instance], meshes: &[MeshTree]) {
        let bounds = |instance: &Instance, margin: f64| {
            meshes[instance.mesh as usize].bounds.transformed(&matrix(&instance.object_to_world), margin)
        };
        let reach = instances.iter().map(|instance| bounds(instance, 0.0).largest_coordinate()).fold(0.0, f32::max);
        self.items.clear();
        self.items.extend((0..).zip(instances).filter_map(|(index, instance)| {
            let bounds = bounds(instance, margin(instance, reach.into()));
            (!bounds.is_empty()).then_some(Item { bounds, index })
        }));
        self.tree.rebuild(&mut self.items, LIMITS);
    }
}

/// By how much a ray from within `reach` of the origin may seem to miss the instance's box in the world though it meets it in mesh
/// space: the rounding error of its transformed origin, back in the world; metres.
fn margin(instance: &Instance, reach: f64) -> f64 {
    let (to_world, to_object) = (matrix(&instance.object_to_world), matrix(&instance.world_to_object));
    let object = absolute(&to_object, DVec3::splat(reach)) + to_object.w_axis.truncate().abs();
    ROUNDINGS * f64::from(f32::EPSILON) * absolute(&to_world, object).max_element()
}

fn absolute(matrix: &DMat4, vector: DVec3) -> DVec3 {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.truncate().abs());
    x * vector.x + y * vector.y + z * vector.z
}

/// From three rows of four.
fn matrix(rows: &[[f32; 4]; 3]) -> DMat4 {
    let row = |row: [f32; 4]| DVec4::from_array(row.map(f64::from));
    DMat4::from_cols(row(rows[0]), row(rows[1]), row(rows[2]), DVec4::W).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Aabb;
    use crate::shared::{BVH_EMPTY, BVH_LEAF};

    fn placed(x: f32, mesh: u32) -> Instance {
        let rows = |x| [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        Instance { object_to_world: rows(x), world_to_object: rows(-x), mesh, ..Instance::default() }
    }

    #[test]
    fn instances_of_empty_meshes_are_left_out() {
        let unit = MeshTree { bounds: Aabb::of_points([[0.0; 3], [1.0; 3]]), ..MeshTree::default() };
        let meshes = [MeshTree::default(), unit];
        let mut top = TopLevel::default();
        top.rebuild(&[placed(0.0, 0), placed(5.0, 1)], &meshes);
        assert_eq!(top.tree.root, BVH_LEAF | 1);
        top.rebuild(&[placed(0.0, 0)], &meshes);
        assert_eq!(top.tree.root, BVH_EMPTY);
        top.rebuild(&[placed(0.0, 1), placed(5.0, 1), placed(9.0, 0)], &meshes);
        assert_eq!(top.tree.nodes.len(), 1);
    }
}
