//! Repairs of one primitive's triangles: what glTF leaves out or files get wrong.

use glam::{DVec3, Vec3};

use super::warnings::Warnings;
use crate::scene::Mesh;

/// Removes triangles without an area; vertices stay.
pub(super) fn drop_degenerate_triangles(mesh: &mut Mesh) -> usize {
    let before = mesh.triangles.len();
    let positions = &mesh.positions;
    mesh.triangles.retain(|triangle| area_normal(positions, triangle).length_squared() > 0.0);
    before - mesh.triangles.len()
}

/// Twice the triangle's area, along its geometric normal, in double precision.
pub(super) fn area_normal(positions: &[[f32; 3]], triangle: &[u32; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|vertex| Vec3::from(positions[vertex as usize]).as_dvec3());
    (b - a).cross(c - a)
}

/// Gives each triangle vertices and normals of its own.
pub(super) fn flatten_normals(mesh: &mut Mesh) {
    let corners: Vec<u32> = mesh.triangles.as_flattened().to_vec();
    gather(mesh, &corners);
    mesh.triangles = (0..mesh.triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let normal = |triangle| area_normal(&mesh.positions, triangle).normalize().as_vec3().to_array();
    mesh.normals = mesh.triangles.iter().flat_map(|triangle| [normal(triangle); 3]).collect();
}

/// Makes vertex `i` a copy of what was vertex `order[i]`. Triangles are the caller's.
pub(super) fn gather(mesh: &mut Mesh, order: &[u32]) {
    fn pick<T: Copy>(values: &mut Vec<T>, order: &[u32]) {
        if !values.is_empty() {
            *values = order.iter().map(|&vertex| values[vertex as usize]).collect();
        }
    }
    pick(&mut mesh.positions, order);
    pick(&mut mesh.normals, order);
    pick(&mut mesh.tangents, order);
    pick(&mut mesh.uv0, order);
    pick(&mut mesh.uv1, order);
    pick(&mut mesh.colors, order);
}

/// Makes all normals unit length; those that have no direction become the mean of the triangles around.
pub(super) fn repair_normals(mesh: &mut Mesh) -> usize {
    let mut broken = Vec::new();
    for (vertex, normal) in mesh.normals.iter_mut().enumerate() {
        match unit(*normal) {
            Some(unit) => *normal = unit,
            None => broken.push(vertex),
        }
    }
    if broken.is_empty() {
        return 0;
    }
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let normal = area_normal(&mesh.positions, triangle);
        triangle.iter().for_each(|&vertex| sums[vertex as usize] += normal);
    }
    for &vertex in &broken {
        mesh.normals[vertex] = sums[vertex].try_normalize().unwrap_or(DVec3::Y).as_vec3().to_array();
    }
    broken.len()
}

/// In double precision: neither tiny nor huge vectors overflow.
fn unit(vector: [f32; 3]) -> Option<[f32; 3]> {
    Some(Vec3::from(vector).as_dvec3().try_normalize()?.as_vec3().to_array())
}

/// Gives tangents that have no direction one that is perpendicular to the normal, and every handedness the value 1 or -1.
pub(super) fn repair_tangents(mesh: &mut Mesh) -> usize {
    let mut repaired = 0;
    for (tangent, normal) in mesh.tangents.iter_mut().zip(&mesh.normals) {
        let handedness = if tangent[3] < 0.0 { -1.0 } else { 1.0 };
        let direction = unit([tangent[0], tangent[1], tangent[2]]);
        repaired += usize::from(direction.is_none());
        let [x, y, z] = direction.unwrap_or_else(|| Vec3::from(*normal).any_orthonormal_vector().to_array());
        *tangent = [x, y, z, handedness];
    }
    repaired
}

/// Replaces values that are not finite.
pub(super) fn repair_attribute<const N: usize>(values: &mut [[f32; N]], replacement: [f32; N]) -> usize {
    let broken = values.iter_mut().filter(|value| value.iter().any(|component| !component.is_finite()));
    broken.map(|value| *value = replacement).count()
}

/// Appends `part` to `mesh`; attributes that only one of them has are filled with neutral values.
pub(super) fn append(mesh: &mut Mesh, part: Mesh) {
    fn join<T: Copy>(values: &mut Vec<T>, vertices: usize, part: Vec<T>, part_vertices: usize, neutral: T) {
        if values.is_empty() && part.is_empty() {
            return;
        }
        values.resize(vertices, neutral);
        values.extend(part);
        values.resize(vertices + part_vertices, neutral);
    }
    let (vertices, added) = (mesh.positions.len(), part.positions.len());
    mesh.positions.extend(part.positions);
    mesh.normals.extend(part.normals);
    // No normal map reads a tangent of length zero: the repair below turns it into a perpendicular.
    join(&mut mesh.tangents, vertices, part.tangents, added, [0.0, 0.0, 0.0, 1.0]);
    join(&mut mesh.uv0, vertices, part.uv0, added, [0.0; 2]);
    join(&mut mesh.uv1, vertices, part.uv1, added, [0.0; 2]);
    join(&mut mesh.colors, vertices, part.colors, added, [1.0; 4]);
    mesh.triangles.extend(part.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + vertices as u32)));
    mesh.triangle_materials.extend(part.triangle_materials);
}

/// Everything above that any primitive may need, counted.
pub(super) fn repair(mesh: &mut Mesh, place: &str, warnings: &mut Warnings) {
    warnings.add_count(format!("degenerate triangles skipped in {place}"), drop_degenerate_triangles(mesh));
    let broken = repair_attribute(&mut mesh.uv0, [0.0; 2])
        + repair_attribute(&mut mesh.uv1, [0.0; 2])
        + repair_attribute(&mut mesh.colors, [1.0; 4]);
    warnings.add_count(format!("texture coordinates or colours that were not finite replaced in {place}"), broken);
    if mesh.normals.is_empty() {
        mesh.tangents.clear();
        flatten_normals(mesh);
    } else {
        warnings.add_count(format!("zero or non-finite normals repaired in {place}"), repair_normals(mesh));
    }
    warnings.add_count(format!("zero or non-finite tangents repaired in {place}"), repair_tangents(mesh));
}
