//! Meshes: the primitives of each read, repaired and joined into one triangle list.

use std::sync::atomic::{AtomicUsize, Ordering};

use gltf::json::{
    Index, Root,
    accessor::Type,
    mesh::{Mode, Primitive, Semantic},
    validation::Checked,
};
use rayon::prelude::*;

use super::{
    accessor::{Accessor, check_type},
    buffers::Buffers,
    document::label,
    geometry, tangents,
    warnings::Warnings,
};
use crate::scene::{Material, Mesh, Problem, TextureRef};

/// Triangles that any file may have, however small: many meshes can share one accessor. Above it, one for each byte.
const TRIANGLE_FLOOR: usize = 1 << 24;

pub(super) struct Reader<'a> {
    pub root: &'a Root,
    pub buffers: &'a Buffers<'a>,
    /// The file's materials and the default one, which is last.
    pub materials: &'a [Material],
    triangles: AtomicUsize,
}

impl<'a> Reader<'a> {
    pub fn new(root: &'a Root, buffers: &'a Buffers, materials: &'a [Material]) -> Self {
        Self { root, buffers, materials, triangles: AtomicUsize::new(0) }
    }

    /// Reads meshes in parallel, and the primitives of each.
    pub fn read_all(&self, indices: &[usize], warnings: &mut Warnings) -> Result<Vec<Mesh>, Problem> {
        let read: Vec<_> = indices.par_iter().map(|&index| self.read(index)).collect::<Result<_, Problem>>()?;
        let (meshes, mesh_warnings): (Vec<_>, Vec<_>) = read.into_iter().unzip();
        mesh_warnings.into_iter().for_each(|more| warnings.append(more));
        Ok(meshes)
    }

    fn read(&self, index: usize) -> Result<(Mesh, Warnings), Problem> {
        let json = &self.root.meshes[index];
        let place = label("mesh", Index::<Mesh>::new(index as u32), &json.name);
        let mut warnings = Warnings::default();
        let morphed = json.primitives.iter().any(|primitive| primitive.targets.is_some());
        warnings.add_count("morph targets ignored: meshes keep their base shape", usize::from(morphed));
        let primitives = json.primitives.par_iter().enumerate();
        let parts = primitives.map(|(i, primitive)| self.read_primitive(primitive, &place).map_err(|problem| within(problem, &place, i)));
        let mut mesh = Mesh { name: json.name.clone().unwrap_or_default(), ..Mesh::default() };
        for (part, part_warnings) in parts.collect::<Result<Vec<_>, _>>()? {
            warnings.append(part_warnings);
            geometry::append(&mut mesh, part);
        }
        geometry::repair_tangents(&mut mesh);
        Ok((mesh, warnings))
    }

    /// Empty where the primitive has no triangles.
    fn read_primitive(&self, primitive: &Primitive, place: &str) -> Result<(Mesh, Warnings), Problem> {
        let mut warnings = Warnings::default();
        let mode = *primitive.mode.as_ref().unwrap();
        let Some(positions) = attribute(primitive, Semantic::Positions) else {
            warnings.add(format!("primitives without positions skipped in {place}"));
            return Ok((Mesh::default(), warnings));
        };
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            warnings.add(format!("points or lines skipped in {place}"));
            return Ok((Mesh::default(), warnings));
        }
        check_type(self.root, positions, &[Type::Vec3], "POSITION")?;
        let positions = Accessor::new(self.root, self.buffers, positions)?;
        let triangles = self.triangles(primitive, mode, positions.count)?;
        let mut mesh = self.gather(primitive, &positions, triangles)?;
        geometry::repair(&mut mesh, place, &mut warnings);
        let material = primitive.material.map_or(self.materials.len() - 1, |material| material.value());
        match normal_map(&self.materials[material]) {
            Some(normal_map) if mesh.tangents.is_empty() && !mesh.triangles.is_empty() => {
                let made = tangents::generate(&mut mesh, normal_map);
                warnings.add_count(format!("normal maps without texture coordinates in {place}"), usize::from(!made));
            }
            Some(_) => {}
            None => mesh.tangents.clear(),
        }
        mesh.triangle_materials = vec![material as u32; mesh.triangles.len()];
        Ok((mesh, warnings))
    }

    fn triangles(&self, primitive: &Primitive, mode: Mode, vertices: usize) -> Result<Vec<[u32; 3]>, Problem> {
        let indices = primitive.indices.map(|index| Accessor::new(self.root, self.buffers, index)).transpose()?;
        let count = indices.as_ref().map_or(vertices, |indices| indices.count);
        let limit = self.buffers.total.max(TRIANGLE_FLOOR);
        let triangles = if mode == Mode::Triangles { count / 3 } else { count.saturating_sub(2) };
        if self.triangles.fetch_add(triangles, Ordering::Relaxed) + triangles > limit {
            return Err(Problem::invalid("indices", format!("brings the file to more than {limit} triangles, too many for its size")));
        }
        let corners = match indices {
            Some(indices) if indices.is_index() => (0..count).map(|i| indices.index(i)).collect(),
            Some(_) => return Err(Problem::invalid("indices", "must be scalar unsigned integers")),
            None => (0..count as u32).collect::<Vec<_>>(),
        };
        match corners.iter().position(|&corner| corner as usize >= vertices) {
            Some(i) => Err(Problem::invalid("indices", format!("index {i} refers to vertex {} of {vertices}", corners[i]))),
            None => Ok(assemble(mode, &corners)),
        }
    }

    /// The vertices that the triangles use, in the file's order.
    fn gather(&self, primitive: &Primitive, positions: &Accessor, mut triangles: Vec<[u32; 3]>) -> Result<Mesh, Problem> {
        let used = renumber(&mut triangles);
        let mut mesh = Mesh { triangles, ..Mesh::default() };
        mesh.positions = used.iter().map(|&vertex| positions.vector(vertex as usize)).collect();
        if let Some(i) = mesh.positions.iter().position(|position| position.iter().any(|coordinate| !coordinate.is_finite())) {
            return Err(Problem::invalid(
                "POSITION",
                format!("vertex {} is at {:?}; positions must be finite", used[i], mesh.positions[i]),
            ));
        }
        let (vec2, colors) = (&[Type::Vec2][..], &[Type::Vec3, Type::Vec4][..]);
        mesh.normals = self.attribute(primitive, Semantic::Normals, &[Type::Vec3], positions.count, &used)?;
        mesh.tangents = self.attribute(primitive, Semantic::Tangents, &[Type::Vec4], positions.count, &used)?;
        mesh.uv0 = self.attribute(primitive, Semantic::TexCoords(0), vec2, positions.count, &used)?;
        mesh.uv1 = self.attribute(primitive, Semantic::TexCoords(1), vec2, positions.count, &used)?;
        mesh.colors = self.attribute(primitive, Semantic::Colors(0), colors, positions.count, &used)?;
        Ok(mesh)
    }

    /// Empty where the primitive does not have the attribute.
    fn attribute<const N: usize>(
        &self,
        primitive: &Primitive,
        semantic: Semantic,
        types: &[Type],
        vertices: usize,
        used: &[u32],
    ) -> Result<Vec<[f32; N]>, Problem> {
        let name = semantic.to_string();
        let Some(index) = attribute(primitive, semantic) else { return Ok(Vec::new()) };
        check_type(self.root, index, types, &name)?;
        let accessor = Accessor::new(self.root, self.buffers, index)?;
        if accessor.count < vertices {
            return Err(Problem::invalid(name, format!("has {} elements for {vertices} vertices", accessor.count)));
        }
        Ok(used.iter().map(|&vertex| accessor.vector(vertex as usize)).collect())
    }
}

fn within(problem: Problem, mesh: &str, primitive: usize) -> Problem {
    match problem {
        Problem::Invalid { place, what } => Problem::invalid(format!("{mesh}, primitive {primitive}, {place}"), what),
        other => other,
    }
}

fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<Index<gltf::json::Accessor>> {
    primitive.attributes.get(&Checked::Valid(semantic)).copied()
}

/// The texture that a tangent frame is for.
fn normal_map(material: &Material) -> Option<&TextureRef> {
    material.normal_texture.as_ref().or(material.clearcoat_normal_texture.as_ref())
}

/// Triangles of a list, strip or fan, each counter-clockwise (glTF 2.0, section 3.7.2.1).
fn assemble(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let strip = corners.windows(3).enumerate();
            strip
                .map(|(i, corner)| if i % 2 == 0 { [corner[0], corner[1], corner[2]] } else { [corner[0], corner[2], corner[1]] })
                .collect()
        }
        Mode::TriangleFan => corners.get(1..).unwrap_or_default().windows(2).map(|edge| [edge[0], edge[1], corners[0]]).collect(),
        _ => corners.as_chunks::<3>().0.to_vec(),
    }
}

/// Renumbers the vertices of `triangles` without gaps; returns the old number of each.
fn renumber(triangles: &mut [[u32; 3]]) -> Vec<u32> {
    let corners = triangles.as_flattened_mut();
    let (Some(&first), Some(&last)) = (corners.iter().min(), corners.iter().max()) else { return Vec::new() };
    let mut numbers = vec![0; (last - first) as usize + 1];
    corners.iter().for_each(|&corner| numbers[(corner - first) as usize] = 1);
    let mut used = Vec::new();
    for (i, number) in numbers.iter_mut().enumerate().filter(|(_, number)| **number == 1) {
        *number = used.len() as u32;
        used.push(first + i as u32);
    }
    corners.iter_mut().for_each(|corner| *corner = numbers[(*corner - first) as usize]);
    used
}
