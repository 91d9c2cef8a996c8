//! Images: decoded and mip-mapped in parallel, each once, as the textures that the materials ask for.

use std::{borrow::Cow, collections::HashMap, io::Cursor, path::Path};

use gltf::json::{
    Image, Index, Root,
    texture::{MagFilter, Texture as Json, WrappingMode},
    validation::Checked,
};
use rayon::prelude::*;

use super::{
    buffers::{Buffers, read_uri},
    document::label,
    warnings::Warnings,
};
use crate::scene::{
    Problem, Texture,
    texture::{Filter, Sampler, Wrap},
};

/// Largest width and height, in texels.
const MAX_SIDE: u32 = 16384;
/// Decoded bytes of one image and of all images of a file: small files can hold enormous uniform ones.
const MAX_IMAGE_BYTES: u64 = 1 << 30;
const MAX_TOTAL_BYTES: u64 = 1 << 33;

/// What a material reads a texture as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Role {
    /// RGB in sRGB.
    Color,
    Data,
    Normal,
}

impl Role {
    /// What a texture that cannot be decoded becomes: a factor of one, or a flat surface.
    fn neutral(self) -> [u8; 4] {
        if self == Role::Normal { [128, 128, 255, 255] } else { [255; 4] }
    }
}

struct Request {
    image: Option<Index<Image>>,
    sampler: Sampler,
    role: Role,
}

/// The distinct textures that materials ask for.
#[derive(Default)]
pub(super) struct Textures {
    requests: Vec<Request>,
    known: HashMap<(Option<Index<Image>>, Sampler, Role), u32>,
}

impl Textures {
    /// Index of the texture in the scene. Equal images read in the same way are one.
    pub fn request(&mut self, root: &Root, index: Index<Json>, json: &Json, role: Role) -> u32 {
        debug_assert_eq!(root.textures[index.value()].source, json.source);
        let image = image_of(root, json);
        let sampler = json.sampler.map_or(Sampler::default(), |sampler| read_sampler(&root.samplers[sampler.value()]));
        *self.known.entry((image, sampler, role)).or_insert_with(|| {
            self.requests.push(Request { image, sampler, role });
            self.requests.len() as u32 - 1
        })
    }

    /// Decodes each image once; those that cannot be decoded are replaced and counted.
    pub fn decode(self, root: &Root, buffers: &Buffers, base_dir: Option<&Path>, warnings: &mut Warnings) -> Result<Vec<Texture>, Problem> {
        let mut users: HashMap<Option<Index<Image>>, Vec<usize>> = HashMap::new();
        for (i, request) in self.requests.iter().enumerate() {
            users.entry(request.image).or_default().push(i);
        }
        let mut images: Vec<_> = users.into_iter().collect();
        images.sort_by_key(|(image, _)| image.map(|image| image.value()));
        let sources: Vec<_> = images.par_iter().map(|(image, _)| source(root, buffers, base_dir, *image)).collect();
        // In the file's order, so that of several errors always the same one is told.
        let sources: Vec<_> = sources.into_iter().collect::<Result<_, _>>()?;
        check_total(&sources)?;
        let decoded: Vec<_> =
            images.par_iter().zip(sources).map(|((image, users), source)| self.build(root, *image, users, source)).collect();
        let mut textures: Vec<Option<Texture>> = vec![None; self.requests.len()];
        let mut messages = Vec::new();
        for (i, texture, message) in decoded.into_iter().flatten() {
            textures[i] = Some(texture);
            messages.extend(message);
        }
        messages.sort();
        messages.into_iter().for_each(|message| warnings.add(message));
        Ok(textures.into_iter().flatten().collect())
    }

    /// The textures made of one image, each with its index and a warning.
    fn build(
        &self,
        root: &Root,
        image: Option<Index<Image>>,
        users: &[usize],
        source: Result<Encoded, String>,
    ) -> Vec<(usize, Texture, Option<String>)> {
        let name = image.map_or("image of an unsupported kind".into(), |image| label("image", image, &root.images[image.value()].name));
        let decoded = source.and_then(|source| source.decode());
        let build_one = |&i: &usize| {
            let Request { sampler, role, .. } = self.requests[i];
            let srgb = role == Role::Color;
            match &decoded {
                Ok((size, pixels)) => (i, Texture::new(name.clone(), *size, pixels.clone(), srgb, sampler), None),
                Err(reason) => {
                    let message = format!("{name} replaced by a uniform one: {reason}");
                    (i, Texture::flat(name.clone(), role.neutral(), srgb, sampler), Some(message))
                }
            }
        };
        users.par_iter().map(build_one).collect()
    }
}

/// The image of the core format, or that of EXT_texture_webp.
fn image_of(root: &Root, texture: &Json) -> Option<Index<Image>> {
    let webp = || {
        let extension = texture.extensions.as_ref()?.others.get("EXT_texture_webp")?;
        Some(Index::new(u32::try_from(extension.get("source")?.as_u64()?).ok()?))
    };
    [Some(texture.source), webp()].into_iter().flatten().find(|image| root.get(*image).is_some())
}

fn read_sampler(json: &gltf::json::texture::Sampler) -> Sampler {
    let wrap = |mode: &Checked<WrappingMode>| match mode.as_ref().unwrap() {
        WrappingMode::ClampToEdge => Wrap::Clamp,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
        WrappingMode::Repeat => Wrap::Repeat,
    };
    let nearest = json.mag_filter.as_ref().is_some_and(|filter| *filter == Checked::Valid(MagFilter::Nearest));
    Sampler { wrap: [wrap(&json.wrap_s), wrap(&json.wrap_t)], filter: if nearest { Filter::Nearest } else { Filter::Linear } }
}

/// An encoded image whose header says that it is worth decoding.
struct Encoded<'a> {
    bytes: Cow<'a, [u8]>,
    size: [u32; 2],
}

/// Outer error: the file is wrong; inner: this image is replaced.
fn source<'a>(
    root: &Root,
    buffers: &'a Buffers,
    base_dir: Option<&Path>,
    image: Option<Index<Image>>,
) -> Result<Result<Encoded<'a>, String>, Problem> {
    let Some(index) = image else { return Ok(Err("the texture has no source in a supported format".into())) };
    let json = &root.images[index.value()];
    let bytes = match (json.buffer_view, &json.uri) {
        (Some(view), _) => Ok(Cow::Borrowed(buffers.view(root, view)?)),
        (None, Some(uri)) => read_uri(uri, base_dir).map(Cow::Owned),
        (None, None) => Err("it has neither a buffer view nor a uri".into()),
    };
    let bytes = match bytes {
        Ok(bytes) => bytes,
        Err(reason) => return Ok(Err(reason)),
    };
    let size = image::ImageReader::new(Cursor::new(&bytes))
        .with_guessed_format()
        .map_err(image::ImageError::from)
        .and_then(|r| r.into_dimensions());
    match size {
        _ if has_no_texels(&bytes) => {
            Err(Problem::invalid(label("image", index, &json.name), "has a size of 0; replace it by a real image"))
        }
        Ok((width, height)) => Ok(Ok(Encoded { bytes, size: [width, height] })),
        Err(error) => Ok(Err(error.to_string())),
    }
}

/// An empty file, or a PNG whose header (first chunk: width and height at bytes 16 to 24) says so: the decoder only calls it damaged.
fn has_no_texels(bytes: &[u8]) -> bool {
    let png_size = bytes.starts_with(b"\x89PNG").then(|| bytes.get(16..24)).flatten();
    bytes.is_empty() || png_size.is_some_and(|size| size[..4] == [0; 4] || size[4..] == [0; 4])
}

fn check_total(sources: &[Result<Encoded, String>]) -> Result<(), Problem> {
    let texels = |source: &Encoded| source.size.iter().map(|&side| u64::from(side)).product::<u64>();
    let total: u64 = sources.iter().flatten().map(|source| 4 * texels(source)).fold(0, u64::saturating_add);
    if total <= MAX_TOTAL_BYTES {
        return Ok(());
    }
    Err(Problem::invalid("images", format!("need {} GiB decoded, at most {} are allowed", total >> 30, MAX_TOTAL_BYTES >> 30)))
}

impl Encoded<'_> {
    /// Size and RGBA texels.
    fn decode(&self) -> Result<([u32; 2], Vec<u8>), String> {
        let mut reader = image::ImageReader::new(Cursor::new(&self.bytes)).with_guessed_format().map_err(|error| error.to_string())?;
        let mut limits = image::Limits::default();
        (limits.max_image_width, limits.max_image_height) = (Some(MAX_SIDE), Some(MAX_SIDE));
        limits.max_alloc = Some(MAX_IMAGE_BYTES);
        reader.limits(limits);
        let pixels = reader.decode().map_err(|error| error.to_string())?.into_rgba8();
        Ok((pixels.dimensions().into(), pixels.into_raw()))
    }
}
