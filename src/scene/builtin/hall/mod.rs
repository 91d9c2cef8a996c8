//! A vaulted hall at night: many triangles, as many as one asks for, and many small lamps.

mod flight;
mod masonry;

use self::masonry::{ARCADE_X, Arc, BAY, BAYS, CORNICE, IMPOST, LENGTH, Part, WALL_X};
use super::cornell::lambert;
use super::document::{Document, light_reference, look_rotation};
use super::material::lamp;
use super::picture::{checker, fractal, paint};
use super::surface::Surface;
use super::{Options, TriangleRange};
use glam::{Quat, Vec2, Vec3, vec2, vec3};
use serde_json::json;
use std::f32::consts::{FRAC_PI_2, PI, TAU};

pub const TRIANGLES: TriangleRange = TriangleRange { default: 80_000, min: 10_000, max: 5_000_000 };

const WARM: [f32; 3] = [1.0, 0.6, 0.25];
const DUSK: [f32; 3] = [0.35, 0.55, 1.0];
const CANDLES: u32 = 8;
/// The sculpture at the far end.
const PLINTH: Vec3 = vec3(-0.2, 1.62, -8.6);

const YFOV: f32 = 1.05;

pub fn make(options: &Options) -> Vec<u8> {
    let mut document = build("hall", options);
    document.add_camera(vec3(0.55, 1.65, -0.7), vec3(-0.25, 2.35, -9.0), YFOV);
    document.into_glb()
}

/// The camera flies along the nave.
pub fn make_flight(options: &Options) -> Vec<u8> {
    let mut document = build("hall-flight", options);
    flight::add_camera(&mut document, YFOV);
    document.into_glb()
}

/// All but the camera.
fn build(name: &str, options: &Options) -> Document {
    let mut hall = Hall { document: Document::new(name), detail: 0.0, relief: 0.0 };
    let fixed = FixedParts::new();
    (hall.detail, hall.relief) = detail_for(u64::from(options.triangles).saturating_sub(fixed.triangles()));
    hall.add_masonry(&fixed);
    hall.add_windows(&fixed);
    hall.add_lamps(&fixed);
    hall.add_sculpture(&fixed);
    hall.add_lights();
    hall.document
}

/// Detail whose triangles come nearest to `triangles`, and the depth of carving that it can show.
fn detail_for(triangles: u64) -> (f32, f32) {
    let parts = Hall::carved_parts(0.0);
    let count = |detail: f32| parts.iter().map(|part| part.triangles(detail)).sum::<u64>();
    let (mut low, mut high) = (0.01, 32.0);
    for _ in 0..40 {
        let middle = (low + high) / 2.0;
        *(if count(middle) < triangles { &mut low } else { &mut high }) = middle;
    }
    (high, high.clamp(0.15, 1.0))
}

/// What stays as it is at every detail.
struct FixedParts {
    blocks: Surface,
    windows: Surface,
    rose: Surface,
    candle: Surface,
    plinth: Surface,
}

impl FixedParts {
    fn new() -> Self {
        Self {
            blocks: blocks(),
            windows: (0..BAYS).flat_map(|i| [1.0, -1.0].map(|side| window(side, -BAY * (i as f32 + 0.5)))).sum(),
            rose: rose_window(),
            candle: Surface::sphere(0.045, 6, 4),
            plinth: Surface::cuboid(vec3(-0.32, 0.0, -0.32), vec3(0.32, 0.85, 0.32)),
        }
    }

    /// As rays meet them: a shared mesh counts as often as it is placed.
    fn triangles(&self) -> u64 {
        let once = [&self.blocks, &self.windows, &self.rose, &self.plinth].iter().map(|surface| surface.triangles.len()).sum::<usize>();
        (once + self.candle.triangles.len() * candle_places().len()) as u64
    }
}

struct Hall {
    document: Document,
    detail: f32,
    relief: f32,
}

impl Hall {
    fn carved_parts(relief: f32) -> Vec<Part> {
        let [columns, arcades, vault, walls] =
            [masonry::columns, masonry::arcades, masonry::vault, masonry::walls].map(|parts| parts(relief));
        let rest = [masonry::floor(), masonry::knot()].into_iter().chain(chandelier_rings()).chain(window_frames());
        columns.into_iter().chain(arcades).chain(vault).chain(walls).chain(rest).collect()
    }

    fn build(&self, parts: impl IntoIterator<Item = Part>) -> Surface {
        parts.into_iter().map(|part| part.build(self.detail)).sum()
    }

    fn add_masonry(&mut self, fixed: &FixedParts) {
        let sandstone = self.document.add_material("sandstone", lambert([0.58, 0.47, 0.36]));
        let limestone = self.document.add_material("limestone", lambert([0.66, 0.62, 0.56]));
        let plaster = self.document.add_material("plaster", lambert([0.52, 0.5, 0.48]));
        let marble = self.document.add_texture("marble", &paint(512, marble_color));
        let marble = self.document.add_material(
            "marble",
            json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": marble }, "metallicFactor": 0.0, "roughnessFactor": 0.18 } }),
        );
        let relief = self.relief;
        let columns = self.build(masonry::columns(relief));
        self.document.add_object("columns", &columns, limestone);
        self.document.add_object("plinths and abaci", &fixed.blocks, limestone);
        let arcades = self.build(masonry::arcades(relief));
        self.document.add_object("arcades", &arcades, sandstone);
        let vault = self.build(masonry::vault(relief));
        self.document.add_object("vault", &vault, plaster);
        let walls = self.build(masonry::walls(relief));
        self.document.add_object("walls", &walls, sandstone);
        let floor = self.build([masonry::floor()]).tiled(vec2(5.0, 9.0));
        self.document.add_object("floor", &floor, marble);
    }

    fn add_windows(&mut self, fixed: &FixedParts) {
        let sky = self.document.add_material("evening sky", lamp(DUSK, 2.0));
        self.document.add_object("windows", &fixed.windows, sky);
        let stained = self.document.add_material("stained glass", lamp([1.0, 0.32, 0.16], 2.5));
        self.document.add_object("rose window", &fixed.rose, stained);
        let lead = self.document.add_material("lead", lambert([0.08, 0.08, 0.09]));
        let frames = self.build(window_frames());
        self.document.add_object("window frames", &frames, lead);
    }

    fn add_lamps(&mut self, fixed: &FixedParts) {
        let flame = self.document.add_material("flame", lamp(WARM, 50.0));
        let candle = self.document.add_geometry(&fixed.candle);
        let candle = self.document.add_mesh("candle", &[(&candle, flame)]);
        for (i, place) in candle_places().into_iter().enumerate() {
            self.document.add_node(json!({ "name": format!("candle {i}"), "mesh": candle, "translation": place.to_array() }));
        }
        let iron = json!({ "pbrMetallicRoughness": { "baseColorFactor": [0.3, 0.28, 0.26, 1.0], "metallicFactor": 1.0, "roughnessFactor": 0.45 } });
        let iron = self.document.add_material("iron", iron);
        let rings = self.build(chandelier_rings());
        self.document.add_object("chandeliers", &rings, iron);
    }

    /// A golden knot that turns once in 12 seconds.
    fn add_sculpture(&mut self, fixed: &FixedParts) {
        let gold =
            json!({ "pbrMetallicRoughness": { "baseColorFactor": [1.0, 0.72, 0.3, 1.0], "metallicFactor": 1.0, "roughnessFactor": 0.22 } });
        let gold = self.document.add_material("gold", gold);
        let basalt = self.document.add_material("basalt", lambert([0.12, 0.12, 0.13]));
        let knot = self.build([masonry::knot()]);
        let geometry = self.document.add_geometry(&knot);
        let mesh = self.document.add_mesh("knot", &[(&geometry, gold)]);
        let upright = Quat::from_rotation_x(FRAC_PI_2);
        let node = self
            .document
            .add_node(json!({ "name": "knot", "mesh": mesh, "translation": PLINTH.to_array(), "rotation": upright.to_array() }));
        let times: Vec<f32> = (0..=8).map(|i| i as f32 * 1.5).collect();
        let turns: Vec<Vec<f32>> = times.iter().map(|t| (Quat::from_rotation_y(t / 12.0 * TAU) * upright).to_array().to_vec()).collect();
        self.document.animate(node, "rotation", &times, &turns);
        let plinth = fixed.plinth.clone().translated(vec3(PLINTH.x, 0.0, PLINTH.z));
        self.document.add_object("plinth", &plinth, basalt);
    }

    fn add_lights(&mut self) {
        let spot = json!({ "type": "spot", "name": "spotlight", "color": [1.0, 0.9, 0.75], "intensity": 90.0,
                           "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.24 } });
        let point = json!({ "type": "point", "name": "ember", "color": WARM, "intensity": 5.0 });
        let sphere = json!({ "type": "point", "name": "moon lamp", "color": DUSK, "intensity": 9.0, "extras": { "radius": 0.18 } });
        let [spot, point, sphere] = [spot, point, sphere].map(|light| self.document.add_light(light));
        let from = vec3(0.0, 6.6, -6.0);
        let towards = look_rotation(PLINTH - from);
        for (name, light, place, rotation) in [
            ("spotlight", spot, from, towards),
            ("ember, left aisle", point, vec3(-4.2, 0.5, -7.5), Quat::IDENTITY),
            ("ember, right aisle", point, vec3(4.2, 0.5, -10.5), Quat::IDENTITY),
            ("moon lamp", sphere, vec3(3.9, 3.2, -16.5), Quat::IDENTITY),
        ] {
            let node = json!({ "name": name, "translation": place.to_array(), "rotation": rotation.to_array(), "extensions": light_reference(light) });
            self.document.add_node(node);
        }
    }
}

/// Under and over each column.
fn blocks() -> Surface {
    let on_column = |x: f32, z: f32| {
        let block = |half: f32, bottom: f32, top: f32| Surface::cuboid(vec3(x - half, bottom, z - half), vec3(x + half, top, z + half));
        [block(0.46, -0.05, 0.1), block(0.5, IMPOST - 0.14, IMPOST + 0.02)]
    };
    (0..=BAYS).flat_map(|i| [ARCADE_X, -ARCADE_X].into_iter().flat_map(move |x| on_column(x, -BAY * i as f32))).sum()
}

/// A round-headed pane in an outer wall that looks inwards.
fn window(side: f32, centre: f32) -> Surface {
    let head = |u: f32| (1.0 - (2.0 * u - 1.0).powi(2)).max(0.0).sqrt();
    let pane =
        Surface::patch(12, 1, |u, v| vec3(side * (WALL_X - 0.03), 1.3 + v * (1.3 + 0.45 * head(u)), centre + side * 0.9 * (u - 0.5)));
    let normals = vec![vec3(-side, 0.0, 0.0); pane.positions.len()];
    Surface { normals, ..pane }
}

fn window_frames() -> Vec<Part> {
    let frame = |side: f32, i: u32| Arc {
        centre: vec3(side * (WALL_X - 0.03), 2.6, -BAY * (i as f32 + 0.5)),
        axes: [Vec3::Z, Vec3::Y],
        radius: 0.46,
    };
    let heads = (0..BAYS).flat_map(|i| [1.0, -1.0].map(|side| frame(side, i).tube([12, 3], 0.05, 0.0, 0.0)));
    let circle = |radius: f32| {
        [Vec3::Y, Vec3::NEG_Y].map(|up| Arc { centre: ROSE_CENTRE, axes: [Vec3::X * up.y, up], radius }.tube([24, 3], 0.05, 0.0, 0.0))
    };
    heads.chain([0.25, 0.75, 1.3].into_iter().flat_map(circle)).collect()
}

const ROSE_CENTRE: Vec3 = vec3(0.0, 5.5, 0.06 - LENGTH);

fn rose_window() -> Surface {
    let petal = |i: u32| {
        let middle = (i as f32 + 0.5) / 12.0 * TAU;
        Surface::patch(6, 3, move |u, v| {
            let angle = middle - (u - 0.5) * 0.42 * (0.35 + 0.65 * (v * PI).sin());
            ROSE_CENTRE + (0.32 + 0.92 * v) * vec3(angle.cos(), angle.sin(), 0.0) - Vec3::Z * 0.04
        })
    };
    (0..12).map(petal).sum()
}

/// In a ring on each chandelier, and on brackets at the columns.
fn candle_places() -> Vec<Vec3> {
    let on_ring = |bay: u32| {
        (0..CANDLES).map(move |i| {
            let (sin, cos) = ((i as f32 + 0.5) / CANDLES as f32 * TAU).sin_cos();
            chandelier_centre(bay) + vec3(CHANDELIER_RADIUS * sin, 0.1, CHANDELIER_RADIUS * cos)
        })
    };
    let at_columns = (0..=BAYS).flat_map(|i| [1.0, -1.0].map(|side| vec3(side * (ARCADE_X - 0.55), 2.1, -BAY * i as f32)));
    (0..BAYS).flat_map(on_ring).chain(at_columns).collect()
}

const CHANDELIER_RADIUS: f32 = 0.5;

fn chandelier_centre(bay: u32) -> Vec3 {
    vec3(0.0, 4.1, -BAY * (bay as f32 + 0.5))
}

/// Rings, and the rods that they hang from.
fn chandelier_rings() -> Vec<Part> {
    let parts = |bay: u32| {
        let centre = chandelier_centre(bay);
        let half =
            |sign: f32| Arc { centre, axes: [Vec3::Z * sign, Vec3::X * sign], radius: CHANDELIER_RADIUS }.tube([16, 4], 0.025, 0.0, 0.0);
        let rod = |sign: f32| {
            let foot = centre + Vec3::X * sign * CHANDELIER_RADIUS;
            let top = vec3(0.0, CORNICE + 2.3, centre.z);
            Part::new(4, 3, move |u, v| {
                let (sin, cos) = (u * TAU).sin_cos();
                foot.lerp(top, v) + 0.012 * vec3(sin, 0.0, cos)
            })
        };
        [half(1.0), half(-1.0), rod(1.0), rod(-1.0)]
    };
    (0..BAYS).flat_map(parts).collect()
}

/// Two by two slabs with veins, sRGB.
fn marble_color(uv: Vec2) -> Vec3 {
    let is_light = checker(uv, 2.0) > 0.5;
    let base = if is_light { vec3(0.83, 0.8, 0.75) } else { vec3(0.36, 0.24, 0.2) };
    let turbulence = fractal(uv * 6.0, 6, 17, 5);
    let vein = ((uv.x + uv.y) * TAU + 4.0 * turbulence).sin().abs().powf(0.35);
    let in_slab = (uv * 2.0).fract();
    let to_joint = in_slab.min(1.0 - in_slab).min_element();
    if to_joint < 0.008 { Vec3::splat(0.25) } else { base * (0.72 + 0.28 * vein) }
}
