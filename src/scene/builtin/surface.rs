//! Triangle meshes from formulas: what the built-in scenes are made of. Metres, y up, counter-clockwise front faces.

use glam::{Affine3A, Vec2, Vec3, vec2, vec3};
use std::f32::consts::{PI, TAU};

/// An indexed triangle list; `normals` and `uvs` are as long as `positions`.
#[derive(Debug, Clone, Default)]
pub struct Surface {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    pub triangles: Vec<[u32; 3]>,
}

impl Surface {
    /// Flat quadrilateral, corners counter-clockwise seen from the front; texture coordinates run from corner 3 (0, 0) to corner 1 (1, 1),
    /// so that an image stands upright on a wall whose corner 0 is its lower left.
    pub fn quad(corners: [Vec3; 4]) -> Self {
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
        Self {
            positions: corners.to_vec(),
            normals: vec![normal; 4],
            uvs: vec![vec2(0.0, 1.0), vec2(1.0, 1.0), vec2(1.0, 0.0), vec2(0.0, 0.0)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }
    }

    /// Parametric patch: `at(u, v)` over the unit square, front face where d/du x d/dv points. Normals are central differences over a
    /// cell, so that they show no detail that the triangles lack; `at` must be defined half a cell beyond the square.
    pub fn patch(columns: u32, rows: u32, at: impl Fn(f32, f32) -> Vec3) -> Self {
        let [half_u, half_v] = [columns, rows].map(|cells| 0.5 / cells as f32);
        let mut surface = Self::default();
        for (u, v) in lattice(columns, rows) {
            let along_u = at(u + half_u, v) - at(u - half_u, v);
            let along_v = at(u, v + half_v) - at(u, v - half_v);
            surface.push(at(u, v), along_u.cross(along_v).normalize_or(Vec3::Y), vec2(u, 1.0 - v));
        }
        surface.triangles = lattice_triangles(columns, rows);
        surface
    }

    /// Sphere around the origin, smooth normals, no degenerate triangles at the poles.
    pub fn sphere(radius: f32, segments: u32, rings: u32) -> Self {
        let mut surface = Self::default();
        for (u, v) in lattice(segments, rings) {
            let (sin_phi, cos_phi) = (u * TAU).sin_cos();
            let (sin_theta, cos_theta) = (v * PI).sin_cos();
            let normal = vec3(sin_theta * sin_phi, -cos_theta, sin_theta * cos_phi);
            surface.push(normal * radius, normal, vec2(u, 1.0 - v));
        }
        surface.triangles = lattice_triangles(segments, rings);
        let stride = (segments + 1) as usize;
        let last_ring = stride * rings as usize;
        surface.triangles.retain(|t| t.iter().filter(|&&i| (i as usize) < stride || i as usize >= last_ring).count() < 2);
        surface
    }

    /// Axis-aligned box with flat faces.
    pub fn cuboid(low: Vec3, high: Vec3) -> Self {
        let corner = |i: u32| vec3(pick(i & 1, low.x, high.x), pick(i & 2, low.y, high.y), pick(i & 4, low.z, high.z));
        const FACES: [[u32; 4]; 6] = [[0, 4, 6, 2], [5, 1, 3, 7], [0, 1, 5, 4], [6, 7, 3, 2], [1, 0, 2, 3], [4, 5, 7, 6]];
        FACES.iter().map(|face| Self::quad(face.map(corner))).sum()
    }

    pub fn transformed(mut self, transform: Affine3A) -> Self {
        let normal_matrix = transform.matrix3.inverse().transpose();
        self.positions.iter_mut().for_each(|p| *p = transform.transform_point3(*p));
        self.normals.iter_mut().for_each(|n| *n = Vec3::from(normal_matrix * glam::Vec3A::from(*n)).normalize());
        if transform.matrix3.determinant() < 0.0 {
            self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        self
    }

    pub fn translated(self, offset: Vec3) -> Self {
        self.transformed(Affine3A::from_translation(offset))
    }

    /// Texture coordinates multiplied, for textures that repeat.
    pub fn tiled(mut self, repeats: Vec2) -> Self {
        self.uvs.iter_mut().for_each(|uv| *uv *= repeats);
        self
    }

    pub fn append(&mut self, other: Surface) {
        let base = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.normals.extend(other.normals);
        self.uvs.extend(other.uvs);
        self.triangles.extend(other.triangles.into_iter().map(|t| t.map(|i| i + base)));
    }

    fn push(&mut self, position: Vec3, normal: Vec3, uv: Vec2) {
        self.positions.push(position);
        self.normals.push(normal);
        self.uvs.push(uv);
    }
}

impl std::iter::Sum for Surface {
    fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
        parts.fold(Self::default(), |mut whole, part| {
            whole.append(part);
            whole
        })
    }
}

fn pick(bit: u32, low: f32, high: f32) -> f32 {
    if bit == 0 { low } else { high }
}

/// (u, v) of a grid's vertices, row by row.
fn lattice(columns: u32, rows: u32) -> impl Iterator<Item = (f32, f32)> {
    (0..=rows).flat_map(move |j| (0..=columns).map(move |i| (i as f32 / columns as f32, j as f32 / rows as f32)))
}

fn lattice_triangles(columns: u32, rows: u32) -> Vec<[u32; 3]> {
    let stride = columns + 1;
    let cell = |j: u32, i: u32| {
        let corner = j * stride + i;
        [[corner, corner + 1, corner + stride + 1], [corner, corner + stride + 1, corner + stride]]
    };
    (0..rows).flat_map(|j| (0..columns).flat_map(move |i| cell(j, i))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facing_error(surface: &Surface) -> f32 {
        let corners = |t: &[u32; 3]| t.map(|i| surface.positions[i as usize]);
        let error = |t: &[u32; 3]| {
            let [a, b, c] = corners(t);
            let geometric = (b - a).cross(c - a).normalize();
            1.0 - t.iter().map(|&i| surface.normals[i as usize].dot(geometric)).fold(1.0, f32::min)
        };
        surface.triangles.iter().map(error).fold(0.0, f32::max)
    }

    #[test]
    fn front_faces_agree_with_shading_normals() {
        assert!(facing_error(&Surface::cuboid(Vec3::NEG_ONE, Vec3::ONE)) < 1e-6);
        assert!(facing_error(&Surface::sphere(2.0, 64, 32)) < 0.02);
        assert!(facing_error(&Surface::patch(8, 8, |u, v| vec3(u, u * v, -v))) < 0.02);
    }

    #[test]
    fn sphere_has_no_degenerate_triangle_and_nearly_the_volume_of_a_ball() {
        let sphere = Surface::sphere(1.0, 96, 48);
        let volume: f32 =
            sphere.triangles.iter().map(|t| t.map(|i| sphere.positions[i as usize])).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
        assert!((volume / (4.0 / 3.0 * PI) - 1.0).abs() < 0.01);
        assert_eq!(sphere.triangles.len(), 2 * 96 * 47);
    }
}
