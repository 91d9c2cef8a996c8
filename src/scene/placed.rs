//! What the host writes for a frame: instances, lights and the table to choose lights from, once per frame in flight.

use super::Scene;
use super::environment_distribution::EnvironmentDistribution;
use super::lights::LightTable;
use super::pose::Pose;
use crate::gpu::{Buffer, Gpu, GpuError, MemoryLocation, vk};
use crate::shared::{self, FrameData};
use bytemuck::Pod;

/// Lights and environment of a scene, and the memory that its moving part is written to.
pub struct PlacedScene {
    lights: LightTable,
    slots: Vec<Slot>,
    environment_size: [u32; 2],
    environment_radiance: [f32; 3],
    /// Texels and alias table of an environment map.
    environment: Option<[Buffer; 2]>,
}

struct Slot {
    instances: Buffer,
    lights: Buffer,
    punctual_lights: Buffer,
    alias: Buffer,
    /// Of the pose that was last written.
    written: Option<u64>,
}

impl PlacedScene {
    pub fn new(gpu: &Gpu, scene: &Scene, frames_in_flight: usize) -> Result<Self, GpuError> {
        let distribution = EnvironmentDistribution::new(&scene.environment);
        let lights = LightTable::new(scene, distribution.integral);
        let slot = |_| {
            Ok(Slot {
                instances: host_visible::<shared::Instance>(gpu, "instances", scene.instances.len())?,
                lights: host_visible::<shared::Light>(gpu, "lights", lights.lights().len())?,
                punctual_lights: host_visible::<shared::PunctualLight>(gpu, "punctual lights", lights.punctual_lights().len())?,
                alias: host_visible::<shared::AliasEntry>(gpu, "light alias table", lights.lights().len())?,
                written: None,
            })
        };
        let plain = vk::BufferUsageFlags::empty();
        let environment = match distribution.texels.is_empty() {
            true => None,
            false => Some([
                gpu.upload("environment texels", &distribution.texels, plain)?,
                gpu.upload("environment alias table", &distribution.alias, plain)?,
            ]),
        };
        Ok(Self {
            slots: (0..frames_in_flight).map(slot).collect::<Result<_, GpuError>>()?,
            lights,
            environment_size: distribution.size,
            environment_radiance: match scene.environment {
                super::Environment::Constant(radiance) => radiance,
                super::Environment::Map { .. } => [0.0; 3],
            },
            environment,
        })
    }

    pub fn lights(&self) -> &LightTable {
        &self.lights
    }

    /// Writes a pose into a slot whose last frame is done, unless it is there already.
    pub fn write(&mut self, slot: usize, scene: &Scene, pose: &Pose) {
        let slot = &mut self.slots[slot];
        if slot.written == Some(pose.version()) {
            return;
        }
        slot.written = Some(pose.version());
        self.lights.refresh(scene, pose.world(), pose.origin(), pose.radius());
        fill(&mut slot.instances, pose.instances());
        fill(&mut slot.lights, self.lights.lights());
        fill(&mut slot.punctual_lights, self.lights.punctual_lights());
        fill(&mut slot.alias, self.lights.alias());
    }

    /// This part's fields of a frame's data.
    pub fn describe(&self, slot: usize, data: &mut FrameData) {
        let slot = &self.slots[slot];
        data.instances = slot.instances.address();
        data.lights = slot.lights.address();
        data.punctual_lights = slot.punctual_lights.address();
        data.light_alias = slot.alias.address();
        data.light_count = self.lights.count();
        data.environment_light = self.lights.environment_light();
        (data.sole_light, data.sole_probability) = self.lights.sole();
        data.environment_size = self.environment_size;
        data.environment_radiance = self.environment_radiance;
        if let Some([texels, alias]) = &self.environment {
            data.environment_texels = texels.address();
            data.environment_alias = alias.address();
        }
    }
}

fn host_visible<T>(gpu: &Gpu, name: &str, count: usize) -> Result<Buffer, GpuError> {
    gpu.create_buffer(name, (count * size_of::<T>()) as u64, vk::BufferUsageFlags::empty(), MemoryLocation::CpuToGpu)
}

fn fill<T: Pod>(buffer: &mut Buffer, values: &[T]) {
    let bytes: &[u8] = bytemuck::cast_slice(values);
    buffer.mapped_mut().expect("host-visible memory is mapped")[..bytes.len()].copy_from_slice(bytes);
}
