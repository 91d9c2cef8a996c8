//! Traces rays through every acceleration structure of a scene, and through none: an f64 oracle that tests every triangle.

use super::{KernelOptions, run_kernel_with};
use bytemuck::Pod;
use glam::{DMat4, DVec3, DVec4};
use pathspace::accel::{self, Geometry, REGISTRY, Structure};
use pathspace::gpu::{Buffer, DescriptorSet, Gpu, vk};
use pathspace::scene::transform::world_transforms;
use pathspace::scene::upload::SceneBuffers;
use pathspace::scene::{AlphaMode, Instance, Local, Mesh, Node, Scene};
use pathspace::shared::{self, FrameData};
use rand::Rng;

/// As in accel/ray.glsl, with the seed of stochastic alpha.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Ray {
    pub origin: [f32; 3],
    pub t_min: f32,
    pub direction: [f32; 3],
    pub t_max: f32,
    pub alpha_seed: u32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Hit {
    pub found: u32,
    pub t: f32,
    pub instance: u32,
    pub primitive: u32,
    pub barycentrics: [f32; 2],
}

const KERNEL: &str = r#"
#include "accel/trace.glsl"
struct In { Ray ray; uint alpha_seed; };
struct Out { uint found; Hit hit; };
void kernel(uint i) {
    Hit hit = Hit(0.0, 0, 0, vec2(0.0));
    bool found = accel_trace(inputs[i].ray, ANY_HIT, inputs[i].alpha_seed, hit);
    outputs[i] = found ? Out(1, hit) : Out(0, Hit(0.0, 0, 0, vec2(0.0)));
}
"#;

/// Frames in flight of every structure.
pub const SLOTS: usize = 2;

/// A scene in every structure that the device can have.
pub struct Traced<'a> {
    pub gpu: &'a Gpu,
    pub scene: Scene,
    pub instances: Vec<shared::Instance>,
    pub structures: Vec<(&'static str, Box<dyn Structure>)>,
    pub slot: usize,
    buffers: SceneBuffers,
}

impl<'a> Traced<'a> {
    /// Node transforms at time 0.
    pub fn new(gpu: &'a Gpu, mut scene: Scene) -> Self {
        let trees = accel::order_scene(&mut scene);
        let buffers = SceneBuffers::new(gpu, &scene).unwrap();
        let geometry = Geometry { scene: &scene, meshes: &buffers.meshes, trees: &trees, frames_in_flight: SLOTS };
        let entries = REGISTRY.iter().filter(|entry| (entry.available)(gpu.capabilities()).is_ok());
        let structures = entries.map(|entry| (entry.stem, (entry.build)(gpu, &geometry).unwrap())).collect();
        let instances = placed_instances(&scene);
        let mut traced = Self { gpu, scene, instances, structures, slot: 0, buffers };
        traced.update(0);
        traced
    }

    /// After `instances` have moved: the next traces are those of frame slot `slot`.
    pub fn update(&mut self, slot: usize) {
        self.slot = slot;
        for (_, structure) in &mut self.structures {
            self.gpu.submit_once(|commands| structure.update(commands, slot, &self.instances)).unwrap();
        }
    }

    /// Hits of the structure whose GLSL file is called `stem`. `constants` are specialization constants.
    pub fn trace(&self, stem: &str, rays: &[Ray], any_hit: bool, constants: &[(u32, u32)]) -> Vec<Hit> {
        self.run(stem, &KERNEL.replace("ANY_HIT", &any_hit.to_string()), rays, constants)
    }

    /// Outputs of a kernel that traces rays itself.
    pub fn run<I: Pod, O: Pod>(&self, stem: &str, kernel: &str, inputs: &[I], constants: &[(u32, u32)]) -> Vec<O> {
        let structure = &self.structures.iter().find(|(name, _)| *name == stem).expect("the device has the structure").1;
        let instances = self.gpu.upload("instances", &self.instances, vk::BufferUsageFlags::empty()).unwrap();
        let bind = |set: &DescriptorSet| structure.bind(self.slot, set);
        let options = KernelOptions {
            defines: shader_compiler::structure_defines(stem),
            constants: with_defaults(constants, structure.constants()),
            frame: self.frame(&instances, structure.root(self.slot)),
            bind_structure: Some(&bind),
            ..Default::default()
        };
        run_kernel_with(self.gpu, kernel, inputs, &options)
    }

    pub fn closest(&self, stem: &str, rays: &[Ray]) -> Vec<Hit> {
        self.trace(stem, rays, false, &self.alpha_constants())
    }

    fn frame(&self, instances: &Buffer, accel: u64) -> FrameData {
        FrameData {
            meshes: self.buffers.mesh_buffer.address(),
            instances: instances.address(),
            materials: self.buffers.material_buffer.address(),
            accel,
            ..Default::default()
        }
    }

    /// Alpha is compiled in where the scene has some; textures are not bound here.
    pub fn alpha_constants(&self) -> Vec<(u32, u32)> {
        let alpha = u32::from(self.scene.materials.iter().any(|material| material.alpha_mode != AlphaMode::Opaque));
        vec![(5, 0), (7, alpha), (8, alpha)]
    }
}

/// The scene's instances as a frame has them, relative to the world's origin.
fn placed_instances(scene: &Scene) -> Vec<shared::Instance> {
    let locals: Vec<Local> = scene.nodes.iter().map(|node| node.local).collect();
    let world = world_transforms(&scene.nodes, &locals);
    scene.instances.iter().map(|instance| placed(instance.mesh, &world[instance.node as usize], has_alpha(scene, instance.mesh))).collect()
}

fn has_alpha(scene: &Scene, mesh: u32) -> bool {
    let materials = &scene.meshes[mesh as usize].triangle_materials;
    materials.iter().any(|&material| scene.materials[material as usize].alpha_mode != AlphaMode::Opaque)
}

pub fn placed(mesh: u32, world: &DMat4, alpha: bool) -> shared::Instance {
    let rows = |matrix: &DMat4| [0, 1, 2].map(|row| matrix.row(row).as_vec4().to_array());
    shared::Instance {
        object_to_world: rows(world),
        world_to_object: rows(&world.inverse()),
        previous_object_to_world: rows(world),
        mesh,
        first_light: u32::MAX,
        flags: if alpha { shared::INSTANCE_ALPHA } else { 0 },
        ..Default::default()
    }
}

/// A scene of these meshes, each with the transforms of its instances.
pub fn scene_of(meshes: Vec<(Mesh, Vec<DMat4>)>) -> Scene {
    let mut scene = Scene::default();
    for (index, (mesh, transforms)) in meshes.into_iter().enumerate() {
        for transform in transforms {
            scene.instances.push(Instance { mesh: index as u32, node: scene.nodes.len() as u32 });
            scene.nodes.push(Node { name: String::new(), parent: None, local: Local::Matrix(transform) });
        }
        scene.meshes.push(mesh);
    }
    scene.materials.push(Default::default());
    scene
}

/// A mesh without anything that tracing does not look at.
pub fn mesh_of(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Mesh {
    let normals = vec![[0.0, 1.0, 0.0]; positions.len()];
    Mesh { normals, triangle_materials: vec![0; triangles.len()], positions, triangles, ..Mesh::default() }
}

/// Closed: 20 * 4^levels triangles around the origin, radius about 1, with bumps so that no symmetry helps.
pub fn bumpy_sphere(levels: u32) -> Mesh {
    let phi = (1.0 + 5f64.sqrt()) / 2.0;
    let mut points: Vec<DVec3> = [(1.0, phi), (-1.0, phi), (1.0, -phi), (-1.0, -phi)]
        .iter()
        .flat_map(|&(a, b)| [DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)])
        .map(DVec3::normalize)
        .collect();
    let near = |a: DVec3, b: DVec3| a.distance(b) < 1.2;
    let mut triangles = Vec::new();
    for a in 0..12u32 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [p, q, r] = [a, b, c].map(|i| points[i as usize]);
                if near(p, q) && near(q, r) && near(r, p) {
                    triangles.push([a, b, c]);
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]).normalize());
                points.len() as u32 - 1
            })
        };
        let split = triangles.iter().flat_map(|&[a, b, c]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        });
        triangles = split.collect();
    }
    let bump = |p: &DVec3| (*p * (1.0 + 0.1 * (7.0 * p.x + 5.0 * p.y * p.z).sin())).as_vec3().to_array();
    mesh_of(points.iter().map(bump).collect(), triangles)
}

/// Rays from and to anywhere within `bounds` grown by a tenth; every eighth along an axis, every sixteenth with an end.
pub fn random_rays(rng: &mut impl Rng, bounds: (DVec3, DVec3), count: usize) -> Vec<Ray> {
    let margin = (bounds.1 - bounds.0) * 0.1 + 1e-3;
    let (low, high) = (bounds.0 - margin, bounds.1 + margin);
    let mut point = || low + (high - low) * DVec3::new(rng.random(), rng.random(), rng.random());
    let mut ray = |index: usize| {
        let (from, to) = (point(), point());
        let mut direction = (to - from).normalize();
        if index.is_multiple_of(8) {
            direction = DVec3::AXES[index / 8 % 3] * if (index / 24).is_multiple_of(2) { 1.0 } else { -1.0 };
        }
        let t_max = if index % 16 == 1 { from.distance(to) } else { f64::from(f32::MAX) };
        Ray {
            origin: from.as_vec3().to_array(),
            t_min: 0.0,
            direction: direction.as_vec3().to_array(),
            t_max: t_max as f32,
            alpha_seed: index as u32,
        }
    };
    (0..count).map(&mut ray).collect()
}

/// All triangles in the world, in double precision.
pub struct Oracle {
    /// Instance, primitive, corners.
    triangles: Vec<(u32, u32, [DVec3; 3])>,
}

/// A hit in double precision, with how sure it is.
#[derive(Debug, Clone, Copy)]
pub struct ExactHit {
    pub t: f64,
    pub instance: u32,
    pub primitive: u32,
    /// Of all three corners.
    pub barycentrics: [f64; 3],
    /// Cosine between ray and normal, positive.
    pub cosine: f64,
}

impl Oracle {
    pub fn new(traced: &Traced) -> Self {
        let mut triangles = Vec::new();
        for (instance, placed) in (0..).zip(&traced.instances) {
            let mesh = &traced.scene.meshes[placed.mesh as usize];
            let rows = placed.object_to_world.map(|row| DVec4::from_array(row.map(f64::from)));
            let place = |vertex: u32| {
                let p = DVec3::from_array(mesh.positions[vertex as usize].map(f64::from)).extend(1.0);
                DVec3::from_array(rows.map(|row| row.dot(p)))
            };
            triangles.extend((0..).zip(&mesh.triangles).map(|(primitive, corners)| (instance, primitive, corners.map(place))));
        }
        Self { triangles }
    }

    pub fn bounds(&self) -> (DVec3, DVec3) {
        let corners = || self.triangles.iter().flat_map(|(_, _, corners)| corners).copied();
        (corners().fold(DVec3::INFINITY, DVec3::min), corners().fold(DVec3::NEG_INFINITY, DVec3::max))
    }

    /// The hit with one triangle's plane, in or out of the triangle.
    pub fn plane_hit(&self, ray: &Ray, instance: u32, primitive: u32) -> Option<ExactHit> {
        let found = self.triangles.iter().find(|(i, p, _)| (*i, *p) == (instance, primitive));
        found.and_then(|(_, _, corners)| intersect(ray, corners)).map(|hit| ExactHit { instance, primitive, ..hit })
    }

    pub fn closest(&self, ray: &Ray) -> Option<ExactHit> {
        let inside = |hit: &ExactHit| hit.barycentrics.iter().all(|&b| b >= 0.0) && hit.t > ray.t_min.into() && hit.t < ray.t_max.into();
        let hits = self.triangles.iter().filter_map(|(instance, primitive, corners)| {
            intersect(ray, corners).map(|hit| ExactHit { instance: *instance, primitive: *primitive, ..hit })
        });
        hits.filter(inside).min_by(|a, b| a.t.total_cmp(&b.t))
    }
}

/// Where the ray meets the triangle's plane; nothing where they are parallel.
fn intersect(ray: &Ray, corners: &[DVec3; 3]) -> Option<ExactHit> {
    let [origin, direction] = [ray.origin, ray.direction].map(|v| DVec3::from_array(v.map(f64::from)));
    let [a, b, c] = corners.map(|corner| corner - origin);
    let edges = [direction.dot(c.cross(b)), direction.dot(a.cross(c)), direction.dot(b.cross(a))];
    let sum: f64 = edges.iter().sum();
    let normal = (b - a).cross(c - a);
    let barycentrics = edges.map(|edge| edge / sum);
    let t = a.dot(normal) / direction.dot(normal);
    let cosine = (direction.dot(normal) / normal.length()).abs();
    t.is_finite().then_some(ExactHit { t, instance: 0, primitive: 0, barycentrics, cosine })
}

/// `constants`, and those of `defaults` that they leave open.
fn with_defaults(constants: &[(u32, u32)], defaults: Vec<(u32, u32)>) -> Vec<(u32, u32)> {
    let open = defaults.into_iter().filter(|(id, _)| constants.iter().all(|(given, _)| given != id));
    constants.iter().copied().chain(open).collect()
}
