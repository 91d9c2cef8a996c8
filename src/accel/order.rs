//! Spatial order, which every structure shares: a primitive's index is its place in it.
//!
//! Triangles go into the order of the leaves of their mesh's tree, instances along a Morton curve. Drivers that split an index range
//! without sorting it get good trees from that, and a leaf is a contiguous range.

use super::bounds::Aabb;
use super::tree::{Item, Limits, Tree};
use crate::scene::Mesh;
use crate::shared::BVH_MESH_DEPTH;
use rayon::prelude::*;

/// Triangles per leaf at most: 2, 4 and 8 trace equally fast, and 4 takes less memory than 2.
const MESH_LIMITS: Limits = Limits { leaf: 4, depth: BVH_MESH_DEPTH };

/// A mesh's tree and the order of triangles that it was built in.
#[derive(Debug, Clone, Default)]
pub struct SpatialOrder {
    /// Triangle i of the ordered mesh is triangle `triangles[i]` of the scene's.
    pub triangles: Vec<u32>,
    /// Over the ordered triangles.
    pub tree: Tree,
    /// Of the vertices that triangles use.
    pub bounds: Aabb,
}

impl SpatialOrder {
    /// `values`, one per triangle of the scene's mesh, in the new order.
    pub fn apply<T: Copy + Send + Sync>(&self, values: &[T]) -> Vec<T> {
        self.triangles.par_iter().map(|&triangle| values[triangle as usize]).collect()
    }
}

/// Builds a mesh's tree, on all threads.
pub fn spatial_order(mesh: &Mesh) -> SpatialOrder {
    let corner = |index: u32| mesh.positions[index as usize];
    let item = |(index, triangle): (usize, &[u32; 3])| Item { bounds: Aabb::of_points(triangle.map(corner)), index: index as u32 };
    let mut items: Vec<Item> = mesh.triangles.par_iter().enumerate().map(item).collect();
    let tree = Tree::build(&mut items, MESH_LIMITS);
    let bounds = items.par_iter().map(|item| item.bounds).reduce(|| Aabb::EMPTY, Aabb::union);
    SpatialOrder { triangles: items.par_iter().map(|item| item.index).collect(), tree, bounds }
}

/// Order of instances along a Morton curve through the centres of their world bounds: place i holds instance `order[i]`.
pub fn instance_order(world_bounds: &[Aabb]) -> Vec<u32> {
    let centres = Aabb::of_points(world_bounds.iter().map(|bounds| bounds.centre().to_array()));
    let scale = 1023.0 / centres.extent().max_element().max(f32::MIN_POSITIVE);
    let key = |bounds: &Aabb| {
        let cell = (bounds.centre() - centres.min) * scale;
        spread(cell.x as u32) | spread(cell.y as u32) << 1 | spread(cell.z as u32) << 2
    };
    let mut order: Vec<u32> = (0..world_bounds.len() as u32).collect();
    order.sort_by_key(|&instance| key(&world_bounds[instance as usize]));
    order
}

/// Two zero bits between each of the lowest ten.
fn spread(value: u32) -> u32 {
    (0..10).fold(0, |spread, bit| spread | (value >> bit & 1) << (3 * bit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::{BVH_COUNT_SHIFT, BVH_EMPTY, BVH_FIRST_MASK, BVH_LEAF};
    use glam::Vec3A;
    use rand::{Rng, SeedableRng};

    fn mesh_of(corners: impl Iterator<Item = [[f32; 3]; 3]>) -> Mesh {
        let positions: Vec<[f32; 3]> = corners.flatten().collect();
        let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Mesh { positions, triangles, ..Mesh::default() }
    }

    fn random_mesh(count: usize, extent: f32) -> Mesh {
        let mut rng = rand_pcg::Pcg32::seed_from_u64(1);
        let mut point = |scale: f32| Vec3A::from_array(std::array::from_fn(|_| rng.random_range(-scale..scale)));
        mesh_of((0..count).map(|_| {
            let centre = point(extent);
            std::array::from_fn(|_| (centre + point(0.01 * extent)).to_array())
        }))
    }

    /// Every triangle lies in one leaf and inside every box above it; returns the longest way in inner nodes.
    fn check(mesh: &Mesh) -> u32 {
        let order = spatial_order(mesh);
        let triangles = order.apply(&mesh.triangles);
        let mut seen = vec![false; triangles.len()];
        let mut deepest = 0;
        let mut pending = vec![(order.tree.root, order.bounds, 0)];
        while let Some((child, bounds, depth)) = pending.pop() {
            if child == BVH_EMPTY {
                continue;
            }
            if child & BVH_LEAF == 0 {
                let node = &order.tree.nodes[child as usize];
                pending.push((node.child0, Aabb { min: node.min0.into(), max: node.max0.into() }, depth + 1));
                pending.push((node.child1, Aabb { min: node.min1.into(), max: node.max1.into() }, depth + 1));
                continue;
            }
            deepest = deepest.max(depth);
            let (first, count) = (child & BVH_FIRST_MASK, (child >> BVH_COUNT_SHIFT & 3) + 1);
            for triangle in first..first + count {
                assert!(!std::mem::replace(&mut seen[triangle as usize], true), "a triangle is in two leaves");
                let corners = triangles[triangle as usize].map(|vertex| mesh.positions[vertex as usize]);
                assert_eq!(bounds.union(Aabb::of_points(corners)), bounds, "a triangle leaves its box");
            }
        }
        assert!(seen.iter().all(|&seen| seen), "a triangle is in no leaf");
        deepest
    }

    #[test]
    fn every_triangle_is_in_one_leaf_and_inside_its_boxes() {
        for count in [0, 1, 4, 5, 100, 20_000] {
            assert!(check(&random_mesh(count, 1.0)) <= 30);
        }
    }

    #[test]
    fn the_depth_stays_bounded_whatever_the_geometry() {
        let same = mesh_of(std::iter::repeat_n([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 100_000));
        let teapots_in_stadiums = mesh_of((0..30_000).map(|i| {
            let size = 2f32.powf(120.0 - 240.0 * i as f32 / 30_000.0);
            [[size, 0.0, 0.0], [1.01 * size, 0.0, 0.0], [size, 0.01 * size, 0.0]]
        }));
        let along_a_line = mesh_of((0..50_000).map(|i| [[i as f32; 3], [i as f32 + 0.5; 3], [i as f32 + 0.7; 3]]));
        for mesh in [same, teapots_in_stadiums, along_a_line, random_mesh(9999, 1e-30), random_mesh(9999, 1e37)] {
            assert!(check(&mesh) <= BVH_MESH_DEPTH);
        }
    }

    #[test]
    fn a_depth_that_just_suffices_is_kept_to() {
        let mut items: Vec<Item> =
            (0..1000u32).map(|index| Item { bounds: Aabb::of_points([[1.5f32.powi(index as i32 / 12), 0.0, 0.0]]), index }).collect();
        let mut tree = Tree::default();
        tree.rebuild(&mut items, Limits { leaf: 1, depth: 10 });
        let mut depth = vec![0; tree.nodes.len()];
        for (index, node) in tree.nodes.iter().enumerate() {
            for child in [node.child0, node.child1].into_iter().filter(|child| child & BVH_LEAF == 0) {
                depth[child as usize] = depth[index] + 1;
            }
        }
        assert_eq!(depth.iter().max(), Some(&9));
    }

    #[test]
    fn a_second_top_level_is_built_in_the_memory_of_the_first() {
        let items: Vec<Item> =
            (0..1000u32).map(|index| Item { bounds: Aabb::of_points([[(index * 7919 % 1000) as f32, 0.0, 0.0]]), index }).collect();
        let mut tree = Tree::default();
        tree.rebuild(&mut items.clone(), Limits { leaf: 1, depth: 24 });
        let (first, memory) = (tree.nodes.clone(), tree.nodes.as_ptr());
        tree.rebuild(&mut items.clone(), Limits { leaf: 1, depth: 24 });
        assert_eq!((tree.nodes.as_ptr(), &tree.nodes), (memory, &first));
    }

    #[test]
    fn instances_that_lie_together_stay_together() {
        let bounds: Vec<Aabb> =
            [0.0, 100.0, 1.0, 101.0, 2.0].iter().map(|&x| Aabb::of_points([[x, 0.0, 0.0], [x + 0.1, 1.0, 1.0]])).collect();
        assert_eq!(instance_order(&bounds), [0, 2, 4, 1, 3]);
    }
}
