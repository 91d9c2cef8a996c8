//! Light sampling: chosen by its stated probability, its density the one that multiple importance sampling is told, and its mean the
//! irradiance of each light's formula.

use crate::common::{self, KernelOptions};
use bytemuck::{Pod, Zeroable};
use glam::{DMat4, DVec3};
use pathspace::gpu::{Buffer, Gpu, vk};
use pathspace::metrics::statistics::{chi_square_test, sidak};
use pathspace::scene::environment_distribution::EnvironmentDistribution;
use pathspace::scene::lights::{LightTable, emitter_ranks};
use pathspace::scene::{Environment, Instance, Light, LightKind, Local, Material, Mesh, Node, Scene};
use pathspace::shared::{self, FrameData};
use std::f64::consts::PI;

/// Samples of each input, of 256 u.
const KERNEL: &str = "
#include \"lib/lights.glsl\"
#include \"lib/rng.glsl\"
struct In { vec3 position; uint seed; uint apart; };
struct Out { vec3 direction; float distance; vec3 radiance; float pdf; uint light; uint valid; float same_pdf; };
vec3 emitted_radiance(uint instance, uint primitive, vec2 barycentrics) {
    return vec3(1.0, 2.0, 3.0);
}
/// What a ray that finds the light by itself is told.
float found_pdf(LightSample s, vec3 position) {
    Light light = LightBuffer(frame.lights).at[s.light];
    float pdf = 0.0;
    if (light.kind == LIGHT_TRIANGLE) {
        triangle_light_pdf(light.instance, light.primitive, s.direction, s.distance, pdf);
    } else if (light.kind == LIGHT_SPHERE) {
        float t;
        uint found;
        if (intersect_sphere_lights(Ray(position, 0.0, s.direction, FAR_AWAY), t, found) && found == s.light) {
            sphere_light_radiance(found, position, t, pdf);
        }
    } else if (light.kind == LIGHT_ENVIRONMENT) {
        pdf = environment_pdf(s.direction);
    }
    return pdf;
}
void kernel(uint i) {
    uvec4 bits = pcg4d(uvec4(i, inputs[i].seed, 3u, 4u));
    LightSample s;
    bool valid = sample_light(inputs[i].position, vec4(unit_float(bits.xy), unit_float(bits.zw)), inputs[i].apart == 1u, s);
    // A ray that finds a light is not told that the sole one is apart: paths/path.glsl takes it into account.
    s.pdf *= inputs[i].apart == 1u ? 1.0 - frame.sole_probability : 1.0;
    float same = valid && !s.delta ? found_pdf(s, inputs[i].position) : s.pdf;
    outputs[i] = Out(s.direction, s.distance, s.radiance, s.pdf, s.light, valid ? 1u : 0u, same);
}
";

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct In {
    position: [f32; 3],
    seed: u32,
    apart: u32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Out {
    direction: [f32; 3],
    distance: f32,
    radiance: [f32; 3],
    pdf: f32,
    light: u32,
    valid: u32,
    same_pdf: f32,
}

impl Out {
    /// The estimate of irradiance on a surface of this normal, blue channel.
    fn irradiance(&self, normal: DVec3) -> f64 {
        let cosine = DVec3::from_array(self.direction.map(f64::from)).dot(normal).max(0.0);
        if self.valid == 1 { f64::from(self.radiance[2]) * cosine / f64::from(self.pdf) } else { 0.0 }
    }
}

fn node(matrix: DMat4) -> Node {
    Node { name: String::new(), parent: None, local: Local::Matrix(matrix) }
}

fn light(kind: LightKind) -> Light {
    Light { name: String::new(), node: 0, color: [1.0, 2.0, 3.0], kind, range: None }
}

/// A triangle that shines upwards or downwards, of 2 square metres, 3 m above the origin as a node places it.
fn triangle_scene(world: DMat4, double_sided: bool) -> Scene {
    Scene {
        meshes: vec![Mesh {
            positions: vec![[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]],
            normals: vec![[0.0, 0.0, -1.0]; 3],
            triangles: vec![[0, 1, 2]],
            triangle_materials: vec![0],
            ..Default::default()
        }],
        materials: vec![Material { emission: [1.0, 2.0, 3.0], double_sided, ..Default::default() }],
        nodes: vec![node(world)],
        instances: vec![Instance { mesh: 0, node: 0 }],
        ..Default::default()
    }
}

fn light_scene(kind: LightKind, world: DMat4) -> Scene {
    Scene { nodes: vec![node(world)], lights: vec![light(kind)], ..Default::default() }
}

/// A scene's lights in device memory.
struct Lit {
    options: KernelOptions<'static>,
    table: LightTable,
    _buffers: Vec<Buffer>,
}

fn lit(gpu: &Gpu, scene: &Scene) -> Lit {
    let world: Vec<DMat4> = scene.nodes.iter().map(|node| node.local.to_matrix()).collect();
    let distribution = EnvironmentDistribution::new(&scene.environment);
    let mut table = LightTable::new(scene, distribution.integral);
    table.refresh(scene, &world, DVec3::ZERO, 10.0);
    let mut buffers = Vec::new();
    let mut upload = |bytes: &[u8]| {
        let bytes = if bytes.is_empty() { &[0; 16] } else { bytes };
        buffers.push(gpu.upload("light test", bytes, vk::BufferUsageFlags::empty()).unwrap());
        buffers.last().map_or(0, Buffer::address)
    };
    let ranks = emitter_ranks(scene);
    let meshes: Vec<shared::Mesh> = scene
        .meshes
        .iter()
        .zip(&ranks)
        .map(|(mesh, ranks)| shared::Mesh {
            positions: upload(bytemuck::cast_slice(&mesh.positions)),
            triangles: upload(bytemuck::cast_slice(&mesh.triangles)),
            triangle_materials: upload(bytemuck::cast_slice(&mesh.triangle_materials)),
            triangle_emitters: upload(bytemuck::cast_slice(ranks)),
            ..Default::default()
        })
        .collect();
    let rows = |matrix: &DMat4| [0, 1, 2].map(|row| matrix.row(row).as_vec4().to_array());
    let instances: Vec<shared::Instance> = scene
        .instances
        .iter()
        .zip(table.first_lights())
        .map(|(instance, first_light)| {
            let matrix = &world[instance.node as usize];
            let flags = if matrix.determinant() < 0.0 { shared::INSTANCE_MIRRORED } else { 0 };
            shared::Instance { object_to_world: rows(matrix), mesh: instance.mesh, first_light, flags, ..Default::default() }
        })
        .collect();
    let flags = |material: &Material| if material.double_sided { shared::MATERIAL_DOUBLE_SIDED } else { 0 };
    let materials: Vec<shared::Material> =
        scene.materials.iter().map(|material| shared::Material { flags: flags(material), ..Default::default() }).collect();
    let radiance = if let Environment::Constant(radiance) = scene.environment { radiance } else { [0.0; 3] };
    let frame = FrameData {
        meshes: upload(bytemuck::cast_slice(&meshes)),
        instances: upload(bytemuck::cast_slice(&instances)),
        materials: upload(bytemuck::cast_slice(&materials)),
        lights: upload(bytemuck::cast_slice(table.lights())),
        punctual_lights: upload(bytemuck::cast_slice(table.punctual_lights())),
        light_alias: upload(bytemuck::cast_slice(table.alias())),
        environment_alias: upload(bytemuck::cast_slice(&distribution.alias)),
        environment_texels: upload(bytemuck::cast_slice(&distribution.texels)),
        light_count: table.count(),
        sole_light: table.sole().0,
        sole_probability: table.sole().1,
        environment_light: table.environment_light(),
        environment_size: distribution.size,
        environment_radiance: radiance,
        ..Default::default()
    };
    Lit { options: KernelOptions { frame, ..Default::default() }, table, _buffers: buffers }
}

fn samples(gpu: &Gpu, scene: &Scene, position: [f32; 3], count: u32) -> Vec<Out> {
    samples_of(gpu, scene, position, count, false)
}

/// `apart`: of the lights other than the sole one.
fn samples_of(gpu: &Gpu, scene: &Scene, position: [f32; 3], count: u32, apart: bool) -> Vec<Out> {
    let lit = lit(gpu, scene);
    let inputs: Vec<In> = (0..count).map(|seed| In { position, seed, apart: apart.into() }).collect();
    common::run_kernel_with(gpu, KERNEL, &inputs, &lit.options)
}

/// Mean and its standard error.
fn mean(values: impl ExactSizeIterator<Item = f64>) -> (f64, f64) {
    let count = values.len() as f64;
    let (sum, squares) = values.fold((0.0, 0.0), |(sum, squares), value| (sum + value, squares + value * value));
    let mean = sum / count;
    (mean, ((squares / count - mean * mean).max(0.0) / count).sqrt())
}

/// Within 5 standard errors: one of all comparisons here would fail by chance once in 100,000 seeds.
fn assert_mean(name: &str, values: impl ExactSizeIterator<Item = f64>, expected: f64) {
    let (mean, error) = mean(values);
    assert!((mean - expected).abs() <= 5.0 * error + 1e-5 * expected, "{name}: {mean} +- {error} for {expected}");
}

/// Lambert's formula for the irradiance of a polygon of radiance 1, from the origin; all of it above the horizon of `normal`.
fn polygon_irradiance(corners: &[DVec3], normal: DVec3) -> f64 {
    let edge = |i: usize| {
        let (a, b) = (corners[i].normalize(), corners[(i + 1) % corners.len()].normalize());
        a.angle_between(b) * a.cross(b).normalize().dot(normal)
    };
    (0..corners.len()).map(edge).sum::<f64>().abs() / 2.0
}

#[test]
fn irradiance_of_each_light_is_that_of_its_formula() {
    let gpu = common::gpu();
    let up = DVec3::Z;
    let above = |height: f64| DMat4::from_translation(DVec3::new(0.0, 0.0, height));
    let sphere = |radius: f32, height: f64| light_scene(LightKind::Sphere { radius }, above(height));
    let irradiance = |scene: &Scene| samples(&gpu, scene, [0.0; 3], 100_000).into_iter().map(|out| out.irradiance(DVec3::Z));

    // L pi (r / d)^2 with L = color / (pi r^2).
    for (radius, height) in [(0.5, 2.0), (1.9, 2.0), (1e-4, 100.0), (1e-6, 1e3)] {
        assert_mean("sphere", irradiance(&sphere(radius, height)), 3.0 / (height * height));
    }
    assert_mean("point", irradiance(&light_scene(LightKind::Point, above(2.0))), 0.75);
    assert_mean("directional", irradiance(&light_scene(LightKind::Directional, above(2.0))), 3.0);
    let spot = LightKind::Spot { inner_cone_angle: 0.2, outer_cone_angle: 0.4 };
    assert_mean("spot on its axis", irradiance(&light_scene(spot, above(2.0))), 0.75);
    // Seen 0.3 rad off the axis.
    let tilted = above(2.0) * DMat4::from_rotation_x(0.3);
    let falloff = ((0.3f64.cos() - 0.4f64.cos()) / (0.2f64.cos() - 0.4f64.cos())).powi(2);
    assert_mean("spot off its axis", irradiance(&light_scene(spot, tilted)), 0.75 * falloff);
    let constant = Scene { environment: Environment::Constant([1.0, 1.0, 0.5]), ..Default::default() };
    assert_mean("constant environment", irradiance(&constant), 0.5 * PI);

    let flip = DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0));
    for (name, world, double_sided, lit) in [
        ("front", above(3.0), false, 1.0),
        ("back", above(3.0) * DMat4::from_rotation_x(PI), false, 0.0),
        ("both sides", above(3.0) * DMat4::from_rotation_x(PI), true, 1.0),
        // Mirrored in its own plane, its front still points where the mirrored normal does: up.
        ("mirrored", above(3.0) * flip, false, 0.0),
        ("stretched", above(3.0) * DMat4::from_scale(DVec3::new(5.0, 0.1, 1.0)), false, 1.0),
    ] {
        let scene = triangle_scene(world, double_sided);
        let corners = scene.meshes[0].positions.iter().map(|p| world.transform_point3(DVec3::from_array(p.map(f64::from))));
        let expected = 3.0 * polygon_irradiance(&corners.collect::<Vec<_>>(), up);
        assert_mean(name, irradiance(&scene), lit * expected);
    }
}

/// KHR_lights_punctual's window: (1 - (d / range)^4) / d^2, nothing beyond.
#[test]
fn a_light_with_a_range_ends_there() {
    let gpu = common::gpu();
    let at = |range: f32| {
        let mut scene = light_scene(LightKind::Point, DMat4::from_translation(2.0 * DVec3::Z));
        scene.lights[0].range = Some(range);
        samples(&gpu, &scene, [0.0; 3], 1)[0].irradiance(DVec3::Z)
    };
    assert!((at(4.0) - 0.75 * (1.0 - 0.5f64.powi(4))).abs() < 1e-6);
    assert_eq!(at(1.9), 0.0);
}

/// Everything at once.
fn crowded_scene() -> Scene {
    let pixels = (0..32 * 16).map(|i| [0.1, (i % 7) as f32, if i == 100 { 300.0 } else { 0.2 }]).collect();
    let mut scene = triangle_scene(DMat4::from_translation(3.0 * DVec3::Z), true);
    scene.lights = vec![
        light(LightKind::Point),
        light(LightKind::Sphere { radius: 0.25 }),
        light(LightKind::Spot { inner_cone_angle: 0.1, outer_cone_angle: 1.5 }),
        light(LightKind::Directional),
    ];
    scene.environment = Environment::Map { width: 32, height: 16, pixels };
    scene
}

#[test]
fn a_ray_that_finds_a_light_is_told_the_density_of_sampling_it() {
    let gpu = common::gpu();
    let inside_the_sphere = [0.0, 0.1, 3.0];
    for position in [[0.3, 0.2, 0.0], inside_the_sphere] {
        let outs = samples(&gpu, &crowded_scene(), position, 50_000);
        let mut differing = 0;
        for out in outs.iter().filter(|out| out.valid == 1) {
            assert!(out.pdf > 0.0 && out.pdf.is_finite(), "{out:?}");
            differing += u32::from((out.pdf - out.same_pdf).abs() > 1e-3 * out.pdf);
        }
        // A direction on the edge of a texel or of the sphere may be rounded to its other side.
        assert!(differing <= 25, "{differing} of 50000 differ");
    }
}

/// At significance 1e-4: both tests would fail by chance once in 10,000 seeds.
#[test]
fn lights_and_texels_are_chosen_in_proportion_to_their_power() {
    let gpu = common::gpu();
    let scene = crowded_scene();
    let count = 200_000;
    let outs = samples(&gpu, &scene, [0.3, 0.2, 0.0], count);
    let table = lit(&gpu, &scene).table;
    let significance = sidak(1e-4, 2);

    let mut observed = vec![0u64; table.lights().len()];
    outs.iter().for_each(|out| observed[out.light as usize] += 1);
    let expected: Vec<f64> = table.lights().iter().map(|light| f64::from(light.probability) * f64::from(count)).collect();
    let chosen = chi_square_test(&observed, &expected);
    assert!(chosen.p_value > significance, "{observed:?} for {expected:?}");

    let distribution = EnvironmentDistribution::new(&scene.environment);
    let environment: Vec<&Out> = outs.iter().filter(|out| out.light == table.environment_light()).collect();
    let mut observed = vec![0u64; distribution.texels.len()];
    for out in &environment {
        let [x, y, z] = out.direction.map(f64::from);
        let (u, v) = (0.5 - x.atan2(z) / (2.0 * PI), y.clamp(-1.0, 1.0).acos() / PI);
        observed[((v * 16.0) as usize).min(15) * 32 + ((u * 32.0) as usize).min(31)] += 1;
    }
    let expected: Vec<f64> = distribution.texels.iter().map(|texel| f64::from(texel[3]) / 512.0 * environment.len() as f64).collect();
    let chosen = chi_square_test(&observed, &expected);
    assert!(environment.len() > 10_000 && chosen.p_value > significance, "{chosen:?}");
}

/// The light without a size is chosen by its probability, or never; what is left for the others is theirs in proportion to their power. At
/// significance 1e-4.
#[test]
fn a_sole_light_may_stand_apart() {
    let gpu = common::gpu();
    let mut scene = crowded_scene();
    scene.lights.truncate(2);
    let table = lit(&gpu, &scene).table;
    let (sole, share) = table.sole();
    assert!(matches!(scene.lights[0].kind, LightKind::Point) && share > 0.0 && share < 1.0, "{share}");
    let count = 200_000;
    for apart in [false, true] {
        let outs = samples_of(&gpu, &scene, [0.3, 0.2, 0.0], count, apart);
        let mut observed = vec![0u64; table.lights().len()];
        outs.iter().for_each(|out| observed[out.light as usize] += 1);
        let scale = if apart { 1.0 / (1.0 - f64::from(share)) } else { 1.0 };
        let mut expected: Vec<f64> = table.lights().iter().map(|light| f64::from(light.probability) * scale * f64::from(count)).collect();
        if apart {
            assert_eq!(observed.swap_remove(sole as usize), 0);
            expected.swap_remove(sole as usize);
        }
        let chosen = chi_square_test(&observed, &expected);
        assert!(chosen.p_value > sidak(1e-4, 2), "{observed:?} for {expected:?}");
        let differing = outs.iter().filter(|out| out.valid == 1 && (out.pdf - out.same_pdf).abs() > 1e-3 * out.pdf).count();
        assert!(differing <= 100, "{differing} of {count} differ");
    }
    scene.lights.push(light(LightKind::Directional));
    assert_eq!(lit(&gpu, &scene).table.sole(), (u32::MAX, 0.0));
    let alone = light_scene(LightKind::Directional, DMat4::IDENTITY);
    assert!(samples(&gpu, &alone, [0.0; 3], 100).iter().all(|out| out.valid == 1 && out.pdf == 1.0));
    assert!(samples_of(&gpu, &alone, [0.0; 3], 100, true).iter().all(|out| out.valid == 0));
}

/// The mean of radiance over density is the map's integral, whose oracle interpolates and integrates it in double precision.
#[test]
fn an_environment_map_shines_as_much_as_it_holds() {
    let gpu = common::gpu();
    let Environment::Map { width, height, pixels } = crowded_scene().environment else { unreachable!() };
    let (w, h) = (width as i64, height as i64);
    let texel = |x: i64, y: i64| f64::from(pixels[(y.clamp(0, h - 1) * w + x.rem_euclid(w)) as usize][2]);
    let fine = 16;
    let mut integral = 0.0;
    for row in 0..h * fine {
        for column in 0..w * fine {
            let (x, y) = ((column as f64 + 0.5) / fine as f64 - 0.5, (row as f64 + 0.5) / fine as f64 - 0.5);
            let (i, j) = (x.floor() as i64, y.floor() as i64);
            let (fx, fy) = (x - x.floor(), y - y.floor());
            let top = texel(i, j) * (1.0 - fx) + texel(i + 1, j) * fx;
            let bottom = texel(i, j + 1) * (1.0 - fx) + texel(i + 1, j + 1) * fx;
            let band = |row: i64| (PI * row as f64 / (h * fine) as f64).cos();
            integral += (top * (1.0 - fy) + bottom * fy) * (band(row) - band(row + 1)) * 2.0 * PI / (w * fine) as f64;
        }
    }
    let scene = Scene { environment: crowded_scene().environment, ..Default::default() };
    let outs = samples(&gpu, &scene, [0.0; 3], 200_000);
    assert_mean("map", outs.iter().map(|out| f64::from(out.radiance[2]) / f64::from(out.pdf)), integral);
}
