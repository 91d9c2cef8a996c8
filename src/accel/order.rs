//! Spatial order, which every structure shares: a primitive's index is its place in it.
//!
//! Triangles go into the order of the leaves of their mesh's tree, instances along a Morton curve. Drivers that split an index range
//! without sorting it get good trees from that, and a leaf is a contiguous range.

use super::bounds::Aabb;
use super::tree::{Item, Limits, Tree};
use crate::scene::transform::world_transforms;
use crate::scene::{Instance, Local, Mesh, Scene};
use crate::shared::BVH_MESH_DEPTH;
use glam::DVec3;
use rayon::prelude::*;

/// Triangles per leaf at most: 2, 4 and 8 trace equally fast, and 4 takes less memory than 2.
const MESH_LIMITS: Limits = Limits { leaf: 4, depth: BVH_MESH_DEPTH };

/// A mesh's tree, over its ordered triangles.
#[derive(Debug, Clone, Default)]
pub struct MeshTree {
    pub tree: Tree,
    /// Of all its triangles.
    pub bounds: Aabb,
}

/// Puts the triangles of every mesh, and the instances, into spatial order; returns each mesh's tree. Runs on all threads.
pub fn order_scene(scene: &mut Scene) -> Vec<MeshTree> {
    let trees: Vec<MeshTree> = scene.meshes.iter_mut().map(order_mesh).collect();
    order_instances(scene, &trees);
    trees
}

fn order_mesh(mesh: &mut Mesh) -> MeshTree {
    let corner = |index: u32| mesh.positions[index as usize];
    let item = |(index, triangle): (usize, &[u32; 3])| Item { bounds: Aabb::of_points(triangle.map(corner)), index: index as u32 };
    let mut items: Vec<Item> = mesh.triangles.par_iter().enumerate().map(item).collect();
    let tree = Tree::build(&mut items, MESH_LIMITS);
    let bounds = items.par_iter().map(|item| item.bounds).reduce(|| Aabb::EMPTY, Aabb::union);
    mesh.triangles = in_order(&items, &mesh.triangles);
    mesh.triangle_materials = in_order(&items, &mesh.triangle_materials);
    MeshTree { tree, bounds }
}

/// `values`, one per triangle, in the order of `items`; where there are none, none.
fn in_order<T: Copy + Send + Sync>(items: &[Item], values: &[T]) -> Vec<T> {
    if values.is_empty() { Vec::new() } else { items.par_iter().map(|item| values[item.index as usize]).collect() }
}

/// Along a Morton curve through the centres of their world bounds at time 0.
fn order_instances(scene: &mut Scene, trees: &[MeshTree]) {
    let locals: Vec<Local> = scene.nodes.iter().map(|node| node.local).collect();
    let world = world_transforms(&scene.nodes, &locals);
    let centre = |instance: &Instance| {
        let bounds = trees[instance.mesh as usize].bounds;
        world[instance.node as usize].transform_point3(if bounds.is_empty() { DVec3::ZERO } else { bounds.centre().as_dvec3() })
    };
    let centres: Vec<DVec3> = scene.instances.iter().map(centre).collect();
    let low = centres.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = centres.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let scale = 1023.0 / (high - low).max_element().max(f64::MIN_POSITIVE);
    let mut keyed: Vec<(u32, Instance)> =
        scene.instances.iter().zip(&centres).map(|(instance, centre)| (morton((centre - low) * scale), *instance)).collect();
    keyed.sort_by_key(|(key, _)| *key);
    scene.instances = keyed.into_iter().map(|(_, instance)| instance).collect();
}

/// Interleaves ten bits of each coordinate, which lie in 0..1024.
fn morton(cell: DVec3) -> u32 {
    spread(cell.x as u32) | spread(cell.y as u32) << 1 | spread(cell.z as u32) << 2
}

/// Two zero bits between each of the lowest ten.
fn spread(value: u32) -> u32 {
    (0..10).fold(0, |spread, bit| spread | (value >> bit & 1) << (3 * bit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Node;
    use crate::shared::{BVH_COUNT_SHIFT, BVH_EMPTY, BVH_FIRST_MASK, BVH_LEAF};
    use glam::{DMat4, Vec3A};
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
    fn check(mut mesh: Mesh) -> u32 {
        let order = order_mesh(&mut mesh);
        let mut seen = vec![false; mesh.triangles.len()];
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
                let corners = mesh.triangles[triangle as usize].map(|vertex| mesh.positions[vertex as usize]);
                assert_eq!(bounds.union(Aabb::of_points(corners)), bounds, "a triangle leaves its box");
            }
        }
        assert!(seen.iter().all(|&seen| seen), "a triangle is in no leaf");
        deepest
    }

    #[test]
    fn every_triangle_is_in_one_leaf_and_inside_its_boxes() {
        for count in [0, 1, 4, 5, 100, 20_000] {
            assert!(check(random_mesh(count, 1.0)) <= 30);
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
            assert!(check(mesh) <= BVH_MESH_DEPTH);
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
    fn triangles_keep_their_materials() {
        let mut mesh = random_mesh(1000, 1.0);
        mesh.triangle_materials = mesh.triangles.iter().map(|triangle| triangle[0] / 3 % 7).collect();
        order_mesh(&mut mesh);
        assert!(mesh.triangles.iter().zip(&mesh.triangle_materials).all(|(triangle, &material)| triangle[0] / 3 % 7 == material));
    }

    #[test]
    fn instances_that_lie_together_stay_together() {
        let node =
            |x: f64| Node { name: String::new(), parent: None, local: Local::Matrix(DMat4::from_translation(DVec3::new(x, 0.0, 0.0))) };
        let nodes: Vec<Node> = [0.0, 1e6, 1.0, 1e6 + 1.0, 2.0].map(node).into();
        let instances = (0..5).map(|node| Instance { mesh: 0, node }).collect();
        let mut scene = Scene { nodes, instances, meshes: vec![random_mesh(2, 1.0)], ..Scene::default() };
        order_scene(&mut scene);
        assert_eq!(scene.instances.iter().map(|instance| instance.node).collect::<Vec<_>>(), [0, 2, 4, 1, 3]);
    }
}
