//! The scene's static part in device memory: vertices, triangles, materials, textures.
//!
//! Bytes per triangle of a textured mesh with 0.6 vertices per triangle: 12 indices + 4 material + 0.6 x (12 position + 16 attributes)
//! = 33, plus what the acceleration structure takes. One that shines: 4, and 24 for each frame in flight (placed.rs).

use super::lights::emitter_ranks;
use super::packing::{pack_normal, pack_tangent};
use super::texture::{Filter, Texture, Wrap};
use super::{AlphaMode, Material, Mesh, Scene, TextureRef};
use crate::accel::{MeshGeometry, build_input_usage};
use crate::gpu::{Buffer, Gpu, GpuError, ImageInfo, TextureImage, vk};
use crate::shared;
use bytemuck::Pod;

/// Device memory of one scene. Triangles are in the order of the scene's meshes.
pub struct SceneBuffers {
    pub meshes: Vec<MeshGeometry>,
    pub mesh_buffer: Buffer,
    pub material_buffer: Buffer,
    pub textures: Vec<TextureImage>,
    /// Vertices and triangles; kept for their addresses.
    _streams: Vec<Buffer>,
}

/// One kind of data of all meshes, one after the other in one buffer.
struct Stream {
    buffer: Buffer,
    /// Address of each mesh's part, 0 where it has none.
    addresses: Vec<u64>,
}

impl Stream {
    fn upload<T: Pod>(gpu: &Gpu, name: &str, usage: vk::BufferUsageFlags, parts: Vec<Vec<T>>) -> Result<Self, GpuError> {
        let buffer = gpu.upload(name, &parts.concat(), usage)?;
        let mut next = buffer.address();
        let address = |part: &Vec<T>| {
            let address = next;
            next += size_of_val(part.as_slice()) as u64;
            if part.is_empty() { 0 } else { address }
        };
        Ok(Self { addresses: parts.iter().map(address).collect(), buffer })
    }
}

impl SceneBuffers {
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, GpuError> {
        let plain = vk::BufferUsageFlags::empty();
        let input = build_input_usage(gpu.capabilities());
        let meshes = &scene.meshes;
        let positions = Stream::upload(gpu, "positions", input, per_mesh(meshes, |mesh| mesh.positions.clone()))?;
        let attributes = Stream::upload(gpu, "vertex attributes", plain, per_mesh(meshes, vertex_attributes))?;
        let uv1 = Stream::upload(gpu, "second UV set", plain, per_mesh(meshes, |mesh| mesh.uv1.clone()))?;
        let colors = Stream::upload(gpu, "vertex colours", plain, per_mesh(meshes, vertex_colors))?;
        let triangles = Stream::upload(gpu, "triangles", input, per_mesh(meshes, |mesh| mesh.triangles.clone()))?;
        let materials = Stream::upload(gpu, "triangle materials", plain, per_mesh(meshes, |mesh| mesh.triangle_materials.clone()))?;
        let emitters = Stream::upload(gpu, "triangle emitters", plain, emitter_ranks(scene))?;
        let rows: Vec<shared::Mesh> = (0..meshes.len())
            .map(|i| shared::Mesh {
                positions: positions.addresses[i],
                attributes: attributes.addresses[i],
                uv1: uv1.addresses[i],
                colors: colors.addresses[i],
                triangles: triangles.addresses[i],
                triangle_materials: materials.addresses[i],
                triangle_emitters: emitters.addresses[i],
            })
            .collect();
        let geometry = |(mesh, row): (&Mesh, &shared::Mesh)| MeshGeometry {
            positions: row.positions,
            vertex_count: mesh.positions.len() as u32,
            triangles: row.triangles,
            triangle_count: mesh.triangles.len() as u32,
        };
        let material_rows: Vec<shared::Material> = scene.materials.iter().map(|m| pack_material(m, &scene.textures)).collect();
        Ok(Self {
            meshes: meshes.iter().zip(&rows).map(geometry).collect(),
            mesh_buffer: gpu.upload("meshes", &rows, plain)?,
            material_buffer: gpu.upload("materials", &material_rows, plain)?,
            textures: scene.textures.iter().map(|texture| upload_texture(gpu, texture)).collect::<Result<_, _>>()?,
            _streams: [positions, attributes, uv1, colors, triangles, materials, emitters].map(|stream| stream.buffer).into(),
        })
    }
}

impl SceneBuffers {
    pub fn texture_bytes(&self) -> u64 {
        self.textures.iter().map(|texture| texture.image.allocated_bytes()).sum()
    }
}

fn per_mesh<T>(meshes: &[Mesh], of: impl Fn(&Mesh) -> Vec<T>) -> Vec<Vec<T>> {
    meshes.iter().map(of).collect()
}

fn vertex_attributes(mesh: &Mesh) -> Vec<shared::VertexAttributes> {
    let attributes = |(i, &normal): (usize, &[f32; 3])| shared::VertexAttributes {
        normal: pack_normal(normal),
        tangent: mesh.tangents.get(i).map_or(0, |&tangent| pack_tangent(tangent)),
        uv0: mesh.uv0.get(i).copied().unwrap_or_default(),
    };
    mesh.normals.iter().enumerate().map(attributes).collect()
}

fn vertex_colors(mesh: &Mesh) -> Vec<[u16; 4]> {
    let unorm = |channel: f32| (channel.clamp(0.0, 1.0) * 65535.0).round() as u16;
    mesh.colors.iter().map(|color| color.map(unorm)).collect()
}

fn pack_material(material: &Material, textures: &[Texture]) -> shared::Material {
    let slot = |texture: &Option<TextureRef>| pack_texture(texture.as_ref(), textures);
    shared::Material {
        base_color: material.base_color,
        emission: material.emission,
        metallic: material.metallic,
        roughness: material.roughness,
        normal_scale: material.normal_scale,
        ior: material.ior,
        specular: material.specular,
        specular_color: material.specular_color,
        transmission: material.transmission,
        absorption: material.attenuation_color.map(|color| -color.max(1e-6).ln() / material.attenuation_distance),
        thickness: material.thickness,
        clearcoat: material.clearcoat,
        clearcoat_roughness: material.clearcoat_roughness,
        alpha_cutoff: if let AlphaMode::Mask { cutoff } = material.alpha_mode { cutoff } else { 0.0 },
        flags: material_flags(material),
        base_color_texture: slot(&material.base_color_texture),
        metallic_roughness_texture: slot(&material.metallic_roughness_texture),
        normal_texture: slot(&material.normal_texture),
        emission_texture: slot(&material.emission_texture),
        specular_texture: slot(&material.specular_texture),
        specular_color_texture: slot(&material.specular_color_texture),
        transmission_texture: slot(&material.transmission_texture),
        clearcoat_texture: slot(&material.clearcoat_texture),
        clearcoat_roughness_texture: slot(&material.clearcoat_roughness_texture),
        clearcoat_normal_texture: slot(&material.clearcoat_normal_texture),
    }
}

fn material_flags(material: &Material) -> u32 {
    let flag = |set: bool, bit: u32| if set { bit } else { 0 };
    flag(matches!(material.alpha_mode, AlphaMode::Mask { .. }), shared::MATERIAL_ALPHA_MASK)
        | flag(material.alpha_mode == AlphaMode::Blend, shared::MATERIAL_ALPHA_BLEND)
        | flag(material.double_sided, shared::MATERIAL_DOUBLE_SIDED)
        | flag(material.unlit, shared::MATERIAL_UNLIT)
        | flag(material.is_emissive(), shared::MATERIAL_EMISSIVE)
}

/// The second UV set's bit of [`shared::TextureSlot::texture`].
const SECOND_UV_SET: u32 = 1 << 31;

fn pack_texture(reference: Option<&TextureRef>, textures: &[Texture]) -> shared::TextureSlot {
    let Some(reference) = reference else {
        return shared::TextureSlot { texture: u32::MAX, ..Default::default() };
    };
    let texture = &textures[reference.texture as usize];
    let [row0, row1] = reference.transform;
    shared::TextureSlot {
        texture: reference.texture | if reference.uv_set == 1 { SECOND_UV_SET } else { 0 },
        log2_size: 0.5 * (texture.width as f32 * texture.height as f32).log2(),
        transform: [row0[0], row0[1], row0[2], row1[0], row1[1], row1[2]],
    }
}

fn upload_texture(gpu: &Gpu, texture: &Texture) -> Result<TextureImage, GpuError> {
    let address_mode = |wrap| match wrap {
        Wrap::Repeat => vk::SamplerAddressMode::REPEAT,
        Wrap::Mirror => vk::SamplerAddressMode::MIRRORED_REPEAT,
        Wrap::Clamp => vk::SamplerAddressMode::CLAMP_TO_EDGE,
    };
    let (filter, between) = match texture.filter {
        Filter::Nearest => (vk::Filter::NEAREST, vk::SamplerMipmapMode::NEAREST),
        Filter::Linear => (vk::Filter::LINEAR, vk::SamplerMipmapMode::LINEAR),
    };
    let sampler = vk::SamplerCreateInfo::default()
        .mag_filter(filter)
        .min_filter(filter)
        .mipmap_mode(between)
        .address_mode_u(address_mode(texture.wrap[0]))
        .address_mode_v(address_mode(texture.wrap[1]))
        .max_lod(vk::LOD_CLAMP_NONE);
    let format = if texture.srgb { vk::Format::R8G8B8A8_SRGB } else { vk::Format::R8G8B8A8_UNORM };
    let info = ImageInfo { format, extent: [texture.width, texture.height], mip_levels: texture.mips.len() as u32 };
    TextureImage::new(gpu, &texture.name, info, &texture.mips, &sampler)
}
