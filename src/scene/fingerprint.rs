//! A hash of everything in a scene that its picture depends on.

use super::{Environment, Mesh, Scene, Texture};
use blake3::Hasher;

impl Scene {
    /// Of content alone, not of where it came from: equal for equal scenes, whatever the program's run or machine.
    pub fn fingerprint(&self) -> blake3::Hash {
        let mut hasher = Hasher::new();
        self.meshes.iter().for_each(|mesh| add_mesh(&mut hasher, mesh));
        self.textures.iter().for_each(|texture| add_texture(&mut hasher, texture));
        // Small, and their debug form holds every digit.
        let Scene { materials, nodes, instances, lights, cameras, animation, .. } = self;
        add(&mut hasher, format!("{materials:?}{nodes:?}{instances:?}{lights:?}{cameras:?}{animation:?}").as_bytes());
        match &self.environment {
            Environment::Constant(radiance) => add(&mut hasher, bytemuck::cast_slice(radiance)),
            Environment::Map { width, pixels, .. } => {
                add(&mut hasher, &width.to_le_bytes());
                add(&mut hasher, bytemuck::cast_slice(pixels));
            }
        }
        hasher.finalize()
    }
}

fn add_mesh(hasher: &mut Hasher, mesh: &Mesh) {
    let Mesh { name: _, positions, normals, tangents, uv0, uv1, colors, triangles, triangle_materials } = mesh;
    add(hasher, bytemuck::cast_slice(positions));
    add(hasher, bytemuck::cast_slice(normals));
    add(hasher, bytemuck::cast_slice(tangents));
    add(hasher, bytemuck::cast_slice(uv0));
    add(hasher, bytemuck::cast_slice(uv1));
    add(hasher, bytemuck::cast_slice(colors));
    add(hasher, bytemuck::cast_slice(triangles));
    add(hasher, bytemuck::cast_slice(triangle_materials));
}

fn add_texture(hasher: &mut Hasher, texture: &Texture) {
    let Texture { name: _, width, height, srgb, mips, wrap, filter } = texture;
    mips.iter().for_each(|mip| add(hasher, mip));
    add(hasher, format!("{width} {height} {srgb} {wrap:?} {filter:?}").as_bytes());
}

/// The length first, so that no two lists of parts run together to the same bytes.
fn add(hasher: &mut Hasher, bytes: &[u8]) {
    hasher.update(&(bytes.len() as u64).to_le_bytes());
    hasher.update(bytes);
}

#[cfg(test)]
mod tests {
    use super::super::source;

    #[test]
    fn equal_scenes_have_one_fingerprint_and_a_moved_vertex_another() {
        let mut scene = source::load("cornell").unwrap();
        let before = scene.fingerprint();
        assert_eq!(before, source::load("cornell").unwrap().fingerprint());
        scene.meshes[0].positions[0][0] += 1e-6;
        assert_ne!(before, scene.fingerprint());
        assert_ne!(before, source::load("furnace").unwrap().fingerprint());
    }
}
