//! `bvh`: a binary tree over instances and one per mesh, in texel buffers, for devices without ray query.
//!
//! Bytes per triangle: 48 for its corners in the order of the leaves (7 % faster than fetching them through the index buffer), and
//! about half a node of 64. Per part of an instance (top_level.rs) and frame in flight: 64, and a node of the top level.

use super::top_level::{Crown, TopLevel, most_entries};
use super::{Entry, Geometry, Slots, Structure, TraceError, check_count};
use crate::frame::STRUCTURE_TEXELS;
use crate::gpu::{Buffer, Commands, DescriptorSet, Gpu, MemoryLocation, TexelBuffer, vk};
use crate::shared::{BVH_EMPTY, BVH_FIRST_MASK, BVH_LEAF, BVH_TOP_DEPTH, BvhEntry, BvhNode, BvhRoot, Instance};
use rayon::prelude::*;

pub const ENTRY: Entry = Entry {
    name: "bvh",
    help: "binary tree traversed in a compute shader; runs everywhere",
    stem: "bvh",
    available: |_| Ok(()),
    build: |gpu, geometry| Ok(Box::new(Bvh::new(gpu, geometry)?)),
};

/// Of a node, and of an entry.
const NODE_BYTES: usize = size_of::<BvhNode>();
const _: () = assert!(size_of::<BvhEntry>() == NODE_BYTES);

/// Specialization constant BVH_AS_TEXELS.
const AS_TEXELS: u32 = 210;

struct Bvh {
    gpu: Gpu,
    /// Of each mesh, as placed in the array of all nodes.
    crowns: Vec<Crown>,
    /// Of each mesh, in the array of all triangles.
    first_triangles: Vec<u32>,
    /// Each slot's entries and top level, then the nodes of all meshes.
    nodes: TexelBuffer,
    triangles: TexelBuffer,
    slots: Vec<Slot>,
    /// Most entries of a slot; its top level has as many nodes at most.
    most_entries: usize,
    top: TopLevel,
    updates: Slots,
}

/// What changes from frame to frame is written by the host into `staging`, and read by the device from here and from the nodes.
struct Slot {
    /// The slot's part of the nodes, then its BvhRoot.
    staging: Buffer,
    root: Buffer,
}

impl Bvh {
    fn new(gpu: &Gpu, geometry: &Geometry) -> Result<Self, TraceError> {
        let triangles: usize = geometry.scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        let instances = &geometry.scene.instances;
        let instanced_nodes = instances.iter().map(|instance| geometry.trees[instance.mesh as usize].tree.nodes.len()).sum();
        let most_entries = most_entries(instances.len(), instanced_nodes);
        check_count(ENTRY.name, "triangles", triangles, BVH_FIRST_MASK as usize)?;
        check_count(ENTRY.name, "parts of instances", most_entries, 1 << BVH_TOP_DEPTH)?;
        let (nodes, crowns, first_triangles) = join_meshes(geometry, 2 * most_entries * geometry.frames_in_flight);
        let slot = |_| {
            let (none, root_bytes) = (vk::BufferUsageFlags::empty(), size_of::<BvhRoot>());
            let staging_bytes = (2 * most_entries * NODE_BYTES + root_bytes) as u64;
            let staging = gpu.create_buffer("bvh staging", staging_bytes, none, MemoryLocation::CpuToGpu)?;
            Ok(Slot { staging, root: gpu.create_buffer("bvh root", root_bytes as u64, none, MemoryLocation::GpuOnly)? })
        };
        Ok(Self {
            gpu: gpu.clone(),
            crowns,
            first_triangles,
            nodes: gpu.upload_texels("bvh nodes", &nodes)?,
            triangles: gpu.upload_texels("bvh triangles", &corners(geometry))?,
            slots: (0..geometry.frames_in_flight).map(slot).collect::<Result<_, TraceError>>()?,
            most_entries,
            top: TopLevel::default(),
            updates: Slots::new(geometry.frames_in_flight),
        })
    }

    /// Fills the slot's staging buffer.
    fn write(&mut self, slot: usize, instances: &[Instance]) {
        self.top.rebuild(instances, &self.crowns);
        let first_entry = (2 * slot * self.most_entries) as u32;
        let first_node = first_entry + self.most_entries as u32;
        let bytes = self.slots[slot].staging.mapped_mut().expect("host-visible memory is mapped");
        let (entries, rest) = bytes.split_at_mut(self.most_entries * NODE_BYTES);
        let (nodes, root) = rest.split_at_mut(self.most_entries * NODE_BYTES);
        for (row, part) in entries.chunks_exact_mut(NODE_BYTES).zip(&self.top.entries) {
            let instance = &instances[part.instance as usize];
            row.copy_from_slice(bytemuck::bytes_of(&BvhEntry {
                world_to_object: instance.world_to_object,
                root: part.root(),
                first_triangle: self.first_triangles[instance.mesh as usize],
                instance: part.instance,
                flags: instance.flags,
            }));
        }
        for (row, node) in nodes.chunks_exact_mut(NODE_BYTES).zip(&self.top.tree.nodes) {
            row.copy_from_slice(bytemuck::bytes_of(&moved_node(node, first_node, first_entry)));
        }
        let top = BvhRoot {
            nodes: self.nodes.buffer().address(),
            triangles: self.triangles.buffer().address(),
            root: moved(self.top.tree.root, first_node, first_entry),
            padding: 0,
        };
        root[..size_of::<BvhRoot>()].copy_from_slice(bytemuck::bytes_of(&top));
    }
}

impl Structure for Bvh {
    fn update(&mut self, commands: &Commands, slot: usize, instances: &[Instance]) {
        if !self.updates.outdated(slot, instances) {
            return;
        }
        self.write(slot, instances);
        let Slot { staging, root } = &self.slots[slot];
        let size = ((self.most_entries + self.top.tree.nodes.len()) * NODE_BYTES) as u64;
        let slot_bytes = (2 * self.most_entries * NODE_BYTES) as u64;
        let nodes = vk::BufferCopy { src_offset: 0, dst_offset: slot as u64 * slot_bytes, size };
        let top = vk::BufferCopy { src_offset: slot_bytes, dst_offset: 0, size: root.size() };
        // SAFETY: all ranges are inside their buffers. The slot's last frame is done, so nothing reads what is overwritten.
        unsafe {
            if size > 0 {
                self.gpu.raw().cmd_copy_buffer(commands.raw(), staging.raw(), self.nodes.buffer().raw(), &[nodes]);
            }
            self.gpu.raw().cmd_copy_buffer(commands.raw(), staging.raw(), root.raw(), &[top]);
        }
        commands.barrier(vk::PipelineStageFlags::TRANSFER, vk::PipelineStageFlags::COMPUTE_SHADER);
    }

    fn root(&self, slot: usize) -> u64 {
        self.slots[slot].root.address()
    }

    fn bind(&self, _slot: usize, set: &DescriptorSet) {
        set.write_texel_buffer(STRUCTURE_TEXELS[0], &self.nodes);
        set.write_texel_buffer(STRUCTURE_TEXELS[1], &self.triangles);
    }

    fn constants(&self) -> Vec<(u32, u32)> {
        let texels = [&self.nodes, &self.triangles].iter().all(|buffer| buffer.view().is_some());
        vec![(AS_TEXELS, texels.into())]
    }

    fn memory_bytes(&self) -> u64 {
        let slots = self.slots.iter().map(|slot| slot.root.size() + slot.staging.size());
        self.nodes.buffer().size() + self.triangles.buffer().size() + slots.sum::<u64>()
    }
}

/// The nodes of all meshes in one array, behind room for `reserved` others; each mesh's crown and first triangle.
fn join_meshes(geometry: &Geometry, reserved: usize) -> (Vec<BvhNode>, Vec<Crown>, Vec<u32>) {
    let total: usize = geometry.trees.iter().map(|mesh| mesh.tree.nodes.len()).sum();
    let mut nodes = Vec::with_capacity(reserved + total);
    nodes.resize(reserved, BvhNode::default());
    let (mut crowns, mut first_triangles, mut first_triangle) = (Vec::new(), Vec::new(), 0);
    for (tree, mesh) in geometry.trees.iter().zip(&geometry.scene.meshes) {
        let first_node = nodes.len() as u32;
        nodes.extend(tree.tree.nodes.iter().map(|node| moved_node(node, first_node, first_triangle)));
        crowns.push(Crown::new(tree, |child| moved(child, first_node, first_triangle)));
        first_triangles.push(first_triangle);
        first_triangle += mesh.triangles.len() as u32;
    }
    (nodes, crowns, first_triangles)
}

fn moved_node(node: &BvhNode, nodes: u32, leaves: u32) -> BvhNode {
    BvhNode { child0: moved(node.child0, nodes, leaves), child1: moved(node.child1, nodes, leaves), ..*node }
}

/// A child of a tree whose nodes, and what its leaves name, lie this far behind others'.
fn moved(child: u32, nodes: u32, leaves: u32) -> u32 {
    match child {
        BVH_EMPTY => BVH_EMPTY,
        leaf if leaf & BVH_LEAF != 0 => leaf + leaves,
        node => node + nodes,
    }
}

/// Corners of all triangles of all meshes, a texel each.
fn corners(geometry: &Geometry) -> Vec<[[f32; 4]; 3]> {
    let meshes = geometry.scene.meshes.iter();
    let mut corners = Vec::with_capacity(meshes.clone().map(|mesh| mesh.triangles.len()).sum());
    for mesh in meshes {
        corners.par_extend(mesh.triangles.par_iter().map(|triangle| triangle.map(|vertex| corner(mesh.positions[vertex as usize]))));
    }
    corners
}

fn corner([x, y, z]: [f32; 3]) -> [f32; 4] {
    [x, y, z, 0.0]
}
