//! `bvh`: a binary tree over instances and one per mesh, in buffers, for devices without ray query.
//!
//! Bytes per triangle: 48 for its corners in the order of the leaves (7 % faster than fetching them through the index buffer), and
//! about half a node of 64. Per instance and frame in flight: 64, and a node of the top level.

use super::order::MeshTree;
use super::top_level::TopLevel;
use super::{Entry, Geometry, Slots, Structure, TraceError, check_count};
use crate::frame::STRUCTURE_TEXELS;
use crate::gpu::{Buffer, Commands, DescriptorSet, Gpu, MemoryLocation, TexelBuffer, vk};
use crate::shared::{BVH_EMPTY, BVH_FIRST_MASK, BVH_LEAF, BVH_TOP_DEPTH, BvhInstance, BvhNode, BvhRoot, Instance};
use rayon::prelude::*;

pub const ENTRY: Entry = Entry {
    name: "bvh",
    help: "binary tree traversed in a compute shader; runs everywhere",
    stem: "bvh",
    available: |_| Ok(()),
    build: |gpu, geometry| Ok(Box::new(Bvh::new(gpu, geometry)?)),
};

const NODE_BYTES: u64 = size_of::<BvhNode>() as u64;
const INSTANCE_BYTES: u64 = size_of::<BvhInstance>() as u64;
const ROOT_BYTES: u64 = size_of::<BvhRoot>() as u64;

struct Bvh {
    gpu: Gpu,
    meshes: Vec<MeshTree>,
    /// What the top level needs to know of each mesh.
    placed: Vec<PlacedMesh>,
    /// Each slot's top level, then the nodes of all meshes.
    nodes: TexelBuffer,
    triangles: TexelBuffer,
    slots: Vec<Slot>,
    /// Most nodes of a top level.
    top_nodes: usize,
    top: TopLevel,
    updates: Slots,
}

/// Where a mesh lies in the arrays of all meshes.
#[derive(Clone, Copy)]
struct PlacedMesh {
    root: u32,
    first_triangle: u32,
}

/// What changes from frame to frame: written by the host into `staging`, read by the device from `device` and the nodes.
struct Slot {
    staging: Buffer,
    /// BvhRoot, then BvhInstance of each instance.
    device: Buffer,
}

impl Bvh {
    fn new(gpu: &Gpu, geometry: &Geometry) -> Result<Self, TraceError> {
        let instances = geometry.scene.instances.len();
        let triangles: usize = geometry.scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        check_count(ENTRY.name, "triangles", triangles, BVH_FIRST_MASK as usize)?;
        check_count(ENTRY.name, "instances", instances, 1 << BVH_TOP_DEPTH)?;
        let top_nodes = instances.saturating_sub(1);
        let (nodes, placed) = join_meshes(geometry, top_nodes * geometry.frames_in_flight);
        let none = vk::BufferUsageFlags::empty();
        let size = ROOT_BYTES + instances as u64 * INSTANCE_BYTES;
        let slot = |_| {
            let staging = gpu.create_buffer("bvh staging", size + top_nodes as u64 * NODE_BYTES, none, MemoryLocation::CpuToGpu)?;
            Ok(Slot { staging, device: gpu.create_buffer("bvh instances", size, none, MemoryLocation::GpuOnly)? })
        };
        Ok(Self {
            gpu: gpu.clone(),
            meshes: geometry.trees.iter().map(|mesh| MeshTree { bounds: mesh.bounds, ..MeshTree::default() }).collect(),
            placed,
            nodes: gpu.upload_texels("bvh nodes", &nodes)?,
            triangles: gpu.upload_texels("bvh triangles", &corners(geometry))?,
            slots: (0..geometry.frames_in_flight).map(slot).collect::<Result<_, TraceError>>()?,
            top_nodes,
            top: TopLevel::default(),
            updates: Slots::new(geometry.frames_in_flight),
        })
    }

    /// Fills the slot's staging buffer: root, instances, nodes of the top level.
    fn write(&mut self, slot: usize, instances: &[Instance]) {
        self.top.rebuild(instances, &self.meshes);
        let first_node = (slot * self.top_nodes) as u32;
        let device = &self.slots[slot].device;
        let root = BvhRoot { instances: device.address() + ROOT_BYTES, root: moved(self.top.tree.root, first_node, 0), padding: 0 };
        let bytes = self.slots[slot].staging.mapped_mut().expect("host-visible memory is mapped");
        let (head, rest) = bytes.split_at_mut(ROOT_BYTES as usize);
        let (rows, nodes) = rest.split_at_mut(instances.len() * INSTANCE_BYTES as usize);
        head.copy_from_slice(bytemuck::bytes_of(&root));
        for (row, instance) in rows.chunks_exact_mut(INSTANCE_BYTES as usize).zip(instances) {
            let mesh = self.placed[instance.mesh as usize];
            row.copy_from_slice(bytemuck::bytes_of(&BvhInstance {
                world_to_object: instance.world_to_object,
                root: mesh.root,
                first_triangle: mesh.first_triangle,
                flags: instance.flags,
                padding: 0,
            }));
        }
        for (bytes, node) in nodes.chunks_exact_mut(NODE_BYTES as usize).zip(&self.top.tree.nodes) {
            bytes.copy_from_slice(bytemuck::bytes_of(&moved_node(node, first_node, 0)));
        }
    }
}

impl Structure for Bvh {
    fn update(&mut self, commands: &Commands, slot: usize, instances: &[Instance]) {
        if !self.updates.outdated(slot, instances) {
            return;
        }
        self.write(slot, instances);
        let Slot { staging, device } = &self.slots[slot];
        let top_nodes = vk::BufferCopy {
            src_offset: device.size(),
            dst_offset: (slot * self.top_nodes) as u64 * NODE_BYTES,
            size: self.top.tree.nodes.len() as u64 * NODE_BYTES,
        };
        commands.copy_buffer(staging, device, device.size());
        if top_nodes.size > 0 {
            // SAFETY: both ranges are inside their buffers. The slot's last frame is done, so nothing reads what is overwritten.
            unsafe { self.gpu.raw().cmd_copy_buffer(commands.raw(), staging.raw(), self.nodes.buffer().raw(), &[top_nodes]) };
        }
        commands.barrier(vk::PipelineStageFlags::TRANSFER, vk::PipelineStageFlags::COMPUTE_SHADER);
    }

    fn root(&self, slot: usize) -> u64 {
        self.slots[slot].device.address()
    }

    fn bind(&self, _slot: usize, set: &DescriptorSet) {
        set.write_texel_buffer(STRUCTURE_TEXELS[0], &self.nodes);
        set.write_texel_buffer(STRUCTURE_TEXELS[1], &self.triangles);
    }

    fn memory_bytes(&self) -> u64 {
        self.nodes.buffer().size()
            + self.triangles.buffer().size()
            + self.slots.iter().map(|slot| slot.device.size() + slot.staging.size()).sum::<u64>()
    }
}

/// The nodes of all meshes in one array, behind room for `reserved` others.
fn join_meshes(geometry: &Geometry, reserved: usize) -> (Vec<BvhNode>, Vec<PlacedMesh>) {
    let total: usize = geometry.trees.iter().map(|mesh| mesh.tree.nodes.len()).sum();
    let mut nodes = Vec::with_capacity(reserved + total);
    nodes.resize(reserved, BvhNode::default());
    let mut first_triangle = 0;
    let mut place = |(mesh, count): (&MeshTree, usize)| {
        let first_node = nodes.len() as u32;
        nodes.extend(mesh.tree.nodes.iter().map(|node| moved_node(node, first_node, first_triangle)));
        let placed = PlacedMesh { root: moved(mesh.tree.root, first_node, first_triangle), first_triangle };
        first_triangle += count as u32;
        placed
    };
    let counts = geometry.scene.meshes.iter().map(|mesh| mesh.triangles.len());
    let placed = geometry.trees.iter().zip(counts).map(&mut place).collect();
    (nodes, placed)
}

fn moved_node(node: &BvhNode, nodes: u32, triangles: u32) -> BvhNode {
    BvhNode { child0: moved(node.child0, nodes, triangles), child1: moved(node.child1, nodes, triangles), ..*node }
}

/// A child of a tree whose nodes, and whose triangles, lie this far behind others'.
fn moved(child: u32, nodes: u32, triangles: u32) -> u32 {
    match child {
        BVH_EMPTY => BVH_EMPTY,
        leaf if leaf & BVH_LEAF != 0 => leaf + triangles,
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
