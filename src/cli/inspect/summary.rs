//! What is in a scene, in numbers.

use crate::scene::effects::EffectSet;
use crate::scene::transform::world_transforms;
use crate::scene::{Environment, LightKind, Projection, Scene, Texture, Warning};
use glam::{DMat4, DVec3};
use serde::Serialize;
use std::fmt;

#[derive(Debug, Serialize)]
pub struct Summary {
    version: u32,
    name: String,
    meshes: usize,
    /// Stored, and as rays meet them: a shared mesh counts as often as it is placed.
    triangles: u64,
    instanced_triangles: u64,
    instances: usize,
    nodes: usize,
    materials: usize,
    textures: Textures,
    lights: Lights,
    cameras: Vec<Camera>,
    animation: Animation,
    environment: String,
    /// World space at time 0, metres.
    bounds: Bounds,
    diffuse_only: bool,
    effects: Vec<Effect>,
    warnings: Vec<Warning>,
}

#[derive(Debug, Serialize)]
struct Textures {
    count: usize,
    /// With their mip levels, 4 bytes a texel.
    bytes: u64,
    largest: [u32; 2],
}

#[derive(Debug, Default, Serialize)]
struct Lights {
    point: usize,
    sphere: usize,
    spot: usize,
    directional: usize,
    /// Triangles of an emissive material, in all instances.
    emissive_triangles: u64,
}

#[derive(Debug, Serialize)]
struct Camera {
    name: String,
    projection: &'static str,
    /// Metres, at time 0.
    position: [f64; 3],
    /// Perspective only.
    vfov_degrees: Option<f32>,
}

#[derive(Debug, Serialize)]
struct Animation {
    seconds: f64,
    animated_nodes: usize,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct Bounds {
    min: [f64; 3],
    max: [f64; 3],
}

#[derive(Debug, Serialize)]
struct Effect {
    name: &'static str,
    reason: String,
}

impl Summary {
    pub fn of(scene: &Scene) -> Self {
        let world = world_transforms(&scene.nodes, &scene.animation.sample(&scene.nodes, 0.0));
        let triangles = |mesh: u32| scene.meshes[mesh as usize].triangles.len() as u64;
        let effects = EffectSet::derive(scene);
        Self {
            version: 1,
            name: scene.name.clone(),
            meshes: scene.meshes.len(),
            triangles: scene.meshes.iter().map(|mesh| mesh.triangles.len() as u64).sum(),
            instanced_triangles: scene.instances.iter().map(|instance| triangles(instance.mesh)).sum(),
            instances: scene.instances.len(),
            nodes: scene.nodes.len(),
            materials: scene.materials.len(),
            textures: textures(&scene.textures),
            lights: lights(scene),
            cameras: cameras(scene, &world),
            animation: Animation { seconds: scene.animation.duration(), animated_nodes: scene.animation.animated_nodes().len() },
            environment: match &scene.environment {
                Environment::Constant(radiance) if *radiance == [0.0; 3] => "none".to_owned(),
                Environment::Constant([r, g, b]) => format!("constant {r}, {g}, {b}"),
                Environment::Map { width, height, .. } => format!("map of {width}x{height}"),
            },
            bounds: bounds(scene, &world),
            diffuse_only: effects.is_diffuse_only(),
            effects: effects.iter().map(|(effect, reason)| Effect { name: effect.name(), reason: reason.to_owned() }).collect(),
            warnings: scene.warnings.clone(),
        }
    }
}

fn textures(textures: &[Texture]) -> Textures {
    Textures {
        count: textures.len(),
        bytes: textures.iter().flat_map(|texture| &texture.mips).map(|mip| mip.len() as u64).sum(),
        largest: textures
            .iter()
            .map(|texture| [texture.width, texture.height])
            .max_by_key(|[w, h]| u64::from(*w) * u64::from(*h))
            .unwrap_or_default(),
    }
}

fn lights(scene: &Scene) -> Lights {
    let mut lights = Lights::default();
    for light in &scene.lights {
        *match light.kind {
            LightKind::Point => &mut lights.point,
            LightKind::Sphere { .. } => &mut lights.sphere,
            LightKind::Spot { .. } => &mut lights.spot,
            LightKind::Directional => &mut lights.directional,
        } += 1;
    }
    let emits: Vec<bool> = scene.materials.iter().map(|material| material.is_emissive()).collect();
    let emissive: Vec<u64> = scene
        .meshes
        .iter()
        .map(|mesh| mesh.triangle_materials.iter().filter(|&&material| emits[material as usize]).count() as u64)
        .collect();
    lights.emissive_triangles = scene.instances.iter().map(|instance| emissive[instance.mesh as usize]).sum();
    lights
}

fn cameras(scene: &Scene, world: &[DMat4]) -> Vec<Camera> {
    let describe = |camera: &crate::scene::Camera| Camera {
        name: camera.name.clone(),
        projection: match camera.projection {
            Projection::Perspective { .. } => "perspective",
            Projection::Orthographic { .. } => "orthographic",
        },
        position: world[camera.node as usize].w_axis.truncate().to_array(),
        vfov_degrees: match camera.projection {
            Projection::Perspective { yfov } => Some(yfov.to_degrees()),
            Projection::Orthographic { .. } => None,
        },
    };
    scene.cameras.iter().map(describe).collect()
}

fn bounds(scene: &Scene, world: &[DMat4]) -> Bounds {
    let points = scene.instances.iter().flat_map(|instance| {
        let to_world = world[instance.node as usize];
        scene.meshes[instance.mesh as usize].positions.iter().map(move |&p| to_world.transform_point3(glam::Vec3::from(p).as_dvec3()))
    });
    let (min, max) = points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), p| (min.min(p), max.max(p)));
    Bounds { min: min.to_array(), max: max.to_array() }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let lights = &self.lights;
        let [low, high] = [self.bounds.min, self.bounds.max].map(|p| p.map(|x| format!("{x:.3}")).join(", "));
        writeln!(f, "{}", self.name)?;
        writeln!(f, "  meshes       {} with {} triangles", self.meshes, self.triangles)?;
        writeln!(f, "  instances    {} with {} triangles, placed by {} nodes", self.instances, self.instanced_triangles, self.nodes)?;
        writeln!(f, "  materials    {}", self.materials)?;
        writeln!(f, "  textures     {}", self.textures)?;
        writeln!(
            f,
            "  lights       {} point, {} sphere, {} spot, {} directional, {} emissive triangles",
            lights.point, lights.sphere, lights.spot, lights.directional, lights.emissive_triangles
        )?;
        writeln!(f, "  environment  {}", self.environment)?;
        for camera in &self.cameras {
            writeln!(f, "  camera       {camera}")?;
        }
        writeln!(f, "  animation    {:.2} s, {} nodes", self.animation.seconds, self.animation.animated_nodes)?;
        writeln!(f, "  bounds       ({low}) to ({high}) m")?;
        writeln!(f, "effects{}", if self.diffuse_only { ": surfaces are diffuse only" } else { "" })?;
        for effect in &self.effects {
            writeln!(f, "  {}: {}", effect.name, effect.reason)?;
        }
        for warning in &self.warnings {
            writeln!(f, "warning: {} ({})", warning.message, warning.count)?;
        }
        Ok(())
    }
}

impl fmt::Display for Textures {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [width, height] = self.largest;
        match self.count {
            0 => write!(f, "none"),
            count => write!(f, "{count} with {:.1} MiB, the largest {width}x{height}", self.bytes as f64 / (1 << 20) as f64),
        }
    }
}

impl fmt::Display for Camera {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let position = self.position.map(|x| format!("{x:.3}")).join(", ");
        write!(f, "'{}', {}, at ({position})", self.name, self.projection)?;
        self.vfov_degrees.map_or(Ok(()), |degrees| write!(f, ", {degrees:.1} degrees high"))
    }
}
