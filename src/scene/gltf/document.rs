//! The JSON part of a file, parsed and checked, so that every index in it is in range.

use gltf::json::{
    Index, Path, Root,
    mesh::Semantic,
    validation::{self, Checked, Validate},
};
use serde::Deserialize;
use serde_json::{Map, Value};

use crate::scene::Problem;

/// Extensions that a file may require. `EXT_texture_webp` comes with the image decoder.
pub(super) const SUPPORTED_EXTENSIONS: [&str; 12] = [
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

pub(super) struct Document<'a> {
    pub root: Root,
    /// One for each of `root.nodes`, which hold them in single precision only.
    pub transforms: Vec<NodeTransform>,
    /// The BIN chunk of a .glb.
    pub bin: Option<&'a [u8]>,
}

/// A node's transform as the file writes it: large worlds need more than single precision.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeTransform {
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    pub matrix: Option<[f64; 16]>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct NodeTransforms {
    nodes: Vec<NodeTransform>,
}

pub(super) fn parse(bytes: &[u8]) -> Result<Document<'_>, Problem> {
    let (json, bin) = split(bytes)?;
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    let root = Root::from_slice(json).or_else(|error| with_optional_filled_in(json).ok_or(malformed(error)))?;
    let transforms = serde_json::from_slice::<NodeTransforms>(json).map_err(malformed)?.nodes;
    check_version(&root)?;
    check_required_extensions(&root)?;
    check_indices(&root)?;
    Ok(Document { root, transforms, bin })
}

/// The JSON library insists on two things that glTF does not: the nodes of a scene, and of an animation channel, which is without
/// effect where it has none.
fn with_optional_filled_in(json: &[u8]) -> Option<Root> {
    let mut json: Value = serde_json::from_slice(json).ok()?;
    for scene in objects(&mut json, "scenes") {
        scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
    }
    for animation in objects(&mut json, "animations") {
        if let Some(Value::Array(channels)) = animation.get_mut("channels") {
            channels.retain(|channel| !channel["target"].is_object() || !channel["target"]["node"].is_null());
        }
    }
    serde_json::from_value(json).ok()
}

fn objects<'a>(json: &'a mut Value, array: &str) -> impl Iterator<Item = &'a mut Map<String, Value>> {
    json.get_mut(array).and_then(Value::as_array_mut).into_iter().flatten().filter_map(Value::as_object_mut)
}

fn malformed(reason: impl ToString) -> Problem {
    Problem::Malformed { expected: "a glTF 2.0 file", reason: reason.to_string() }
}

/// JSON and BIN chunks of a .glb; a .gltf is all JSON.
fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Problem> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes, None));
    }
    let claimed = bytes.get(8..12).map_or(0, |length| u32::from_le_bytes([length[0], length[1], length[2], length[3]]) as usize);
    // The parser subtracts the header from this length unchecked.
    if claimed < 12 || claimed > bytes.len() {
        return Err(malformed(format!("the header claims {claimed} bytes, the file has {}", bytes.len())));
    }
    let (header, mut rest) = bytes[..claimed].split_at(12);
    if header[4..8] != [2, 0, 0, 0] {
        return Err(malformed("only version 2 of the binary container is supported"));
    }
    let (kind, json) = next_chunk(&mut rest)?.ok_or_else(|| malformed("the JSON chunk is missing"))?;
    if kind != *b"JSON" {
        return Err(malformed("the first chunk is not JSON"));
    }
    let bin = next_chunk(&mut rest)?.filter(|(kind, _)| kind == b"BIN\0");
    Ok((json, bin.map(|(_, data)| data)))
}

/// Kind and data.
type Chunk<'a> = ([u8; 4], &'a [u8]);

/// None at the end.
fn next_chunk<'a>(rest: &mut &'a [u8]) -> Result<Option<Chunk<'a>>, Problem> {
    if rest.is_empty() {
        return Ok(None);
    }
    let (header, data) = rest.split_first_chunk::<8>().ok_or_else(|| malformed("a chunk header is cut off"))?;
    let length = u32::from_le_bytes([header[0], header[1], header[2], header[3]]) as usize;
    let (chunk, after) =
        data.split_at_checked(length).ok_or_else(|| malformed(format!("a chunk claims {length} bytes, but {} are left", data.len())))?;
    *rest = after;
    Ok(Some(([header[4], header[5], header[6], header[7]], chunk)))
}

fn check_version(root: &Root) -> Result<(), Problem> {
    let needed = root.asset.min_version.as_ref().unwrap_or(&root.asset.version);
    if needed == "2.0" || (root.asset.min_version.is_none() && needed.starts_with("2.")) {
        return Ok(());
    }
    Err(malformed(format!("it needs version {needed} of the format")))
}

fn check_required_extensions(root: &Root) -> Result<(), Problem> {
    match root.extensions_required.iter().find(|name| !SUPPORTED_EXTENSIONS.contains(&name.as_str())) {
        Some(name) => Err(Problem::UnsupportedExtension(name.clone())),
        None => Ok(()),
    }
}

/// Every index is in range and every enumeration known; what is merely missing is left to those who need it.
fn check_indices(root: &Root) -> Result<(), Problem> {
    check_positions(root)?;
    let mut first = None;
    root.validate(root, Path::new, &mut |path, error| {
        let place = path();
        // Attributes of unknown meaning are no harm; extensions were checked before.
        let harmless =
            matches!(error, validation::Error::Missing | validation::Error::Unsupported) || place.as_str().contains("<invalid semantic");
        if !harmless && first.is_none() {
            first = Some(Problem::invalid(place.as_str(), describe(error)));
        }
    });
    first.map_or(Ok(()), Err)
}

fn describe(error: validation::Error) -> &'static str {
    match error {
        validation::Error::IndexOutOfBounds => "refers to an element that the file does not have",
        _ => "has a value that glTF does not allow",
    }
}

/// The validation of the JSON library itself reads these without a check.
fn check_positions(root: &Root) -> Result<(), Problem> {
    for (mesh_index, mesh) in root.meshes.iter().enumerate() {
        for (index, primitive) in mesh.primitives.iter().enumerate() {
            let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
            if positions.is_some_and(|accessor| root.get(*accessor).is_none()) {
                let place = format!("meshes[{mesh_index}].primitives[{index}].attributes.POSITION");
                return Err(Problem::invalid(place, describe(validation::Error::IndexOutOfBounds)));
            }
        }
    }
    Ok(())
}

/// "mesh 'Vase'" or "mesh 3".
pub(super) fn label<T>(kind: &str, index: Index<T>, name: &Option<String>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} '{name}'"),
        _ => format!("{kind} {}", index.value()),
    }
}
