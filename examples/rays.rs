//! Mray/s of every acceleration structure on primary, diffuse and any-hit rays, with Embree beside them: `ci/rays` runs it.
//!
//! The same 262,144 rays everywhere; structures and Embree take turns, so that what else runs on the machine slows all of them
//! alike; medians. Embree sees one flat mesh, the structures the scene's instances.

use anyhow::{Context, Result};
use bytemuck::Pod;
use glam::{DVec3, DVec4, Vec3};
use pathspace::accel::{self, Geometry, REGISTRY, Structure};
use pathspace::frame::{Globals, GlobalsInfo};
use pathspace::gpu::{Buffer, ComputePipeline, DescriptorSet, DeviceOptions, Gpu, MemoryLocation, Timer, vk};
use pathspace::scene::transform::world_transforms;
use pathspace::scene::upload::SceneBuffers;
use pathspace::scene::{Local, Projection, Scene, builtin, gltf};
use pathspace::shared::{FrameData, Instance, Parameters};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Instant;

/// Pixels of the image whose rays are traced, in tiles of 8 x 8, as a workgroup would.
const EDGE: usize = 512;
const ROUNDS: usize = 9;
const KINDS: [&str; 3] = ["primary", "diffuse", "any-hit"];

const KERNEL: &str = r#"
#include "accel/trace.glsl"
layout(local_size_x = 64) in;
layout(buffer_reference, scalar) readonly buffer Rays { Ray at[]; };
struct Result { uint found; Hit hit; };
layout(buffer_reference, scalar) writeonly buffer Results { Result at[]; };
layout(push_constant, scalar) uniform Push { Rays rays; Results results; uint any_hit; } push;
void main() {
    uint i = gl_GlobalInvocationID.x;
    Hit hit = Hit(0.0, 0, 0, vec2(0.0));
    bool found = accel_trace(push.rays.at[i], push.any_hit != 0, 0, hit);
    push.results.at[i] = Result(uint(found), hit);
}
"#;

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Ray {
    origin: [f32; 3],
    t_min: f32,
    direction: [f32; 3],
    t_max: f32,
}

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Hit {
    found: u32,
    t: f32,
    instance: u32,
    primitive: u32,
    barycentrics: [f32; 2],
}

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let python = arguments.next().context("usage: rays PYTHON SCRIPT SCENE...")?;
    let script = arguments.next().context("usage: rays PYTHON SCRIPT SCENE...")?;
    let gpu = Gpu::open(&DeviceOptions::default())?;
    println!("{}; Mray/s {}, medians of {ROUNDS}", gpu.capabilities().name, KINDS.join(" / "));
    for scene in arguments {
        measure(&gpu, &scene, &python, &script).with_context(|| format!("scene '{scene}'"))?;
    }
    Ok(())
}

fn load(scene: &str) -> Result<Scene> {
    Ok(match builtin::find(scene)? {
        Some(request) => request.load()?,
        None => gltf::load(Path::new(scene))?,
    })
}

fn measure(gpu: &Gpu, spec: &str, python: &str, script: &str) -> Result<()> {
    let mut scene = load(spec)?;
    let triangles: usize = scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    let start = Instant::now();
    let trees = accel::order_scene(&mut scene);
    let seconds = start.elapsed().as_secs_f64();
    println!("\n{spec}: {triangles} triangles in {seconds:.3} s, {:.2} M triangles/s", triangles as f64 * 1e-6 / seconds);
    let buffers = SceneBuffers::new(gpu, &scene)?;
    let geometry = Geometry { scene: &scene, meshes: &buffers.meshes, trees: &trees, frames_in_flight: 1 };
    let world = world_transforms(&scene.nodes, &scene.nodes.iter().map(|node| node.local).collect::<Vec<Local>>());
    let instances: Vec<Instance> = scene.instances.iter().map(|instance| placed(instance.mesh, &world[instance.node as usize])).collect();
    let mut tracers = Vec::new();
    for entry in REGISTRY.iter().filter(|entry| (entry.available)(gpu.capabilities()).is_ok()) {
        tracers.push(Tracer::new(gpu, entry, &geometry, &buffers, &instances)?);
    }
    let corners = corners(&scene, &instances);
    let rays = make_rays(&scene, &world, &corners, &tracers[0])?;
    let mut embree = Embree::start(python, script, &corners, &rays)?;
    let mut rates = vec![[0.0; 3]; tracers.len() + 1];
    for (kind, rays) in rays.iter().enumerate() {
        let mut times = vec![Vec::new(); tracers.len() + 1];
        for _ in 0..ROUNDS {
            for (tracer, times) in tracers.iter().zip(&mut times) {
                times.push(tracer.trace(rays, kind == 2)?.0);
            }
            times[tracers.len()].push(embree.seconds(KINDS[kind])?);
        }
        for (rates, times) in rates.iter_mut().zip(&mut times) {
            times.sort_by(f64::total_cmp);
            rates[kind] = rays.len() as f64 * 1e-6 / times[ROUNDS / 2];
        }
    }
    print(&tracers, &rates, triangles);
    Ok(())
}

fn print(tracers: &[Tracer], rates: &[[f64; 3]], triangles: usize) {
    let three = |values: [f64; 3]| values.map(|value| format!("{value:6.2}")).join(" / ");
    let ratio = |rates: &[f64; 3], other: &[f64; 3]| std::array::from_fn(|kind| rates[kind] / other[kind]);
    let embree = rates.last().expect("Embree comes last");
    let ray_query = tracers.iter().position(|tracer| tracer.name == "ray-query").map(|index| &rates[index]);
    for (tracer, rates) in tracers.iter().zip(rates) {
        let against = ray_query.map(|other| format!(", of ray-query {}", three(ratio(rates, other)))).unwrap_or_default();
        let bytes = tracer.structure.memory_bytes() as f64 / triangles as f64;
        println!("{:10} {}{against}, of Embree {}, {bytes:.0} bytes/triangle", tracer.name, three(*rates), three(ratio(rates, embree)));
    }
    println!("{:10} {}", "Embree", three(*embree));
}

/// A structure, ready to trace.
struct Tracer<'a> {
    gpu: &'a Gpu,
    name: &'static str,
    structure: Box<dyn Structure>,
    pipeline: ComputePipeline,
    globals: Globals,
    own: DescriptorSet,
    _instances: Buffer,
}

impl<'a> Tracer<'a> {
    fn new(gpu: &'a Gpu, entry: &accel::Entry, geometry: &Geometry, buffers: &SceneBuffers, instances: &[Instance]) -> Result<Self> {
        let mut structure = (entry.build)(gpu, geometry)?;
        gpu.submit_once(|commands| structure.update(commands, 0, instances))?;
        let bind_structure = |slot: usize, set: &DescriptorSet| structure.bind(slot, set);
        let info = GlobalsInfo { textures: &[], bind_structure: &bind_structure, frames_in_flight: 1 };
        let mut globals = Globals::new(gpu, &info)?;
        let instance_buffer = gpu.upload("instances", instances, vk::BufferUsageFlags::empty())?;
        let frame = FrameData {
            meshes: buffers.mesh_buffer.address(),
            instances: instance_buffer.address(),
            materials: buffers.material_buffer.address(),
            accel: structure.root(0),
            ..Default::default()
        };
        globals.write(0, &frame, &Parameters::default());
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders_glsl");
        let spirv = shader_compiler::compile(&root, entry.stem, KERNEL, &shader_compiler::structure_defines(entry.stem))?;
        // Opaque: alpha mask and blend are compiled out.
        let pipeline = ComputePipeline::new(gpu, entry.stem, &spirv, globals.layout(), &[(7, 0), (8, 0)])?;
        let own = DescriptorSet::new(pipeline.own_layout())?;
        Ok(Self { gpu, name: entry.name, structure, pipeline, globals, own, _instances: instance_buffer })
    }

    /// Seconds on the device, and what was hit.
    fn trace(&self, rays: &[Ray], any_hit: bool) -> Result<(f64, Vec<Hit>)> {
        let rays_buffer = self.gpu.upload("rays", rays, vk::BufferUsageFlags::empty())?;
        let bytes = size_of_val(rays) as u64 / size_of::<Ray>() as u64 * size_of::<Hit>() as u64;
        let hits = self.gpu.create_buffer("hits", bytes, vk::BufferUsageFlags::empty(), MemoryLocation::GpuOnly)?;
        let mut push = Vec::new();
        push.extend_from_slice(&rays_buffer.address().to_ne_bytes());
        push.extend_from_slice(&hits.address().to_ne_bytes());
        push.extend_from_slice(&u32::from(any_hit).to_ne_bytes());
        let mut timer = Timer::new(self.gpu, 2)?;
        self.gpu.submit_once(|commands| {
            timer.reset(commands);
            timer.mark(commands, 0);
            commands.dispatch(&self.pipeline, &[self.globals.set(0), &self.own], &push, self.pipeline.groups([rays.len() as u32, 1, 1]));
            timer.mark(commands, 1);
        })?;
        let milliseconds = timer.take().next().context("the device has no timestamps")?;
        Ok((milliseconds * 1e-3, self.gpu.download(&hits)?))
    }
}

fn placed(mesh: u32, world: &glam::DMat4) -> Instance {
    let rows = |matrix: &glam::DMat4| [0, 1, 2].map(|row| matrix.row(row).as_vec4().to_array());
    Instance { object_to_world: rows(world), world_to_object: rows(&world.inverse()), mesh, ..Default::default() }
}

/// World-space corners of every triangle, instance by instance.
fn corners(scene: &Scene, instances: &[Instance]) -> Vec<Vec<[Vec3; 3]>> {
    let of = |instance: &Instance| {
        let mesh = &scene.meshes[instance.mesh as usize];
        let rows = instance.object_to_world.map(|row| DVec4::from_array(row.map(f64::from)));
        let place = |vertex: u32| {
            let point = DVec3::from_array(mesh.positions[vertex as usize].map(f64::from)).extend(1.0);
            Vec3::from_array(rows.map(|row| row.dot(point) as f32))
        };
        mesh.triangles.iter().map(|triangle| triangle.map(place)).collect()
    };
    instances.iter().map(of).collect()
}

/// Primary rays of the scene's camera; from where they hit, one in a cosine-distributed direction, and one towards a random point
/// under the ceiling.
fn make_rays(scene: &Scene, world: &[glam::DMat4], corners: &[Vec<[Vec3; 3]>], tracer: &Tracer) -> Result<[Vec<Ray>; 3]> {
    let view = scene.default_camera_view(None, world)?;
    let half = match view.projection {
        Projection::Perspective { yfov } => f64::from(yfov / 2.0).tan(),
        Projection::Orthographic { .. } => 0.5,
    };
    let right = view.forward.cross(view.up);
    let primary_ray = |index: usize| {
        let (tile, place) = (index / 64, index % 64);
        let tiles = EDGE / 8;
        let (x, y) = (tile % tiles * 8 + place % 8, tile / tiles * 8 + place / 8);
        let ndc = |pixel: usize| (pixel as f64 + 0.5) / EDGE as f64 * 2.0 - 1.0;
        let direction = view.forward + right * ndc(x) * half - view.up * ndc(y) * half;
        Ray { origin: view.position.as_vec3().to_array(), t_min: 0.0, direction: direction.normalize().as_vec3().to_array(), t_max: 1e30 }
    };
    let primary: Vec<Ray> = (0..EDGE * EDGE).map(primary_ray).collect();
    let hits = tracer.trace(&primary, false)?.1;
    let (low, high) = scene.bounds(world).context("the scene is empty")?;
    let (low, high) = (low.as_vec3(), high.as_vec3());
    let mut rng = Pcg32::seed_from_u64(1);
    let (mut diffuse, mut shadow) = (Vec::new(), Vec::new());
    for (ray, hit) in primary.iter().zip(&hits) {
        // What misses is traced again, so that there are as many rays of each kind.
        let [a, b, c] =
            if hit.found == 1 { corners[hit.instance as usize][hit.primitive as usize] } else { [Vec3::ZERO, Vec3::X, Vec3::Y] };
        let direction = Vec3::from(ray.direction);
        let normal = (b - a).cross(c - a).normalize();
        let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
        let place = Vec3::from(ray.origin) + if hit.found == 1 { direction * hit.t + normal * 1e-3 } else { Vec3::ZERO };
        let height = rng.random_range(-1f32..1.0);
        let angle = rng.random_range(0.0..std::f32::consts::TAU);
        let sphere = Vec3::new(angle.cos(), angle.sin(), 0.0) * (1.0 - height * height).sqrt() + Vec3::Z * height;
        let bounce = (normal + 0.999 * sphere).normalize();
        let light = Vec3::new(rng.random_range(low.x..high.x), low.y + 0.8 * (high.y - low.y), rng.random_range(low.z..high.z)) - place;
        diffuse.push(Ray { origin: place.to_array(), t_min: 0.0, direction: bounce.to_array(), t_max: 1e30 });
        shadow.push(Ray { origin: place.to_array(), t_min: 0.0, direction: light.normalize().to_array(), t_max: light.length() });
    }
    Ok([primary, diffuse, shadow])
}

/// Embree in a Python process (ci/rays_embree.py), which waits while it is not asked.
struct Embree {
    process: Child,
    answers: BufReader<std::process::ChildStdout>,
    _files: tempfile::TempDir,
}

impl Embree {
    fn start(python: &str, script: &str, corners: &[Vec<[Vec3; 3]>], rays: &[Vec<Ray>; 3]) -> Result<Self> {
        let files = tempfile::tempdir()?;
        write(files.path(), "triangles", &corners.concat())?;
        for (kind, rays) in KINDS.iter().zip(rays) {
            write(files.path(), kind, rays)?;
        }
        let mut process = Command::new(python).arg(script).arg(files.path()).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let answers = BufReader::new(process.stdout.take().context("standard output is piped")?);
        Ok(Self { process, answers, _files: files })
    }

    fn seconds(&mut self, kind: &str) -> Result<f64> {
        writeln!(self.process.stdin.as_ref().context("standard input is piped")?, "{kind}")?;
        let mut line = String::new();
        self.answers.read_line(&mut line)?;
        line.trim().parse().context("Embree's process has ended")
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        drop(self.process.stdin.take());
        let _ = self.process.wait();
    }
}

fn write<T: Pod>(folder: &Path, name: &str, values: &[T]) -> Result<()> {
    Ok(std::fs::write(folder.join(format!("{name}.f32")), bytemuck::cast_slice(values))?)
}
