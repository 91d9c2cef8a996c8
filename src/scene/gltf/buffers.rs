//! Bytes that a file refers to: its own BIN chunk, data URIs and files beside it.

use std::{borrow::Cow, fs, io::Read, path::Path};

use base64::{Engine, engine::general_purpose::GeneralPurpose};
use gltf::json::{Index, Root, buffer::View};

use super::document::Document;
use crate::scene::Problem;

/// The contents of all buffers; never more memory than the files hold.
pub(super) struct Buffers<'a> {
    data: Vec<Cow<'a, [u8]>>,
    /// Bytes in all buffers together.
    pub total: usize,
}

impl<'a> Buffers<'a> {
    pub fn load(document: &Document<'a>, base_dir: Option<&Path>) -> Result<Self, Problem> {
        let buffers = document.root.buffers.iter().enumerate();
        let data: Vec<_> = buffers.map(|(index, buffer)| load_buffer(index, buffer, document.bin, base_dir)).collect::<Result<_, _>>()?;
        let total = data.iter().map(|bytes| bytes.len()).sum();
        Ok(Self { data, total })
    }

    pub fn view(&self, root: &Root, index: Index<View>) -> Result<&[u8], Problem> {
        let view = &root.buffer_views[index.value()];
        let buffer = &self.data[view.buffer.value()];
        let start = view.byte_offset.unwrap_or_default().0;
        let end = start.checked_add(view.byte_length.0);
        end.and_then(|end| buffer.get(usize::try_from(start).ok()?..usize::try_from(end).ok()?)).ok_or_else(|| {
            let what = format!(
                "bytes {start} to {start} + {} lie outside buffer {}, which has {} bytes",
                view.byte_length.0,
                view.buffer.value(),
                buffer.len()
            );
            Problem::invalid(format!("bufferViews[{}]", index.value()), what)
        })
    }
}

fn load_buffer<'a>(
    index: usize,
    buffer: &gltf::json::Buffer,
    bin: Option<&'a [u8]>,
    base_dir: Option<&Path>,
) -> Result<Cow<'a, [u8]>, Problem> {
    let invalid = |what: String| Problem::invalid(format!("buffers[{index}]"), what);
    let data = match &buffer.uri {
        Some(uri) => Cow::Owned(read_uri(uri, base_dir).map_err(invalid)?),
        None if index == 0 => Cow::Borrowed(bin.ok_or_else(|| invalid("has neither a uri nor a BIN chunk".into()))?),
        None => return Err(invalid("has no uri".into())),
    };
    if (data.len() as u64) < buffer.byte_length.0 {
        return Err(invalid(format!("claims {} bytes, but only {} are there: the file is truncated", buffer.byte_length.0, data.len())));
    }
    Ok(data)
}

/// Decodes a data URI or reads the file that a relative, percent-encoded URI names.
pub(super) fn read_uri(uri: &str, base_dir: Option<&Path>) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        return decode_data_uri(data);
    }
    let base_dir = base_dir.ok_or_else(|| format!("refers to the file '{uri}', but an in-memory scene has no folder"))?;
    let relative = percent_encoding::percent_decode_str(uri).decode_utf8().map_err(|_| format!("the uri '{uri}' is not UTF-8"))?;
    read_file(&base_dir.join(relative.as_ref())).map_err(|error| format!("cannot read the file '{relative}' ({error})"))
}

fn decode_data_uri(data: &str) -> Result<Vec<u8>, String> {
    let (header, payload) = data.split_once(',').ok_or("the data URI has no data")?;
    if !header.ends_with(";base64") {
        return Err("the data URI is not base64-encoded".into());
    }
    let padding_optional =
        base64::engine::GeneralPurposeConfig::new().with_decode_padding_mode(base64::engine::DecodePaddingMode::Indifferent);
    let engine = GeneralPurpose::new(&base64::alphabet::STANDARD, padding_optional);
    engine.decode(payload).map_err(|error| format!("the data URI is damaged ({error})"))
}

/// Reads a regular file: a device or a pipe could be endless.
pub(in crate::scene) fn read_file(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut file = fs::File::open(path)?;
    let metadata = file.metadata()?;
    if !metadata.is_file() {
        return Err(std::io::Error::new(std::io::ErrorKind::InvalidInput, "it is not a regular file"));
    }
    let mut bytes = Vec::with_capacity(metadata.len() as usize);
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}
