//! `ray-query`: the driver's own structures (VK_KHR_acceleration_structure), built on the device: a bottom level per mesh, compacted where
//! that saves memory, and for each frame in flight a top level over instances.
//!
//! *Synchronization* (which validation layers do not check for these commands). Bottom levels: each batch of builds, which shares its
//! scratch memory with the one before, waits for it; compaction and everything later wait in `submit_once`. Top level: a slot's
//! instances, scratch and structure are its own, and its last frame is done before `update`, so nothing is overwritten that is
//! still read; instances written by the host are visible to what is submitted after; dispatches wait for the build by the barrier
//! behind it.

use super::{Entry, Geometry, MeshGeometry, Slots, Structure, TraceError, check_count};
use crate::frame::TOP_LEVEL;
use crate::gpu::{Buffer, Commands, DescriptorSet, Gpu, GpuError, MemoryLocation, vk};
use crate::scene::{AlphaMode, Scene};
use crate::shared::{INSTANCE_ALPHA, Instance};
use ash::khr::acceleration_structure::Device as Functions;
use vk::AccelerationStructureTypeKHR as Level;
use vk::BufferUsageFlags as Usage;
use vk::PipelineStageFlags as Stage;

pub const ENTRY: Entry = Entry {
    name: "ray-query",
    help: "the device's own structures and ray tracing units (VK_KHR_ray_query)",
    stem: "ray_query",
    available: |capabilities| if capabilities.ray_query { Ok(()) } else { Err("ray query (VK_KHR_ray_query)") },
    build: |gpu, geometry| Ok(Box::new(RayQuery::new(gpu, geometry)?)),
};

/// A top level's instances are numbered in 24 bits.
const MOST_INSTANCES: usize = 1 << 24;
/// Builds run side by side as long as their scratch memory stays below; bytes.
const BATCH_SCRATCH: u64 = 64 << 20;
/// A structure is compacted where at least this share of it goes away.
const WORTH_COMPACTING: f64 = 0.1;

struct RayQuery {
    /// None for an empty mesh.
    meshes: Vec<Option<AccelerationStructure>>,
    slots: Vec<TopLevel>,
    updates: Slots,
}

struct AccelerationStructure {
    functions: Functions,
    raw: vk::AccelerationStructureKHR,
    buffer: Buffer,
    address: u64,
}

struct TopLevel {
    structure: AccelerationStructure,
    /// VkAccelerationStructureInstanceKHR of each instance.
    instances: Buffer,
    scratch: Scratch,
}

/// Memory for builds, aligned as the device wants it.
struct Scratch {
    buffer: Buffer,
    address: u64,
}

impl RayQuery {
    fn new(gpu: &Gpu, geometry: &Geometry) -> Result<Self, TraceError> {
        let count = geometry.scene.instances.len();
        check_count(ENTRY.name, "instances", count, MOST_INSTANCES)?;
        let most = gpu.acceleration_structure_properties().max_primitive_count;
        for mesh in geometry.meshes {
            check_count(ENTRY.name, "triangles in one mesh", mesh.triangle_count as usize, most as usize)?;
        }
        let slots = (0..geometry.frames_in_flight).map(|_| TopLevel::new(gpu, count)).collect::<Result<_, _>>()?;
        Ok(Self { meshes: build_meshes(gpu, geometry)?, slots, updates: Slots::new(geometry.frames_in_flight) })
    }
}

impl Structure for RayQuery {
    fn update(&mut self, commands: &Commands, slot: usize, instances: &[Instance]) {
        if !self.updates.outdated(slot, instances) {
            return;
        }
        let top = &mut self.slots[slot];
        top.write_instances(instances, &self.meshes);
        let geometry = [instance_geometry(top.instances.address())];
        let info = build_info(Level::TOP_LEVEL, &geometry)
            .dst_acceleration_structure(top.structure.raw)
            .scratch_data(vk::DeviceOrHostAddressKHR { device_address: top.scratch.address });
        let range = [vk::AccelerationStructureBuildRangeInfoKHR::default().primitive_count(instances.len() as u32)];
        // Not through ash's function of this name, which allocates: this is called every frame.
        let build = top.structure.functions.fp().cmd_build_acceleration_structures_khr;
        // SAFETY: structure, scratch and instances were made for this many instances and live as long as the slot; one range for one geometry.
        unsafe { build(commands.raw(), 1, &info, &range.as_ptr()) };
        commands.barrier(Stage::ACCELERATION_STRUCTURE_BUILD_KHR, Stage::COMPUTE_SHADER);
    }

    fn root(&self, _slot: usize) -> u64 {
        0
    }

    fn bind(&self, slot: usize, set: &DescriptorSet) {
        set.write_acceleration_structure(TOP_LEVEL, self.slots[slot].structure.raw);
    }

    fn memory_bytes(&self) -> u64 {
        let meshes: u64 = self.meshes.iter().flatten().map(|mesh| mesh.buffer.size()).sum();
        meshes + self.slots.iter().map(TopLevel::memory_bytes).sum::<u64>()
    }
}

impl TopLevel {
    fn new(gpu: &Gpu, instances: usize) -> Result<Self, GpuError> {
        let bytes = (instances * size_of::<vk::AccelerationStructureInstanceKHR>()) as u64;
        let usage = Usage::ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_KHR;
        let buffer = gpu.create_buffer("top-level instances", bytes, usage, MemoryLocation::CpuToGpu)?;
        let sizes = build_sizes(functions(gpu), &build_info(Level::TOP_LEVEL, &[instance_geometry(0)]), instances as u32);
        Ok(Self {
            structure: AccelerationStructure::new(gpu, Level::TOP_LEVEL, sizes.acceleration_structure_size)?,
            instances: buffer,
            scratch: Scratch::new(gpu, sizes.build_scratch_size)?,
        })
    }

    fn write_instances(&mut self, instances: &[Instance], meshes: &[Option<AccelerationStructure>]) {
        let rows = self.instances.mapped_mut().expect("host-visible memory is mapped");
        let size = size_of::<vk::AccelerationStructureInstanceKHR>();
        for (index, (bytes, instance)) in rows.chunks_exact_mut(size).zip(instances).enumerate() {
            let opaque = match instance.flags & INSTANCE_ALPHA {
                0 => vk::GeometryInstanceFlagsKHR::FORCE_OPAQUE,
                _ => vk::GeometryInstanceFlagsKHR::empty(),
            };
            // As VkAccelerationStructureInstanceKHR: transform, index and mask, flags, address; address 0 is never hit.
            let address = meshes[instance.mesh as usize].as_ref().map_or(0, |mesh| mesh.address);
            bytes[..48].copy_from_slice(bytemuck::cast_slice(&instance.object_to_world));
            bytes[48..56].copy_from_slice(bytemuck::bytes_of(&[index as u32 | 0xff << 24, opaque.as_raw() << 24]));
            bytes[56..].copy_from_slice(&address.to_ne_bytes());
        }
    }

    fn memory_bytes(&self) -> u64 {
        self.structure.buffer.size() + self.instances.size() + self.scratch.buffer.size()
    }
}

impl Scratch {
    fn new(gpu: &Gpu, bytes: u64) -> Result<Self, GpuError> {
        let alignment = scratch_alignment(gpu);
        let buffer = gpu.create_buffer("structure scratch", bytes + alignment, Usage::empty(), MemoryLocation::GpuOnly)?;
        Ok(Self { address: buffer.address().next_multiple_of(alignment), buffer })
    }
}

fn scratch_alignment(gpu: &Gpu) -> u64 {
    u64::from(gpu.acceleration_structure_properties().min_acceleration_structure_scratch_offset_alignment).max(1)
}

impl AccelerationStructure {
    fn new(gpu: &Gpu, level: Level, bytes: u64) -> Result<Self, GpuError> {
        let functions = functions(gpu).clone();
        let usage = Usage::ACCELERATION_STRUCTURE_STORAGE_KHR;
        let buffer = gpu.create_buffer("acceleration structure", bytes, usage, MemoryLocation::GpuOnly)?;
        let info = vk::AccelerationStructureCreateInfoKHR::default().buffer(buffer.raw()).size(bytes).ty(level);
        // SAFETY: the buffer is as long as asked for, and lives as long as the structure, which drop destroys first.
        let raw = unsafe { functions.create_acceleration_structure(&info, None) }
            .map_err(|result| GpuError::Vulkan { what: "create an acceleration structure".to_owned(), result })?;
        let info = vk::AccelerationStructureDeviceAddressInfoKHR::default().acceleration_structure(raw);
        // SAFETY: the structure was just created.
        let address = unsafe { functions.get_acceleration_structure_device_address(&info) };
        Ok(Self { functions, raw, buffer, address })
    }
}

impl Drop for AccelerationStructure {
    fn drop(&mut self) {
        // SAFETY: the owner has seen to it that the device no longer uses the structure.
        unsafe { self.functions.destroy_acceleration_structure(self.raw, None) };
    }
}

fn functions(gpu: &Gpu) -> &Functions {
    gpu.acceleration_structure_fns().expect("the entry is available where ray query is")
}

fn instance_geometry(address: u64) -> vk::AccelerationStructureGeometryKHR<'static> {
    let data = vk::DeviceOrHostAddressConstKHR { device_address: address };
    let instances = vk::AccelerationStructureGeometryInstancesDataKHR::default().data(data);
    vk::AccelerationStructureGeometryKHR::default()
        .geometry_type(vk::GeometryTypeKHR::INSTANCES)
        .geometry(vk::AccelerationStructureGeometryDataKHR { instances })
}

fn mesh_geometry(mesh: &MeshGeometry, opaque: bool) -> vk::AccelerationStructureGeometryKHR<'static> {
    let triangles = vk::AccelerationStructureGeometryTrianglesDataKHR::default()
        .vertex_format(vk::Format::R32G32B32_SFLOAT)
        .vertex_data(vk::DeviceOrHostAddressConstKHR { device_address: mesh.positions })
        .vertex_stride(size_of::<[f32; 3]>() as u64)
        .max_vertex(mesh.vertex_count.saturating_sub(1))
        .index_type(vk::IndexType::UINT32)
        .index_data(vk::DeviceOrHostAddressConstKHR { device_address: mesh.triangles });
    vk::AccelerationStructureGeometryKHR::default()
        .geometry_type(vk::GeometryTypeKHR::TRIANGLES)
        .geometry(vk::AccelerationStructureGeometryDataKHR { triangles })
        .flags(if opaque { vk::GeometryFlagsKHR::OPAQUE } else { vk::GeometryFlagsKHR::empty() })
}

fn build_info<'a>(
    level: Level,
    geometries: &'a [vk::AccelerationStructureGeometryKHR<'a>],
) -> vk::AccelerationStructureBuildGeometryInfoKHR<'a> {
    let compactable = match level {
        Level::BOTTOM_LEVEL => vk::BuildAccelerationStructureFlagsKHR::ALLOW_COMPACTION,
        _ => vk::BuildAccelerationStructureFlagsKHR::empty(),
    };
    vk::AccelerationStructureBuildGeometryInfoKHR::default()
        .ty(level)
        .flags(vk::BuildAccelerationStructureFlagsKHR::PREFER_FAST_TRACE | compactable)
        .mode(vk::BuildAccelerationStructureModeKHR::BUILD)
        .geometries(geometries)
}

fn build_sizes(
    functions: &Functions,
    info: &vk::AccelerationStructureBuildGeometryInfoKHR,
    primitives: u32,
) -> vk::AccelerationStructureBuildSizesInfoKHR<'static> {
    let mut sizes = vk::AccelerationStructureBuildSizesInfoKHR::default();
    let kind = vk::AccelerationStructureBuildTypeKHR::DEVICE;
    // SAFETY: one primitive count for the one geometry.
    unsafe { functions.get_acceleration_structure_build_sizes(kind, info, &[primitives], &mut sizes) };
    sizes
}

/// Whether no triangle of each mesh has its alpha looked up.
fn opaque_meshes(scene: &Scene) -> Vec<bool> {
    let opaque = |&material: &u32| scene.materials.get(material as usize).is_none_or(|m| m.alpha_mode == AlphaMode::Opaque);
    scene.meshes.iter().map(|mesh| mesh.triangle_materials.iter().all(opaque)).collect()
}

/// A mesh's structure before it is built.
struct Job {
    mesh: usize,
    geometry: [vk::AccelerationStructureGeometryKHR<'static>; 1],
    primitives: u32,
    structure: AccelerationStructure,
    scratch_bytes: u64,
}

fn build_meshes(gpu: &Gpu, geometry: &Geometry) -> Result<Vec<Option<AccelerationStructure>>, GpuError> {
    let opaque = opaque_meshes(geometry.scene);
    let mut jobs = Vec::new();
    for (index, mesh) in geometry.meshes.iter().enumerate().filter(|(_, mesh)| mesh.triangle_count > 0) {
        let described = [mesh_geometry(mesh, opaque[index])];
        let sizes = build_sizes(functions(gpu), &build_info(Level::BOTTOM_LEVEL, &described), mesh.triangle_count);
        let structure = AccelerationStructure::new(gpu, Level::BOTTOM_LEVEL, sizes.acceleration_structure_size)?;
        let scratch_bytes = sizes.build_scratch_size.next_multiple_of(scratch_alignment(gpu));
        jobs.push(Job { mesh: index, geometry: described, primitives: mesh.triangle_count, structure, scratch_bytes });
    }
    let mut built: Vec<_> = geometry.meshes.iter().map(|_| None).collect();
    if !jobs.is_empty() {
        let compacted_bytes = build_jobs(gpu, &jobs)?;
        let placed: Vec<usize> = jobs.iter().map(|job| job.mesh).collect();
        let structures = jobs.into_iter().map(|job| job.structure).collect();
        for (mesh, structure) in placed.into_iter().zip(compact(gpu, structures, &compacted_bytes)?) {
            built[mesh] = Some(structure);
        }
    }
    Ok(built)
}

/// Builds in batches; returns the size that each structure would have when compacted.
fn build_jobs(gpu: &Gpu, jobs: &[Job]) -> Result<Vec<u64>, GpuError> {
    let batches = batches(jobs);
    let scratch = Scratch::new(gpu, batches.iter().map(|batch| batch.iter().map(|job| job.scratch_bytes).sum()).max().unwrap_or(0))?;
    let query = vk::QueryType::ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR;
    let info = vk::QueryPoolCreateInfo::default().query_type(query).query_count(jobs.len() as u32);
    let failed = |result| GpuError::Vulkan { what: "query the size of acceleration structures".to_owned(), result };
    // SAFETY: destroyed below, after the device is done with it.
    let pool = unsafe { gpu.raw().create_query_pool(&info, None) }.map_err(failed)?;
    let raw: Vec<_> = jobs.iter().map(|job| job.structure.raw).collect();
    let recorded = gpu.submit_once(|commands| {
        for batch in &batches {
            record_batch(functions(gpu), commands, batch, scratch.address);
            commands.barrier(Stage::ACCELERATION_STRUCTURE_BUILD_KHR, Stage::ACCELERATION_STRUCTURE_BUILD_KHR);
        }
        // SAFETY: the pool has a query for each structure, and the barrier makes their builds visible.
        unsafe {
            gpu.raw().cmd_reset_query_pool(commands.raw(), pool, 0, jobs.len() as u32);
            functions(gpu).cmd_write_acceleration_structures_properties(commands.raw(), &raw, query, pool, 0);
        }
    });
    let mut sizes = vec![0u64; jobs.len()];
    // SAFETY: submit_once has waited, so the results are there; then nothing uses the pool.
    let read = unsafe {
        let read = recorded.map(|()| gpu.raw().get_query_pool_results(pool, 0, &mut sizes, vk::QueryResultFlags::TYPE_64));
        gpu.raw().destroy_query_pool(pool, None);
        read
    };
    read?.map_err(failed)?;
    Ok(sizes)
}

/// Consecutive jobs whose scratch memory together stays below the limit, or single ones above it.
fn batches(jobs: &[Job]) -> Vec<&[Job]> {
    let (mut batches, mut start, mut bytes) = (Vec::new(), 0, 0);
    for (index, job) in jobs.iter().enumerate() {
        if index > start && bytes + job.scratch_bytes > BATCH_SCRATCH {
            batches.push(&jobs[start..index]);
            (start, bytes) = (index, 0);
        }
        bytes += job.scratch_bytes;
    }
    batches.push(&jobs[start..]);
    batches
}

fn record_batch(functions: &Functions, commands: &Commands, batch: &[Job], scratch: u64) {
    let mut next = scratch;
    let mut describe = |job| {
        let Job { geometry, structure, scratch_bytes, .. }: &Job = job;
        let device_address = next;
        next += scratch_bytes;
        build_info(Level::BOTTOM_LEVEL, geometry)
            .dst_acceleration_structure(structure.raw)
            .scratch_data(vk::DeviceOrHostAddressKHR { device_address })
    };
    let infos: Vec<_> = batch.iter().map(&mut describe).collect();
    let range = |job: &Job| [vk::AccelerationStructureBuildRangeInfoKHR::default().primitive_count(job.primitives)];
    let ranges: Vec<_> = batch.iter().map(range).collect();
    let ranges: Vec<&[_]> = ranges.iter().map(|range| range.as_slice()).collect();
    // SAFETY: each structure was made for its geometry, and has scratch memory of its own within the batch.
    unsafe { functions.cmd_build_acceleration_structures(commands.raw(), &infos, &ranges) };
}

/// Replaces each structure that has air in it by a copy that has not. Drivers that do not compact return the same size.
fn compact(gpu: &Gpu, structures: Vec<AccelerationStructure>, sizes: &[u64]) -> Result<Vec<AccelerationStructure>, GpuError> {
    let pays = |structure: &AccelerationStructure, size: u64| size as f64 <= structure.buffer.size() as f64 * (1.0 - WORTH_COMPACTING);
    let small = |(structure, &size): (&AccelerationStructure, &u64)| {
        pays(structure, size).then(|| AccelerationStructure::new(gpu, Level::BOTTOM_LEVEL, size)).transpose()
    };
    let copies: Vec<Option<AccelerationStructure>> = structures.iter().zip(sizes).map(small).collect::<Result<_, _>>()?;
    gpu.submit_once(|commands| {
        for (from, to) in structures.iter().zip(&copies).filter_map(|(from, to)| Some((from, to.as_ref()?))) {
            let info = vk::CopyAccelerationStructureInfoKHR::default()
                .src(from.raw)
                .dst(to.raw)
                .mode(vk::CopyAccelerationStructureModeKHR::COMPACT);
            // SAFETY: the source is built, and the target as long as the device said that the copy will be.
            unsafe { from.functions.cmd_copy_acceleration_structure(commands.raw(), &info) };
        }
    })?;
    Ok(structures.into_iter().zip(copies).map(|(whole, copy)| copy.unwrap_or(whole)).collect())
}
