//! The level over instances, rebuilt in the same memory whenever something moves.
//!
//! Instances whose boxes overlap make a ray enter one after the other only to leave them again. So the largest are opened: their trees'
//! uppermost nodes take their place, as Benthin et al., "Improved Two-Level BVHs using Partial Re-Braiding" (HPG 2017), section 4.
//! *Deviation*: all openings come before the build, largest box first up to a fixed number, instead of within it.

use super::bounds::Aabb;
use super::order::MeshTree;
use super::tree::{Item, Limits, Tree};
use crate::shared::{BVH_LEAF, BVH_TOP_DEPTH, BvhNode, Instance};
use glam::{DMat4, DVec3, DVec4};
use std::collections::BinaryHeap;

const LIMITS: Limits = Limits { leaf: 1, depth: BVH_TOP_DEPTH };
/// Roundings that a ray's origin and direction go through on their way into an instance, with some to spare.
const ROUNDINGS: f64 = 16.0;
/// Parts that opening adds to the instances: in a hall of 74 instances 0, 256, 1024 and 4096 trace diffuse rays at 1, 1.3, 1.35 and 1.3 times
/// the rate.
const OPENINGS: usize = 512;
const NEVER: u32 = u32::MAX;

/// Most parts of this many instances, whose trees have `nodes` inner nodes in all: one more for each that is opened.
pub fn most_entries(instances: usize, nodes: usize) -> usize {
    // A single instance overlaps nothing.
    if instances > 1 { instances + nodes.min(OPENINGS) } else { instances }
}

/// A subtree of a mesh's tree.
#[derive(Debug, Clone, Copy)]
struct Part {
    /// Mesh space.
    bounds: Aabb,
    /// As a child of a node.
    child: u32,
    /// Its own two parts' place in the crown, or NEVER.
    opened: u32,
}

/// The uppermost nodes of a mesh's tree.
pub struct Crown {
    root: Part,
    parts: Vec<[Part; 2]>,
}

impl Crown {
    /// `moved`: a child of the tree as the device numbers it.
    pub fn new(mesh: &MeshTree, moved: impl Fn(u32) -> u32) -> Self {
        let mut opened: Vec<u32> = Vec::new();
        let part = |bounds: Aabb, child: u32, opened: &mut Vec<u32>| {
            let inner = child & BVH_LEAF == 0 && opened.len() < OPENINGS;
            if inner {
                opened.push(child);
            }
            Part { bounds, child: moved(child), opened: if inner { opened.len() as u32 - 1 } else { NEVER } }
        };
        let root = part(mesh.bounds, mesh.tree.root, &mut opened);
        let mut parts = Vec::new();
        while let Some(&node) = opened.get(parts.len()) {
            let BvhNode { min0, max0, child0, min1, max1, child1, .. } = mesh.tree.nodes[node as usize];
            let bounds = [(min0, max0), (min1, max1)].map(|(min, max)| Aabb { min: min.into(), max: max.into() });
            parts.push([part(bounds[0], child0, &mut opened), part(bounds[1], child1, &mut opened)]);
        }
        Self { root, parts }
    }
}

/// Part of an instance.
#[derive(Clone, Copy)]
pub struct Entry {
    pub instance: u32,
    part: Part,
    /// Metres.
    margin: f64,
}

impl Entry {
    /// As a child of a node.
    pub fn root(&self) -> u32 {
        self.part.child
    }
}

#[derive(Default)]
pub struct TopLevel {
    /// What the tree's leaves name by index.
    pub entries: Vec<Entry>,
    pub tree: Tree,
    items: Vec<Item>,
    /// Entries that can be opened, by the area of their boxes (a positive float's bits are in its order).
    largest: BinaryHeap<(u32, u32)>,
}

impl TopLevel {
    /// Instances of empty meshes are left out.
    pub fn rebuild(&mut self, instances: &[Instance], crowns: &[Crown]) {
        let bounds = |instance: &Instance| crowns[instance.mesh as usize].root.bounds.transformed(&matrix(&instance.object_to_world), 0.0);
        let reach = instances.iter().map(|instance| bounds(instance).largest_coordinate()).fold(0.0, f32::max);
        self.entries.clear();
        self.items.clear();
        self.largest.clear();
        for (index, instance) in (0..).zip(instances) {
            let part = crowns[instance.mesh as usize].root;
            if !part.bounds.is_empty() {
                self.add(Entry { instance: index, part, margin: margin(instance, reach.into()) }, instance);
            }
        }
        let most = most_entries(self.entries.len(), OPENINGS);
        while self.entries.len() < most
            && let Some((_, opened)) = self.largest.pop()
        {
            let entry = self.entries[opened as usize];
            let instance = &instances[entry.instance as usize];
            let [first, second] = crowns[instance.mesh as usize].parts[entry.part.opened as usize];
            self.put(opened as usize, Entry { part: first, ..entry }, instance);
            self.add(Entry { part: second, ..entry }, instance);
        }
        self.tree.rebuild(&mut self.items, LIMITS);
    }

    fn add(&mut self, entry: Entry, instance: &Instance) {
        self.entries.push(entry);
        self.items.push(Item { bounds: Aabb::EMPTY, index: self.items.len() as u32 });
        self.put(self.entries.len() - 1, entry, instance);
    }

    fn put(&mut self, at: usize, entry: Entry, instance: &Instance) {
        let bounds = entry.part.bounds.transformed(&matrix(&instance.object_to_world), entry.margin);
        self.entries[at] = entry;
        self.items[at].bounds = bounds;
        if entry.part.opened != NEVER {
            self.largest.push((bounds.half_area().to_bits(), at as u32));
        }
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
    use crate::accel::order_scene;
    use crate::scene::{Mesh, Scene};
    use crate::shared::BVH_EMPTY;

    fn placed(x: f32, mesh: u32) -> Instance {
        let rows = |x| [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        Instance { object_to_world: rows(x), world_to_object: rows(-x), mesh, ..Instance::default() }
    }

    /// A row of triangles along x, and none.
    fn crowns(triangles: u32) -> [Crown; 2] {
        let positions = (0..3 * triangles).map(|i| [(i / 3) as f32, (i % 3) as f32, (i % 2) as f32]).collect();
        let row = Mesh { positions, triangles: (0..triangles).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(), ..Mesh::default() };
        let trees = order_scene(&mut Scene { meshes: vec![row, Mesh::default()], ..Scene::default() });
        [0, 1].map(|mesh| Crown::new(&trees[mesh], |child| child))
    }

    #[test]
    fn instances_of_empty_meshes_are_left_out() {
        let crowns = crowns(4);
        let mut top = TopLevel::default();
        top.rebuild(&[placed(0.0, 1), placed(5.0, 0)], &crowns);
        assert_eq!((top.tree.root, top.entries[0].instance), (BVH_LEAF, 1));
        top.rebuild(&[placed(0.0, 1)], &crowns);
        assert_eq!(top.tree.root, BVH_EMPTY);
    }

    #[test]
    fn a_single_instance_is_not_opened_and_many_only_up_to_the_limit() {
        let crowns = crowns(100_000);
        let mut top = TopLevel::default();
        top.rebuild(&[placed(0.0, 0)], &crowns);
        assert_eq!(top.entries.len(), 1);
        top.rebuild(&[placed(0.0, 0), placed(5.0, 0), placed(7.0, 0)], &crowns);
        assert_eq!(top.entries.len(), most_entries(3, OPENINGS));
    }

    #[test]
    fn every_part_of_an_opened_instance_is_there_once() {
        let crowns = crowns(1000);
        let mut top = TopLevel::default();
        top.rebuild(&[placed(0.0, 0), placed(5.0, 0)], &crowns);
        let mut reached = 0;
        for crown in &crowns[..1] {
            let mut pending = vec![crown.root];
            while let Some(part) = pending.pop() {
                let entries = top.entries.iter().filter(|entry| entry.part.child == part.child).count();
                assert!(entries <= 2, "a part is there once per instance");
                reached += entries;
                if entries < 2 && part.opened != NEVER {
                    pending.extend(crown.parts[part.opened as usize]);
                }
            }
        }
        assert_eq!(reached, top.entries.len());
    }
}
