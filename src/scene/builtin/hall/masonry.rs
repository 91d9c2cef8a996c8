//! The carved parts of the hall, as formulas that can be tessellated as finely as one likes.
//!
//! The nave runs along -z between two arcades at x = +-2.6, with an aisle behind each; one bay is 3 m long.

use super::super::picture::fractal;
use super::super::surface::Surface;
use glam::{Vec2, Vec3, vec2, vec3};
use std::f32::consts::{PI, TAU};

pub const BAYS: u32 = 6;
pub const BAY: f32 = 3.0;
pub const LENGTH: f32 = BAYS as f32 * BAY;
/// Half width of the nave, between the arcades' axes, and of the whole.
pub const ARCADE_X: f32 = 2.6;
pub const WALL_X: f32 = 5.0;
/// Height at which the arches and the vault spring.
pub const IMPOST: f32 = 3.0;
pub const CORNICE: f32 = 5.2;
const ARCADE_HALF_THICKNESS: f32 = 0.25;
const ARCH_RADIUS: f32 = 1.15;
const AISLE_CEILING: f32 = 4.4;

type Formula = Box<dyn Fn(f32, f32) -> Vec3>;

/// A patch of the unit square, and its cells at detail 1.
pub struct Part {
    cells: Vec2,
    at: Formula,
}

impl Part {
    pub fn new(columns: u32, rows: u32, at: impl Fn(f32, f32) -> Vec3 + 'static) -> Self {
        Self { cells: vec2(columns as f32, rows as f32), at: Box::new(at) }
    }

    pub fn triangles(&self, detail: f32) -> u64 {
        let [columns, rows] = self.cells_at(detail);
        2 * u64::from(columns) * u64::from(rows)
    }

    pub fn build(&self, detail: f32) -> Surface {
        let [columns, rows] = self.cells_at(detail);
        Surface::patch(columns, rows, &self.at)
    }

    /// On the other side of the nave.
    fn mirrored(self) -> Self {
        let at = self.at;
        Self { cells: self.cells, at: Box::new(move |u, v| at(1.0 - u, v) * vec3(-1.0, 1.0, 1.0)) }
    }

    /// Never fewer than three, so that tubes stay tubes.
    fn cells_at(&self, detail: f32) -> [u32; 2] {
        (self.cells * detail).round().max(Vec2::splat(3.0)).to_array().map(|cells| cells as u32)
    }
}

fn on_both_sides(part: impl Fn() -> Part) -> [Part; 2] {
    [part(), part().mirrored()]
}

/// Columns, alternately fluted and twisted. `relief`, 0 to 1, scales the depth of all carving.
pub fn columns(relief: f32) -> Vec<Part> {
    (0..=BAYS).flat_map(|i| on_both_sides(move || Part::new(32, 36, move |u, v| column(i, relief, u, v)))).collect()
}

fn column(index: u32, relief: f32, u: f32, v: f32) -> Vec3 {
    let (height, angle) = (v * IMPOST, u * TAU);
    let is_twisted = index % 2 == 1;
    let base = 0.13 * (1.0 - smoothstep(0.1, 0.45, height));
    let capital = smoothstep(2.45, 3.0, height);
    let shaft = smoothstep(0.35, 0.5, height) * (1.0 - smoothstep(2.35, 2.5, height));
    let flutes = if is_twisted { 0.5 + 0.5 * (4.0 * angle - 5.0 * height).sin() } else { (6.0 * angle).cos().abs() };
    let leaves = capital * (1.0 - capital) * (4.0 * angle).cos().abs();
    let wear = 0.006 * fractal(vec2(u * 12.0, height * 4.0), 12, index, 3);
    let carving = 0.05 * shaft * flutes + 0.35 * leaves + wear;
    let radius = 0.27 + base + 0.2 * capital * capital + relief * carving;
    vec3(ARCADE_X + radius * angle.sin(), height, radius * angle.cos() - index as f32 * BAY)
}

/// The two arcades: wall faces above the arches, the arches' undersides, and a beaded moulding around each.
pub fn arcades(relief: f32) -> Vec<Part> {
    let bay = move |i: u32| {
        let centre = -BAY * (i as f32 + 0.5);
        let nave_side = move || Part::new(30, 10, move |u, v| spandrel(-1.0, centre, relief, u, v));
        let aisle_side = move || Part::new(30, 8, move |u, v| spandrel(1.0, centre, relief, u, v));
        let underside = move || Part::new(28, 5, move |u, v| underside(centre, relief, u, v));
        let moulding = move |side: f32| {
            let arc = Arc {
                centre: vec3(ARCADE_X + side * ARCADE_HALF_THICKNESS, IMPOST, centre),
                axes: [Vec3::Z, Vec3::Y],
                radius: ARCH_RADIUS + 0.12,
            };
            move || arc.tube([40, 6], 0.08, 20.0, relief)
        };
        let parts = [on_both_sides(nave_side), on_both_sides(aisle_side), on_both_sides(underside)];
        parts.into_iter().chain([on_both_sides(moulding(-1.0)), on_both_sides(moulding(1.0))]).flatten()
    };
    (0..BAYS).flat_map(bay).collect()
}

/// Wall between an arch and the cornice, in courses of stone; `side` -1 faces the nave, 1 the aisle.
fn spandrel(side: f32, centre: f32, relief: f32, u: f32, v: f32) -> Vec3 {
    let foot = arch_outline(if side < 0.0 { u } else { 1.0 - u });
    let (y, z) = (foot.y + (CORNICE - foot.y) * v, centre + foot.x);
    let joint = stone_joints(vec2(z, y), vec2(0.75, 0.3));
    vec3(ARCADE_X + side * (ARCADE_HALF_THICKNESS - 0.02 * relief * joint), y, z)
}

/// From pier to pier over the arch: (along the arcade from the bay's centre, height).
fn arch_outline(u: f32) -> Vec2 {
    const PIER: f32 = 0.12;
    let half_bay = BAY / 2.0;
    let angle = ((u - PIER) / (1.0 - 2.0 * PIER)).clamp(0.0, 1.0) * PI;
    let on_pier = if u < PIER { u / PIER - 1.0 } else { ((u - 1.0 + PIER) / PIER).max(0.0) };
    vec2(-ARCH_RADIUS * angle.cos() + (half_bay - ARCH_RADIUS) * on_pier, IMPOST + ARCH_RADIUS * angle.sin())
}

fn underside(centre: f32, relief: f32, u: f32, v: f32) -> Vec3 {
    let angle = u * PI;
    let panels = bump(u * 9.0) * bump(v);
    let radius = ARCH_RADIUS + 0.05 * relief * panels;
    let x = ARCADE_X + ARCADE_HALF_THICKNESS * (2.0 * v - 1.0);
    vec3(x, IMPOST + radius * angle.sin(), centre + radius * angle.cos())
}

/// Coffered barrel vault over the nave, a rib above each column, and the cornices that they stand on.
pub fn vault(relief: f32) -> Vec<Part> {
    let radius = ARCADE_X - ARCADE_HALF_THICKNESS;
    let shell = Part::new(40, 96, move |u, v| {
        let recess = bump(u * 8.0) * bump(v * 4.0 * BAYS as f32);
        let r = radius + 0.14 * relief * recess;
        vec3(r * (u * PI).cos(), CORNICE + r * (u * PI).sin(), -LENGTH * v)
    });
    let rib = |i: u32| {
        let arc = Arc { centre: vec3(0.0, CORNICE, -BAY * i as f32), axes: [Vec3::X, Vec3::Y], radius };
        arc.tube([36, 6], 0.12, 18.0, 0.4 * relief)
    };
    let cornice = move || {
        Part::new(72, 4, move |u, v| {
            let dentils = (u * LENGTH * TAU / 0.5).cos().clamp(-0.5, 0.5) + 0.5;
            let depth = 0.12 * (v * PI).sin() * (1.0 + 0.6 * relief * dentils);
            vec3(radius - depth, CORNICE - 0.25 + 0.3 * v, -LENGTH * (1.0 - u))
        })
    };
    std::iter::once(shell).chain((0..=BAYS).map(rib)).chain(on_both_sides(cornice)).collect()
}

/// Outer walls, aisle ceilings and the two ends.
pub fn walls(relief: f32) -> Vec<Part> {
    let joints = move |point: Vec2| 0.02 * relief * stone_joints(point, vec2(1.0, 0.45));
    let side = move || {
        Part::new(36, 10, move |u, v| {
            let (z, y) = (-LENGTH * (1.0 - u), AISLE_CEILING * v);
            vec3(WALL_X + joints(vec2(z, y)), y, z)
        })
    };
    let ceiling =
        || Part::new(6, 24, |u, v| vec3(ARCADE_X + (WALL_X - ARCADE_X) * u, AISLE_CEILING + 0.35 * (u * PI).sin(), -LENGTH * (1.0 - v)));
    let end = |z: f32, facing: f32| {
        Part::new(24, 16, move |u, v| {
            let (x, y) = (facing * WALL_X * (2.0 * u - 1.0), 8.0 * v);
            vec3(x, y, z - facing * joints(vec2(x, y)))
        })
    };
    on_both_sides(side).into_iter().chain(on_both_sides(ceiling)).chain([end(-LENGTH, 1.0), end(0.0, -1.0)]).collect()
}

pub fn floor() -> Part {
    Part::new(20, 36, |u, v| vec3(WALL_X * (2.0 * u - 1.0), 0.0, -LENGTH * v))
}

/// Torus knot around the origin, two turns by three.
pub fn knot() -> Part {
    const AROUND: [f32; 2] = [2.0, 3.0];
    let on_torus = |t: f32| {
        let (a, b) = (AROUND[0] * t * TAU, AROUND[1] * t * TAU);
        let normal = vec3(b.cos() * a.sin(), b.sin(), b.cos() * a.cos());
        (vec3(a.sin(), 0.0, a.cos()) * 0.42 + normal * 0.2, normal)
    };
    Part::new(160, 12, move |u, v| {
        let (point, normal) = on_torus(u);
        let tangent = (on_torus(u + 1e-3).0 - on_torus(u - 1e-3).0).normalize();
        let outwards = (normal - tangent * normal.dot(tangent)).normalize();
        let (sin, cos) = (v * TAU).sin_cos();
        point + 0.085 * (cos * outwards + sin * outwards.cross(tangent))
    })
}

/// Half a circle in the plane of `axes`, from the first axis over the second.
#[derive(Clone, Copy)]
pub struct Arc {
    pub centre: Vec3,
    pub axes: [Vec3; 2],
    pub radius: f32,
}

impl Arc {
    /// A tube along the arc, `thickness` in radius, with `beads` swellings.
    pub fn tube(self, [columns, rows]: [u32; 2], thickness: f32, beads: f32, relief: f32) -> Part {
        let [first, second] = self.axes;
        let axis = first.cross(second);
        Part::new(columns, rows, move |u, v| {
            let radial = (u * PI).cos() * first + (u * PI).sin() * second;
            let swelling = 1.0 + 0.35 * relief * (u * beads * TAU).cos();
            let (sin, cos) = (v * TAU).sin_cos();
            self.centre + radial * self.radius + thickness * swelling * (cos * radial + sin * axis)
        })
    }
}

/// 1 in the joints of a running bond of `stone` sized blocks, 0 on the blocks.
fn stone_joints(point: Vec2, stone: Vec2) -> f32 {
    let course = (point.y / stone.y).floor();
    let shift = if course.rem_euclid(2.0) < 0.5 { 0.0 } else { 0.5 };
    let block = vec2((point.x / stone.x + shift).rem_euclid(1.0), (point.y / stone.y).rem_euclid(1.0));
    let to_joint = (block.min(1.0 - block) * stone).min_element();
    1.0 - smoothstep(0.01, 0.04, to_joint)
}

/// A flat-topped bump in the middle of each unit interval.
fn bump(x: f32) -> f32 {
    let x = x.rem_euclid(1.0);
    smoothstep(0.12, 0.24, x.min(1.0 - x))
}

fn smoothstep(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
