//! Tiny glTF files made in memory.
//!
//! Each test binary uses its own part of this.
#![allow(dead_code)]

use serde_json::{Value, json};

pub const UNSIGNED_BYTE: u32 = 5121;
pub const UNSIGNED_SHORT: u32 = 5123;
pub const UNSIGNED_INT: u32 = 5125;
pub const FLOAT: u32 = 5126;

/// A .glb under construction; tests bend `json` as they need.
pub struct Glb {
    pub json: Value,
    pub bin: Vec<u8>,
}

impl Glb {
    /// No meshes and one node, the root of the scene.
    pub fn empty() -> Self {
        let json = json!({
            "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "name": "root" }],
            "accessors": [], "bufferViews": [], "buffers": [{ "byteLength": 0 }],
        });
        Self { json, bin: Vec::new() }
    }

    /// The triangle (0, 0, 0), (1, 0, 0), (0, 1, 0) with the normal +z, placed by the root: accessor 0 POSITION, 1 NORMAL, 2 indices.
    pub fn triangle() -> Self {
        let mut glb = Self::empty();
        let positions = glb.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let normals = glb.floats("VEC3", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
        let indices = glb.accessor("SCALAR", UNSIGNED_SHORT, 3, bytemuck::cast_slice(&[0u16, 1, 2]));
        let primitive = json!({ "attributes": { "POSITION": positions, "NORMAL": normals }, "indices": indices });
        glb.json["meshes"] = json!([{ "name": "shape", "primitives": [primitive] }]);
        glb.json["nodes"][0]["mesh"] = json!(0);
        glb
    }

    pub fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    pub fn push(&mut self, array: &str, value: Value) -> usize {
        let list = self.json.as_object_mut().unwrap().entry(array).or_insert(json!([])).as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len() });
        self.bin.extend(bytes);
        self.json["buffers"][0]["byteLength"] = json!(self.bin.len());
        self.push("bufferViews", view)
    }

    pub fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.push("accessors", json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }))
    }

    pub fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let components = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            _ => 4,
        };
        self.accessor(kind, FLOAT, values.len() / components, bytemuck::cast_slice(values))
    }

    /// An image in the BIN chunk, and a texture of it.
    pub fn texture(&mut self, encoded: &[u8], mime_type: &str) -> usize {
        let view = self.view(encoded);
        let image = self.push("images", json!({ "bufferView": view, "mimeType": mime_type }));
        self.push("textures", json!({ "source": image }))
    }

    pub fn bytes(&self) -> Vec<u8> {
        let mut json = self.json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut bin = self.bin.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let length = 12 + 8 + json.len() + 8 + bin.len();
        let mut bytes = [&b"glTF"[..], &2u32.to_le_bytes(), &(length as u32).to_le_bytes()].concat();
        for (kind, chunk) in [(b"JSON", json), (b"BIN\0", bin)] {
            bytes.extend((chunk.len() as u32).to_le_bytes());
            bytes.extend(kind);
            bytes.extend(chunk);
        }
        bytes
    }

    pub fn load(&self) -> Result<pathspace::scene::Scene, String> {
        pathspace::scene::gltf::load_slice(&self.bytes(), None, "test").map_err(|error| error.to_string())
    }
}

/// RGBA as a PNG.
pub fn png(width: u32, height: u32, rgba: &[u8]) -> Vec<u8> {
    let mut encoded = std::io::Cursor::new(Vec::new());
    image::write_buffer_with_format(&mut encoded, rgba, width, height, image::ExtendedColorType::Rgba8, image::ImageFormat::Png).unwrap();
    encoded.into_inner()
}
