//! Acceleration structures: one trait, one registry. The shader half of a structure is `shaders_glsl/accel/structures/<stem>.glsl`.
//!
//! A scene is put into spatial order once ([`order_scene`]), whatever the structure, so that a primitive's index means the same to all.
//! To add a structure: a host file with its [`Entry`], a GLSL file with `accel_trace`, a line in [`REGISTRY`].

mod bounds;
mod bvh;
mod order;
mod ray_query;
mod top_level;
mod tree;

pub use bounds::Aabb;
pub use order::{MeshTree, order_scene};
pub use tree::{Item, Limits, Tree};

use crate::gpu::{Capabilities, Commands, DescriptorSet, DeviceKind, Gpu, GpuError, vk};
use crate::scene::Scene;
use crate::shared::Instance;

/// Where a structure finds a mesh on the device: vec3 per vertex, uvec3 per triangle, in the scene's order. The buffers carry
/// [`build_input_usage`].
#[derive(Debug, Clone, Copy)]
pub struct MeshGeometry {
    pub positions: u64,
    pub vertex_count: u32,
    pub triangles: u64,
    pub triangle_count: u32,
}

/// What a structure is built from. `scene` has been through [`order_scene`], which returned `trees`; there is one
/// [`MeshGeometry`] and one tree for each of its meshes.
#[derive(Clone, Copy)]
pub struct Geometry<'a> {
    pub scene: &'a Scene,
    pub meshes: &'a [MeshGeometry],
    pub trees: &'a [MeshTree],
    pub frames_in_flight: usize,
}

/// A structure on the device: meshes are built once, the level over instances follows them.
pub trait Structure: Send {
    /// Records what brings `slot`, whose last frame is done, up to these instances of the scene, so that dispatches recorded after it
    /// see them. Records nothing where they have not moved since the slot's last update.
    fn update(&mut self, commands: &Commands, slot: usize, instances: &[Instance]);

    /// What [`crate::shared::FrameData::accel`] must hold in this slot.
    fn root(&self, slot: usize) -> u64;

    /// Writes what the structure's shader half reads into set 0 of a slot ([`crate::frame::TOP_LEVEL`] or
    /// [`crate::frame::STRUCTURE_TEXELS`]).
    fn bind(&self, slot: usize, set: &DescriptorSet);

    /// Specialization constants of its shader half: id and word.
    fn constants(&self) -> Vec<(u32, u32)> {
        Vec::new()
    }

    /// Bytes on the device, both levels.
    fn memory_bytes(&self) -> u64;
}

type Build = fn(&Gpu, &Geometry) -> Result<Box<dyn Structure>, TraceError>;

/// A registry line.
pub struct Entry {
    /// As `--trace` takes it.
    pub name: &'static str,
    pub help: &'static str,
    /// Of the file in shaders_glsl/accel/structures/.
    pub stem: &'static str,
    /// Whether the device can; if not, what it lacks.
    pub available: fn(&Capabilities) -> Result<(), &'static str>,
    pub build: Build,
}

/// Best first, for a GPU.
pub static REGISTRY: &[Entry] = &[ray_query::ENTRY, bvh::ENTRY];

#[derive(Debug, thiserror::Error)]
pub enum TraceError {
    #[error("there is no acceleration structure '{wanted}'; there are auto, {known}")]
    Unknown { wanted: String, known: String },
    #[error("device '{device}' cannot trace by {name}: it lacks {lacks}; use --trace auto")]
    Unavailable { name: &'static str, device: String, lacks: &'static str },
    #[error("the scene has {count} {what}; '{name}' takes at most {most}")]
    TooMany { name: &'static str, what: &'static str, count: usize, most: usize },
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// A structure, and why this one.
#[derive(Clone)]
pub struct Choice {
    pub entry: &'static Entry,
    pub reason: String,
}

/// The structure called `wanted`, or for `auto` the one that should be the fastest on this device.
///
/// # Errors
/// No structure has that name, or the device lacks what it needs.
pub fn choose(wanted: &str, capabilities: &Capabilities) -> Result<Choice, TraceError> {
    if wanted == "auto" {
        return Ok(choose_best(capabilities));
    }
    let unknown =
        || TraceError::Unknown { wanted: wanted.to_owned(), known: REGISTRY.iter().map(|e| e.name).collect::<Vec<_>>().join(", ") };
    let entry = REGISTRY.iter().find(|entry| entry.name == wanted).ok_or_else(unknown)?;
    (entry.available)(capabilities).map_err(|lacks| TraceError::Unavailable {
        name: entry.name,
        device: capabilities.name.clone(),
        lacks,
    })?;
    Ok(Choice { entry, reason: "asked for".to_owned() })
}

fn choose_best(capabilities: &Capabilities) -> Choice {
    if capabilities.kind == DeviceKind::Software {
        let reason = "the device is a software driver, where compute traversal is faster than ray queries".to_owned();
        return Choice { entry: &bvh::ENTRY, reason };
    }
    match (ray_query::ENTRY.available)(capabilities) {
        Ok(()) => Choice { entry: &ray_query::ENTRY, reason: "the device has ray query".to_owned() },
        Err(lacks) => Choice { entry: &bvh::ENTRY, reason: format!("the device lacks {lacks}") },
    }
}

/// What buffers of positions and triangles must be usable for.
pub fn build_input_usage(capabilities: &Capabilities) -> vk::BufferUsageFlags {
    match capabilities.ray_query {
        true => vk::BufferUsageFlags::ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_KHR,
        false => vk::BufferUsageFlags::empty(),
    }
}

fn check_count(name: &'static str, what: &'static str, count: usize, most: usize) -> Result<(), TraceError> {
    if count > most { Err(TraceError::TooMany { name, what, count, most }) } else { Ok(()) }
}

/// The instances that each slot was last brought up to.
struct Slots {
    latest: Vec<Instance>,
    /// Number of changes that each slot, and the latest instances, have seen.
    seen: Vec<u64>,
    changes: u64,
}

impl Slots {
    fn new(count: usize) -> Self {
        Self { latest: Vec::new(), seen: vec![0; count], changes: 0 }
    }

    /// Whether `slot` has to be built anew for these instances.
    fn outdated(&mut self, slot: usize, instances: &[Instance]) -> bool {
        let placed_alike = |a: &Instance, b: &Instance| a.object_to_world == b.object_to_world && (a.mesh, a.flags) == (b.mesh, b.flags);
        let same = self.latest.len() == instances.len() && self.latest.iter().zip(instances).all(|(a, b)| placed_alike(a, b));
        if self.changes == 0 || !same {
            self.latest.clear();
            self.latest.extend_from_slice(instances);
            self.changes += 1;
        }
        std::mem::replace(&mut self.seen[slot], self.changes) != self.changes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_stems_are_unique_and_have_a_shader() {
        for (index, entry) in REGISTRY.iter().enumerate() {
            assert!(REGISTRY[..index].iter().all(|other| other.name != entry.name && other.stem != entry.stem));
            let path = format!("{}/shaders_glsl/accel/structures/{}.glsl", env!("CARGO_MANIFEST_DIR"), entry.stem);
            assert!(std::path::Path::new(&path).exists(), "{path}");
        }
    }

    #[test]
    fn a_slot_is_built_anew_only_after_something_moved() {
        let mut slots = Slots::new(2);
        let here = [Instance::default()];
        let there = [Instance { object_to_world: [[1.0; 4]; 3], ..Instance::default() }];
        let asked = [(0, &here), (1, &here), (0, &here), (0, &there), (1, &there), (1, &there), (0, &there), (1, &here)];
        let outdated: Vec<bool> = asked.iter().map(|&(slot, instances)| slots.outdated(slot, instances)).collect();
        assert_eq!(outdated, [true, true, false, true, true, false, false, true]);
    }
}
