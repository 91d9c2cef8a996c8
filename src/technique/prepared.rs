//! A scene made ready for the device: merged, ordered, uploaded, its acceleration structure built.

use super::settings::{RenderError, Settings};
use super::timings::{BuildTimes, Clock, MemoryUse};
use crate::accel::{self, Structure};
use crate::gpu::{Buffer, Gpu, GpuError, vk};
use crate::paths::energy;
use crate::scene::Scene;
use crate::scene::effects::{Effect, EffectSet};
use crate::scene::merge::merge_static;
use crate::scene::placed::PlacedScene;
use crate::scene::pose::Pose;
use crate::scene::transform::world_transforms;
use crate::scene::upload::SceneBuffers;
use crate::shared::FrameData;

/// Everything that does not depend on the technique. Fields are dropped in order, users before what they use.
pub(super) struct PreparedScene {
    pub structure: Box<dyn Structure>,
    pub placed: PlacedScene,
    pub buffers: SceneBuffers,
    energy_tables: Option<Buffer>,
    pub pose: Pose,
    pub effects: EffectSet,
    /// As uploaded: merged, in spatial order.
    pub scene: Scene,
    pub entry: &'static accel::Entry,
    pub build_ms: BuildTimes,
    pub memory: MemoryUse,
}

impl PreparedScene {
    pub fn new(gpu: &Gpu, mut scene: Scene, settings: &Settings, frames_in_flight: usize) -> Result<Self, RenderError> {
        let choice = accel::choose(&settings.trace, gpu.capabilities())?;
        tracing::info!("rays are traced by {}: {}", choice.entry.name, choice.reason);
        let (mut clock, mut build_ms, mut memory) = (Clock::start(), BuildTimes::default(), MemoryUse::default());
        let effects = if settings.all_effects { EffectSet::all() } else { EffectSet::derive(&scene) };
        if settings.merge_static {
            merge_static(&mut scene);
        }
        let trees = accel::order_scene(&mut scene);
        build_ms.order = clock.lap();

        gpu.watch_memory();
        let before = gpu.allocated_bytes();
        let buffers = SceneBuffers::new(gpu, &scene)?;
        let placed = PlacedScene::new(gpu, &scene, frames_in_flight)?;
        let energy_tables = upload_energy_tables(gpu, &effects)?;
        let world = world_transforms(&scene.nodes, &scene.animation.sample(&scene.nodes, 0.0));
        let pose = Pose::new(&scene, settings.view.at(&scene, &world)?, placed.lights().first_lights());
        build_ms.upload = clock.lap();
        memory.textures = buffers.texture_bytes();
        memory.scene = gpu.allocated_bytes() - before - memory.textures;
        memory.triangles = scene.instances.iter().map(|instance| scene.meshes[instance.mesh as usize].triangles.len() as u64).sum();

        let geometry = accel::Geometry { scene: &scene, meshes: &buffers.meshes, trees: &trees, frames_in_flight };
        let structure = (choice.entry.build)(gpu, &geometry)?;
        build_ms.structure = clock.lap();
        memory.structure = structure.memory_bytes();
        Ok(Self { structure, placed, buffers, energy_tables, pose, effects, scene, entry: choice.entry, build_ms, memory })
    }

    /// The scene's fields of the data of a frame in flight.
    pub fn describe(&self, slot: usize, data: &mut FrameData) {
        data.meshes = self.buffers.mesh_buffer.address();
        data.materials = self.buffers.material_buffer.address();
        data.accel = self.structure.root(slot);
        data.energy_tables = self.energy_tables.as_ref().map_or(0, Buffer::address);
        data.scene_radius = self.pose.radius() as f32;
        self.placed.describe(slot, data);
    }
}

/// Only where some lobe loses energy between its microfacets.
fn upload_energy_tables(gpu: &Gpu, effects: &EffectSet) -> Result<Option<Buffer>, GpuError> {
    let refraction = effects.contains(Effect::RoughTransmission);
    let wanted = refraction || effects.contains(Effect::Glossy) || effects.contains(Effect::Clearcoat);
    let upload = || gpu.upload("energy tables", &energy::energy_tables(refraction), vk::BufferUsageFlags::empty());
    wanted.then(upload).transpose()
}
