//! The scene at one moment, as a frame needs it: world transforms relative to an origin near the camera, this frame's and the last's.
//!
//! Transforms compose in double precision. The origin is the camera's place rounded to a power of two near the scene's size: what
//! reaches the device is small, whatever the scene's place in the world, and only whole steps ever change it, so that
//! anything keyed by `position + origin` stays in place when it moves.

use super::camera::CameraView;
use super::transform::{compose, flips_winding, world_transforms};
use super::{AlphaMode, Instance, Local, Mesh, Projection, Scene};
use crate::shared;
use glam::{DMat4, DVec3};

/// Memory that is reused from frame to frame.
pub struct Pose {
    locals: Vec<Local>,
    /// World matrix of each node, this frame and the last.
    world: [Vec<DMat4>; 2],
    view: [CameraView; 2],
    origin: DVec3,
    /// Metres; a power of two.
    step: f64,
    /// Half the diagonal of the scene's bounds, metres.
    radius: f64,
    instances: Vec<shared::Instance>,
    /// Counts changes.
    version: u64,
}

impl Pose {
    /// At time 0, seen from `view`. `first_lights`: [`shared::Instance::first_light`] of each instance.
    pub fn new(scene: &Scene, view: CameraView, first_lights: impl Iterator<Item = u32>) -> Self {
        let locals: Vec<Local> = scene.animation.sample(&scene.nodes, 0.0);
        let world = world_transforms(&scene.nodes, &locals);
        let alpha: Vec<bool> = scene.meshes.iter().map(|mesh| has_alpha(scene, mesh)).collect();
        let row = |(instance, first_light): (&Instance, u32)| shared::Instance {
            mesh: instance.mesh,
            first_light,
            flags: if alpha[instance.mesh as usize] { shared::INSTANCE_ALPHA } else { 0 },
            ..Default::default()
        };
        let instances = scene.instances.iter().zip(first_lights).map(row).collect();
        let radius = scene.bounds(&world).map_or(1.0, |(low, high)| 0.5 * (high - low).length()).max(f64::MIN_POSITIVE);
        let mut pose = Self {
            locals,
            world: [world.clone(), world],
            view: [view; 2],
            origin: DVec3::ZERO,
            step: radius.log2().ceil().exp2(),
            radius,
            instances,
            version: 0,
        };
        pose.rebase();
        pose.place_instances(scene);
        pose
    }

    /// Moves on to `time`, seconds; `view` is where it is seen from, given the world matrices. After an error the pose is half-way.
    pub fn advance<E>(&mut self, scene: &Scene, time: f64, view: impl FnOnce(&[DMat4]) -> Result<CameraView, E>) -> Result<(), E> {
        scene.animation.sample_into(&scene.nodes, time, &mut self.locals);
        self.world.swap(0, 1);
        self.view.swap(0, 1);
        compose(&scene.nodes, &self.locals, &mut self.world[0]);
        self.view[0] = view(&self.world[0])?;
        self.rebase();
        self.place_instances(scene);
        Ok(())
    }

    fn rebase(&mut self) {
        self.origin = (self.view[0].position / self.step).round() * self.step;
    }

    fn place_instances(&mut self, scene: &Scene) {
        self.version += 1;
        let to_origin = DMat4::from_translation(-self.origin);
        for (placed, instance) in self.instances.iter_mut().zip(&scene.instances) {
            let [now, before] = [0, 1].map(|frame| to_origin * self.world[frame][instance.node as usize]);
            placed.object_to_world = rows(&now);
            placed.world_to_object = rows(&now.inverse());
            placed.previous_object_to_world = rows(&before);
            let mirrored = if flips_winding(&now) { shared::INSTANCE_MIRRORED } else { 0 };
            placed.flags = placed.flags & !shared::INSTANCE_MIRRORED | mirrored;
        }
    }

    /// Differs from that of every other pose of this scene before.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// In the order of the scene's.
    pub fn instances(&self) -> &[shared::Instance] {
        &self.instances
    }

    /// World matrix of each node.
    pub fn world(&self) -> &[DMat4] {
        &self.world[0]
    }

    /// World coordinates of the device's zero.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The origin in whole steps, modulo 2^32, and the logarithm to base 2 of a step in metres: for coordinates of cells, exact wherever
    /// the scene is.
    pub fn origin_steps(&self) -> ([i32; 3], i32) {
        let steps = (self.origin / self.step).to_array().map(|steps| steps as i64 as i32);
        (steps, self.step.log2() as i32)
    }

    /// Metres.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// This frame's camera and the last's, relative to this frame's origin, for a picture of `extent` pixels.
    pub fn cameras(&self, extent: [u32; 2]) -> [shared::Camera; 2] {
        self.view.map(|view| camera(&view, self.origin, extent))
    }
}

/// Some triangle of the mesh is not simply there.
fn has_alpha(scene: &Scene, mesh: &Mesh) -> bool {
    mesh.triangle_materials.iter().any(|&material| scene.materials[material as usize].alpha_mode != AlphaMode::Opaque)
}

/// The upper three rows of an affine matrix.
fn rows(matrix: &DMat4) -> [[f32; 4]; 3] {
    [0, 1, 2].map(|row| matrix.row(row).as_vec4().to_array())
}

fn camera(view: &CameraView, origin: DVec3, extent: [u32; 2]) -> shared::Camera {
    let [width, height] = extent.map(f64::from);
    let (projection, half_height) = match view.projection {
        Projection::Perspective { yfov } => (1, (0.5 * f64::from(yfov)).tan()),
        Projection::Orthographic { ymag } => (0, f64::from(ymag)),
    };
    let pixel = 2.0 * half_height / height;
    shared::Camera {
        position: (view.position - origin).as_vec3().to_array(),
        projection,
        right: (view.forward.cross(view.up) * half_height * width / height).as_vec3().to_array(),
        pixel_spread: if projection == 1 { pixel.atan() as f32 } else { 0.0 },
        up: (view.up * half_height).as_vec3().to_array(),
        pixel_width: if projection == 0 { pixel as f32 } else { 0.0 },
        forward: view.forward.as_vec3().to_array(),
        padding: 0,
    }
}
