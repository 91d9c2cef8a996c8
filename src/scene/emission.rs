//! How much light a textured triangle emits, estimated from the texture's mips.

use super::texture::{Texture, Wrap};
use super::{Mesh, Scene, TextureRef};

/// A textured triangle's estimate is at least this share of its texture's mean: four look-ups may all miss its bright part, and what can
/// emit must stay possible to choose.
const LEAST_SHARE: f64 = 0.02;

/// Radiance, W/(sr m^2), mean of the channels over the triangle.
pub(super) fn mean_emission(scene: &Scene, mesh: &Mesh, primitive: usize) -> f64 {
    let material = &scene.materials[mesh.triangle_materials[primitive] as usize];
    let factor = material.emission.map(f64::from);
    let texel = match &material.emission_texture {
        Some(reference) => mean_texel(&scene.textures[reference.texture as usize], reference, mesh, primitive),
        None => [1.0; 3],
    };
    (0..3).map(|channel| factor[channel] * texel[channel]).sum::<f64>() / 3.0
}

/// Mean of four places, each standing for a quarter of the triangle, in the mip level whose texels are about that large.
fn mean_texel(texture: &Texture, reference: &TextureRef, mesh: &Mesh, primitive: usize) -> [f64; 3] {
    let uv = if reference.uv_set == 1 { &mesh.uv1 } else { &mesh.uv0 };
    let corner = |corner: u32| {
        let [u, v] = uv.get(corner as usize).copied().unwrap_or_default().map(f64::from);
        reference.transform.map(|row| f64::from(row[0]) * u + f64::from(row[1]) * v + f64::from(row[2]))
    };
    let [a, b, c] = mesh.triangles[primitive].map(corner);
    let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
    let texels = area * f64::from(texture.width) * f64::from(texture.height) / 4.0;
    let last = texture.mips.len() - 1;
    let level = ((0.5 * texels.max(1.0).log2()).round() as usize).min(last);
    let at =
        |weights: [f64; 3]| texel(texture, level, [0, 1].map(|axis| weights[0] * a[axis] + weights[1] * b[axis] + weights[2] * c[axis]));
    let (near, far) = (2.0 / 3.0, 1.0 / 6.0);
    let places = [at([1.0 / 3.0; 3]), at([near, far, far]), at([far, near, far]), at([far, far, near])];
    let mean = texel(texture, last, [0.5; 2]);
    [0, 1, 2].map(|channel| (places.iter().map(|place| place[channel]).sum::<f64>() / 4.0).max(LEAST_SHARE * mean[channel]))
}

/// The texel, linear, that a place of the texture falls into.
fn texel(texture: &Texture, level: usize, uv: [f64; 2]) -> [f64; 3] {
    let size = [texture.width, texture.height].map(|edge| (edge >> level).max(1) as usize);
    let [column, row] = [0, 1].map(|axis| {
        let place = wrapped(texture.wrap[axis], uv[axis]) * size[axis] as f64;
        (place as usize).min(size[axis] - 1)
    });
    let at = 4 * (row * size[0] + column);
    let channel = |offset: usize| {
        let value = f64::from(texture.mips[level][at + offset]) / 255.0;
        if texture.srgb { linear(value) } else { value }
    };
    [channel(0), channel(1), channel(2)]
}

fn wrapped(wrap: Wrap, place: f64) -> f64 {
    match wrap {
        Wrap::Repeat => place.rem_euclid(1.0),
        Wrap::Mirror => 1.0 - (place.rem_euclid(2.0) - 1.0).abs(),
        Wrap::Clamp => place.clamp(0.0, 1.0),
    }
}

/// IEC 61966-2-1.
fn linear(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Material;
    use crate::scene::texture::Sampler;

    /// A texture whose left half is white and whose right half is black, on one triangle with these corners.
    fn emission_at(uv0: [[f32; 2]; 3]) -> f64 {
        let pixels = (0..64 * 64).flat_map(|i| if i % 64 < 32 { [255; 4] } else { [0, 0, 0, 255] }).collect();
        let reference = TextureRef { texture: 0, uv_set: 0, transform: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] };
        let material = Material { emission: [2.0; 3], emission_texture: Some(reference), ..Default::default() };
        let mesh = Mesh { triangles: vec![[0, 1, 2]], triangle_materials: vec![0], uv0: uv0.to_vec(), ..Default::default() };
        let texture = Texture::new(String::new(), [64, 64], pixels, true, Sampler::default());
        let scene = Scene { textures: vec![texture], materials: vec![material], ..Default::default() };
        mean_emission(&scene, &mesh, 0)
    }

    #[test]
    fn a_triangle_emits_what_its_part_of_the_texture_shows() {
        assert_eq!(emission_at([[0.1, 0.1], [0.4, 0.1], [0.1, 0.4]]), 2.0);
        // All of it, twice over along u: half is white. Four look-ups are an estimate, within a factor of two here.
        let mean = emission_at([[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]]);
        assert!((0.5..=2.0).contains(&mean), "{mean}");
    }

    #[test]
    fn a_triangle_on_a_black_part_stays_possible_to_choose() {
        let least = emission_at([[0.6, 0.1], [0.9, 0.1], [0.6, 0.4]]);
        assert!((0.01..0.05).contains(&least), "{least}");
    }
}
