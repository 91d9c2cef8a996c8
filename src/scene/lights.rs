//! Everything that shines, as one list to choose from by power: punctual and sphere lights, the environment, emissive triangles.
//!
//! The list's order is fixed when built: sphere lights (lib/lights.glsl intersects rays with the first lights while they are spheres), other
//! punctual lights, the environment, then the emissive triangles of each instance, in the order of the instances. What moves is
//! refreshed in place; nothing is allocated after the first frame.

use super::alias::AliasBuilder;
use super::emission::mean_emission;
use super::{Light, LightKind, Mesh, Scene};
use crate::shared::{self, AliasEntry};
use glam::{DMat3, DMat4, DVec3};
use std::f64::consts::PI;

/// Largest probability of choosing the sole light where there are others, so that theirs does not vanish in rounding.
const MOST_SOLE_SHARE: f64 = 0.999;

/// Device data of all lights.
pub struct LightTable {
    lights: Vec<shared::Light>,
    /// The rest of the first of them.
    punctual_lights: Vec<shared::PunctualLight>,
    alias: Vec<AliasEntry>,
    /// Watts, mean of the channels, of each light.
    powers: Vec<f64>,
    builder: AliasBuilder,
    /// Scene light of each of the first lights.
    punctual: Vec<u32>,
    environment_light: u32,
    /// Index of [`sole_light`] among these; u32::MAX without.
    sole: u32,
    environment_integral: f64,
    emitters: Vec<Vec<Emitter>>,
    instances: Vec<InstanceLights>,
}

/// An emissive triangle of a mesh.
struct Emitter {
    primitive: u32,
    /// W/m^2: pi times the mean radiance, twice that where both sides shine.
    exitance: f64,
}

struct InstanceLights {
    /// u32::MAX where the mesh does not emit.
    first: u32,
    /// That the powers were computed for.
    linear: DMat3,
}

impl LightTable {
    /// `environment_integral`: see [`super::environment_distribution::EnvironmentDistribution`]. Powers are 0 until [`LightTable::refresh`].
    pub fn new(scene: &Scene, environment_integral: f64) -> Self {
        let mut punctual: Vec<u32> = (0..scene.lights.len() as u32).collect();
        punctual.sort_by_key(|&light| !matches!(scene.lights[light as usize].kind, LightKind::Sphere { .. }));
        let (mut lights, punctual_lights): (Vec<_>, Vec<_>) =
            punctual.iter().map(|&light| punctual_light(&scene.lights[light as usize])).unzip();
        let environment_light = if environment_integral > 0.0 { lights.len() as u32 } else { u32::MAX };
        if environment_integral > 0.0 {
            lights.push(shared::Light { kind: shared::LIGHT_ENVIRONMENT, ..Default::default() });
        }
        let emitters: Vec<Vec<Emitter>> = scene.meshes.iter().map(|mesh| mesh_emitters(scene, mesh)).collect();
        let mut instances = Vec::with_capacity(scene.instances.len());
        for (index, instance) in scene.instances.iter().enumerate() {
            let emitters = &emitters[instance.mesh as usize];
            let first = if emitters.is_empty() { u32::MAX } else { lights.len() as u32 };
            instances.push(InstanceLights { first, linear: DMat3::ZERO });
            lights.extend(emitters.iter().map(|emitter| shared::Light {
                kind: shared::LIGHT_TRIANGLE,
                instance: index as u32,
                primitive: emitter.primitive,
                ..Default::default()
            }));
        }
        let sole = sole_light(scene).and_then(|sole| punctual.iter().position(|&light| light == sole));
        let sole = sole.map_or(u32::MAX, |index| index as u32);
        let powers = vec![0.0; lights.len()];
        let (alias, builder) = (Vec::with_capacity(lights.len()), AliasBuilder::default());
        Self {
            lights,
            punctual_lights,
            alias,
            powers,
            builder,
            punctual,
            environment_light,
            sole,
            environment_integral,
            emitters,
            instances,
        }
    }

    /// Places all lights by `world`, the world matrix of each node, relative to `origin`, in a scene of `radius` metres, and chooses by their
    /// powers there.
    pub fn refresh(&mut self, scene: &Scene, world: &[DMat4], origin: DVec3, radius: f64) {
        for (slot, &light) in self.punctual.iter().enumerate() {
            let light = &scene.lights[light as usize];
            place(&mut self.punctual_lights[slot], &world[light.node as usize], origin);
            self.powers[slot] = punctual_power(light, radius);
        }
        if let Some(power) = self.powers.get_mut(self.environment_light as usize) {
            *power = PI * radius * radius * self.environment_integral;
        }
        for (lights, instance) in self.instances.iter_mut().zip(&scene.instances) {
            let linear = DMat3::from_mat4(world[instance.node as usize]);
            if lights.first != u32::MAX && lights.linear != linear {
                lights.linear = linear;
                let mesh = &scene.meshes[instance.mesh as usize];
                let emitters = &self.emitters[instance.mesh as usize];
                let powers = &mut self.powers[lights.first as usize..][..emitters.len()];
                for (power, emitter) in powers.iter_mut().zip(emitters) {
                    *power = emitter.exitance * triangle_area(mesh, emitter.primitive, &linear);
                }
            }
        }
        let of_sole = self.powers.get_mut(self.sole as usize).map_or(0.0, std::mem::take);
        let others = self.builder.build(&self.powers, &mut self.alias);
        let sole_share = if others > 0.0 { (of_sole / (of_sole + others)).min(MOST_SOLE_SHARE) } else { 1.0 };
        for (light, power) in self.lights.iter_mut().zip(&self.powers) {
            light.probability = if others > 0.0 { ((1.0 - sole_share) * power / others) as f32 } else { 0.0 };
        }
        if let Some(light) = self.lights.get_mut(self.sole as usize) {
            light.probability = sole_share as f32;
            self.powers[self.sole as usize] = of_sole;
        }
    }

    pub fn lights(&self) -> &[shared::Light] {
        &self.lights
    }

    /// What else there is to the first of them, those that are neither triangles nor the environment.
    pub fn punctual_lights(&self) -> &[shared::PunctualLight] {
        &self.punctual_lights
    }

    pub fn alias(&self) -> &[AliasEntry] {
        &self.alias
    }

    /// Entries of the table to choose from, in which the [`Self::sole`] light has no weight: 0 where nothing else shines.
    pub fn count(&self) -> u32 {
        self.alias.len() as u32
    }

    /// Index of [`sole_light`], u32::MAX where there is none, and the probability of choosing it: its share of all power.
    pub fn sole(&self) -> (u32, f32) {
        (self.sole, self.lights.get(self.sole as usize).map_or(0.0, |light| light.probability))
    }

    /// Index of the environment, u32::MAX where it is black.
    pub fn environment_light(&self) -> u32 {
        self.environment_light
    }

    /// [`shared::Instance::first_light`] of each instance.
    pub fn first_lights(&self) -> impl Iterator<Item = u32> {
        self.instances.iter().map(|instance| instance.first)
    }
}

/// The scene's light without a size, where there is only one that shines.
pub fn sole_light(scene: &Scene) -> Option<u32> {
    let shines = |light: &Light| !matches!(light.kind, LightKind::Sphere { .. }) && light.color.iter().any(|&x| x > 0.0);
    let mut lights = (0..).zip(&scene.lights).filter(|(_, light)| shines(light)).map(|(index, _)| index);
    lights.next().filter(|_| lights.next().is_none())
}

/// [`shared::Mesh::triangle_emitters`] of each mesh: the rank of each triangle among those that emit, u32::MAX for the others. Empty where
/// none emits.
pub fn emitter_ranks(scene: &Scene) -> Vec<Vec<u32>> {
    let ranks = |mesh: &Mesh| {
        let mut next = 0..;
        let rank = |primitive| if emits(scene, mesh, primitive) { next.next().unwrap_or(u32::MAX) } else { u32::MAX };
        let ranks: Vec<u32> = (0..mesh.triangles.len()).map(rank).collect();
        if ranks.iter().all(|&rank| rank == u32::MAX) { Vec::new() } else { ranks }
    };
    scene.meshes.iter().map(ranks).collect()
}

fn emits(scene: &Scene, mesh: &Mesh, primitive: usize) -> bool {
    let material = &scene.materials[mesh.triangle_materials[primitive] as usize];
    material.is_emissive() && !material.unlit
}

fn mesh_emitters(scene: &Scene, mesh: &Mesh) -> Vec<Emitter> {
    let emitter = |primitive: usize| {
        let material = &scene.materials[mesh.triangle_materials[primitive] as usize];
        let sides = if material.double_sided { 2.0 } else { 1.0 };
        Emitter { primitive: primitive as u32, exitance: sides * PI * mean_emission(scene, mesh, primitive) }
    };
    (0..mesh.triangles.len()).filter(|&primitive| emits(scene, mesh, primitive)).map(emitter).collect()
}

/// Square metres in the world.
fn triangle_area(mesh: &Mesh, primitive: u32, linear: &DMat3) -> f64 {
    let [a, b, c] = mesh.triangles[primitive as usize].map(|corner| DVec3::from_array(mesh.positions[corner as usize].map(f64::from)));
    let area = 0.5 * (*linear * (b - a)).cross(*linear * (c - a)).length();
    if area.is_finite() { area } else { 0.0 }
}

/// All but where it is and how likely.
fn punctual_light(light: &super::Light) -> (shared::Light, shared::PunctualLight) {
    let mut packed = shared::PunctualLight {
        emission: light.color,
        inverse_range: light.range.map_or(0.0, |range| 1.0 / range),
        direction: [0.0, -1.0, 0.0],
        ..Default::default()
    };
    let kind = match light.kind {
        LightKind::Point => shared::LIGHT_POINT,
        LightKind::Directional => shared::LIGHT_DIRECTIONAL,
        LightKind::Sphere { radius } => {
            packed.radius = radius;
            packed.emission = light.color.map(|channel| (f64::from(channel) / (PI * f64::from(radius).powi(2))) as f32);
            shared::LIGHT_SPHERE
        }
        // KHR_lights_punctual, "Inner and Outer Cone Angles".
        LightKind::Spot { inner_cone_angle, outer_cone_angle } => {
            let (inner, outer) = (inner_cone_angle.cos(), outer_cone_angle.cos());
            packed.cone_scale = 1.0 / (inner - outer).max(1e-3);
            packed.cone_offset = -outer * packed.cone_scale;
            shared::LIGHT_SPOT
        }
    };
    (shared::Light { kind, ..Default::default() }, packed)
}

fn place(light: &mut shared::PunctualLight, world: &DMat4, origin: DVec3) {
    light.position = (world.w_axis.truncate() - origin).as_vec3().to_array();
    if let Some(direction) = (-world.z_axis.truncate()).try_normalize() {
        light.direction = direction.as_vec3().to_array();
    }
}

/// Watts, mean of the channels. A directional light's is what falls on the scene's bounding sphere.
fn punctual_power(light: &super::Light, radius: f64) -> f64 {
    let mean = light.color.map(f64::from).iter().sum::<f64>() / 3.0;
    match light.kind {
        LightKind::Point | LightKind::Sphere { .. } => 4.0 * PI * mean,
        LightKind::Spot { inner_cone_angle, outer_cone_angle } => {
            let (inner, outer) = (f64::from(inner_cone_angle).cos(), f64::from(outer_cone_angle).cos());
            2.0 * PI * mean * ((1.0 - inner) + (inner - outer) / 3.0)
        }
        LightKind::Directional => PI * radius * radius * mean,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Instance, Light, Local, Material, Node};

    /// A square of 2 x 2 m of two emissive triangles and one that is not, placed twice; a spot, a sphere and a point light.
    fn scene() -> Scene {
        let node = || Node { name: String::new(), parent: None, local: Local::Matrix(DMat4::IDENTITY) };
        let light = |kind| Light { name: String::new(), node: 0, color: [1.0, 2.0, 3.0], kind, range: None };
        let square = Mesh {
            positions: vec![[0.0; 3], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]],
            triangles: vec![[0, 1, 2], [0, 1, 3], [0, 2, 3]],
            triangle_materials: vec![1, 0, 1],
            ..Default::default()
        };
        Scene {
            meshes: vec![Mesh { triangles: vec![[0, 1, 2]], triangle_materials: vec![0], ..square.clone() }, square],
            materials: vec![Material::default(), Material { emission: [3.0, 3.0, 6.0], ..Default::default() }],
            nodes: vec![node(), node()],
            instances: vec![Instance { mesh: 1, node: 0 }, Instance { mesh: 0, node: 0 }, Instance { mesh: 1, node: 1 }],
            lights: vec![
                light(LightKind::Spot { inner_cone_angle: 0.2, outer_cone_angle: 0.5 }),
                light(LightKind::Sphere { radius: 0.5 }),
                light(LightKind::Point),
            ],
            ..Default::default()
        }
    }

    fn refreshed(scene: &Scene, world: [DMat4; 2]) -> LightTable {
        let mut table = LightTable::new(scene, 0.5);
        table.refresh(scene, &world, DVec3::new(10.0, 0.0, 0.0), 3.0);
        table
    }

    #[test]
    fn spheres_come_first_and_instances_know_their_first_triangle() {
        let table = refreshed(&scene(), [DMat4::IDENTITY; 2]);
        let kinds: Vec<u32> = table.lights().iter().map(|light| light.kind).collect();
        let triangle = shared::LIGHT_TRIANGLE;
        let expected = [shared::LIGHT_SPHERE, shared::LIGHT_SPOT, shared::LIGHT_POINT, shared::LIGHT_ENVIRONMENT];
        assert_eq!(kinds[..4], expected);
        assert_eq!(kinds[4..], [triangle; 4]);
        assert_eq!(table.first_lights().collect::<Vec<_>>(), [4, u32::MAX, 6]);
        assert_eq!(emitter_ranks(&scene())[1], [0, u32::MAX, 1]);
        assert!(emitter_ranks(&scene())[0].is_empty());
        assert_eq!((table.lights()[7].instance, table.lights()[7].primitive), (2, 2));
    }

    /// The second square is scaled by 3, so it has 9 times the area.
    #[test]
    fn lights_are_chosen_by_their_power_in_the_world() {
        let table = refreshed(&scene(), [DMat4::IDENTITY, DMat4::from_scale(DVec3::splat(3.0))]);
        let spot = 2.0 * PI * 2.0 * ((1.0 - 0.2f64.cos()) + (0.2f64.cos() - 0.5f64.cos()) / 3.0);
        let (triangle, environment) = (PI * 4.0 * 2.0, PI * 9.0 * 0.5);
        let powers = [8.0 * PI, spot, 8.0 * PI, environment, triangle, triangle, 9.0 * triangle, 9.0 * triangle];
        let sum: f64 = powers.iter().sum();
        for (light, power) in table.lights().iter().zip(powers) {
            let expected = power / sum;
            assert!((f64::from(light.probability) / expected - 1.0).abs() < 1e-6, "{light:?}: {expected}");
        }
    }

    #[test]
    fn a_sphere_light_has_the_radiance_of_its_intensity_and_follows_its_node() {
        let table = refreshed(&scene(), [DMat4::from_translation(DVec3::new(11.0, 2.0, 0.0)), DMat4::IDENTITY]);
        let sphere = table.punctual_lights()[0];
        assert!((f64::from(sphere.emission[2]) - 3.0 / (PI * 0.25)).abs() < 1e-6);
        assert_eq!(sphere.position, [1.0, 2.0, 0.0]);
        assert_eq!(sphere.direction, [0.0, 0.0, -1.0]);
    }

    #[test]
    fn refreshing_moved_lights_allocates_nothing() {
        let scene = scene();
        let mut table = refreshed(&scene, [DMat4::IDENTITY; 2]);
        let places = |table: &LightTable| (table.lights.as_ptr(), table.alias.as_ptr(), table.alias.capacity(), table.powers.as_ptr());
        let before = places(&table);
        for step in 1..10 {
            table.refresh(&scene, &[DMat4::from_scale(DVec3::splat(f64::from(step))); 2], DVec3::ZERO, 3.0);
        }
        assert_eq!(places(&table), before);
    }

    #[test]
    fn a_dark_scene_has_no_light_to_choose() {
        let mut dark = scene();
        dark.materials[1].emission = [0.0; 3];
        dark.lights.clear();
        let mut table = LightTable::new(&dark, 0.0);
        table.refresh(&dark, &[DMat4::IDENTITY; 2], DVec3::ZERO, 1.0);
        assert_eq!((table.count(), table.environment_light()), (0, u32::MAX));
    }
}
