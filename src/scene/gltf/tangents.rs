//! Tangents by mikktspace, the convention that normal maps are baked with.

use std::collections::HashMap;

use glam::{Affine2, Vec2, Vec3};

use super::geometry;
use crate::scene::{Mesh, TextureRef};

/// mikktspace recurses once for each triangle around a vertex, and compares each with each: a fan of a hundred thousand would take
/// minutes, or the stack.
const MAX_VALENCE: usize = 2000;

struct Corners<'a> {
    mesh: &'a Mesh,
    uv: Vec<[f32; 2]>,
    /// Three for each triangle.
    tangents: Vec<[f32; 4]>,
}

impl bevy_mikktspace::Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.mesh.triangles[face][corner] as usize]
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.normals[self.mesh.triangles[face][corner] as usize]
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.uv[self.mesh.triangles[face][corner] as usize]
    }

    /// glTF's v axis points down: its handedness is the opposite of mikktspace's.
    fn set_tangent_encoded(&mut self, [x, y, z, sign]: [f32; 4], face: usize, corner: usize) {
        self.tangents[3 * face + corner] = [x, y, z, -sign];
    }
}

impl Corners<'_> {
    /// The direction in which u grows on each triangle, without smoothing.
    fn follow_each_triangle(&mut self) {
        for (triangle, tangents) in self.mesh.triangles.iter().zip(self.tangents.as_chunks_mut::<3>().0) {
            let [a, b, c] = triangle.map(|vertex| Vec3::from(self.mesh.positions[vertex as usize]));
            let [uv_a, uv_b, uv_c] = triangle.map(|vertex| Vec2::from(self.uv[vertex as usize]));
            let (to_b, to_c) = (uv_b - uv_a, uv_c - uv_a);
            let handedness = -to_b.perp_dot(to_c).signum();
            let along_u = ((b - a) * to_c.y - (c - a) * to_b.y) * -handedness;
            for (vertex, tangent) in triangle.iter().zip(tangents) {
                let normal = Vec3::from(self.mesh.normals[*vertex as usize]);
                *tangent = along_u.reject_from_normalized(normal).normalize_or_zero().extend(handedness).to_array();
            }
        }
    }
}

/// Adds tangents for `normal_map`, splitting vertices where the triangles around one disagree.
/// Returns false, and leaves the mesh as it was, without the texture coordinates that the map uses.
pub(super) fn generate(mesh: &mut Mesh, normal_map: &TextureRef) -> bool {
    let uv = if normal_map.uv_set == 0 { &mesh.uv0 } else { &mesh.uv1 };
    if uv.is_empty() {
        return false;
    }
    let [row_u, row_v] = normal_map.transform;
    let transform = Affine2::from_cols_array(&[row_u[0], row_v[0], row_u[1], row_v[1], row_u[2], row_v[2]]);
    let uv = uv.iter().map(|&uv| transform.transform_point2(Vec2::from(uv)).to_array()).collect();
    let mut corners = Corners { mesh, uv, tangents: vec![[0.0, 0.0, 0.0, 1.0]; 3 * mesh.triangles.len()] };
    if largest_valence(corners.mesh) <= MAX_VALENCE {
        bevy_mikktspace::generate_tangents(&mut corners);
    } else {
        corners.follow_each_triangle();
    }
    let tangents = corners.tangents;
    weld(mesh, &tangents);
    true
}

/// Corners at the most crowded position.
fn largest_valence(mesh: &Mesh) -> usize {
    let mut valences = HashMap::<[u32; 3], usize>::with_capacity(mesh.positions.len());
    for &vertex in mesh.triangles.as_flattened() {
        *valences.entry(mesh.positions[vertex as usize].map(f32::to_bits)).or_default() += 1;
    }
    valences.into_values().max().unwrap_or(0)
}

/// One vertex for each pair of an old vertex and a tangent.
fn weld(mesh: &mut Mesh, tangents: &[[f32; 4]]) {
    let mut known = HashMap::with_capacity(mesh.positions.len());
    let mut order = Vec::with_capacity(mesh.positions.len());
    let mut vertex_tangents = Vec::with_capacity(mesh.positions.len());
    for (vertex, tangent) in mesh.triangles.as_flattened_mut().iter_mut().zip(tangents) {
        *vertex = *known.entry((*vertex, tangent.map(f32::to_bits))).or_insert_with(|| {
            order.push(*vertex);
            vertex_tangents.push(*tangent);
            order.len() as u32 - 1
        });
    }
    geometry::gather(mesh, &order);
    mesh.tangents = vertex_tangents;
}
