//! A glTF 2.0 document under construction, written as a .glb.

use super::surface::Surface;
use glam::{Mat3, Quat, Vec3};
use serde_json::{Value, json};
use std::collections::BTreeSet;

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// Every `add_*` returns the index of what it added, as other parts of the document refer to it.
pub struct Document {
    root: Value,
    binary: Vec<u8>,
}

/// Vertex and index accessors of a surface, which several meshes may share.
#[derive(Debug, Clone)]
pub struct Geometry {
    attributes: Value,
    indices: usize,
}

impl Document {
    pub fn new(name: &str) -> Self {
        let root = json!({
            "asset": { "version": "2.0", "generator": "pathspace" },
            "scene": 0,
            "scenes": [{ "name": name, "nodes": [] }],
        });
        Self { root, binary: Vec::new() }
    }

    /// `extras.environment` of the scene: a constant environment, which core glTF cannot express; for readers that know it.
    pub fn set_environment(&mut self, radiance: [f32; 3]) {
        self.root["scenes"][0]["extras"] = json!({ "environment": radiance });
    }

    pub fn add_geometry(&mut self, surface: &Surface) -> Geometry {
        let (low, high) = surface.positions.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
        let position = self.add_accessor(bytemuck::cast_slice(&surface.positions), "VEC3", FLOAT, 12, Some(ARRAY_BUFFER));
        self.root["accessors"][position]["min"] = json!(low.to_array());
        self.root["accessors"][position]["max"] = json!(high.to_array());
        let normal = self.add_accessor(bytemuck::cast_slice(&surface.normals), "VEC3", FLOAT, 12, Some(ARRAY_BUFFER));
        let uv = self.add_accessor(bytemuck::cast_slice(&surface.uvs), "VEC2", FLOAT, 8, Some(ARRAY_BUFFER));
        let indices = self.add_accessor(bytemuck::cast_slice(&surface.triangles), "SCALAR", UNSIGNED_INT, 4, Some(ELEMENT_ARRAY_BUFFER));
        Geometry { attributes: json!({ "POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv }), indices }
    }

    /// A mesh of one primitive per (geometry, material).
    pub fn add_mesh(&mut self, name: &str, primitives: &[(&Geometry, usize)]) -> usize {
        let primitive = |(geometry, material): &(&Geometry, usize)| json!({ "attributes": geometry.attributes, "indices": geometry.indices, "material": material });
        self.add("meshes", json!({ "name": name, "primitives": primitives.iter().map(primitive).collect::<Vec<_>>() }))
    }

    /// A mesh of its own at the scene's root, for what is neither shared nor moved. Returns the node.
    pub fn add_object(&mut self, name: &str, surface: &Surface, material: usize) -> usize {
        let geometry = self.add_geometry(surface);
        let mesh = self.add_mesh(name, &[(&geometry, material)]);
        self.add_node(json!({ "name": name, "mesh": mesh }))
    }

    /// `material` as glTF says it; its name is set here.
    pub fn add_material(&mut self, name: &str, mut material: Value) -> usize {
        material["name"] = json!(name);
        self.add("materials", material)
    }

    /// An embedded PNG with a repeating, trilinear sampler.
    pub fn add_texture(&mut self, name: &str, image: &image::DynamicImage) -> usize {
        let mut png = std::io::Cursor::new(Vec::new());
        image.write_to(&mut png, image::ImageFormat::Png).expect("a PNG fits into memory");
        let view = self.add_view(&png.into_inner(), None);
        let source = self.add("images", json!({ "name": name, "mimeType": "image/png", "bufferView": view }));
        let sampler = match self.root.get("samplers") {
            Some(_) => 0,
            None => self.add("samplers", json!({ "magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497 })),
        };
        self.add("textures", json!({ "name": name, "source": source, "sampler": sampler }))
    }

    /// A node at the scene's root.
    pub fn add_node(&mut self, node: Value) -> usize {
        let index = self.add_child_node(node);
        push(&mut self.root["scenes"][0]["nodes"], json!(index));
        index
    }

    /// A node that some other node lists among its children.
    pub fn add_child_node(&mut self, node: Value) -> usize {
        self.add("nodes", node)
    }

    /// A perspective camera at `eye`; `yfov` in radians.
    pub fn add_camera(&mut self, eye: Vec3, target: Vec3, yfov: f32) -> usize {
        let camera = self.add("cameras", json!({ "type": "perspective", "perspective": { "yfov": yfov, "znear": 0.01 } }));
        self.add_node(json!({ "name": "camera", "camera": camera, "translation": eye.to_array(), "rotation": look_rotation(target - eye).to_array() }))
    }

    /// KHR_lights_punctual; the result goes into a node as [`light_reference`].
    pub fn add_light(&mut self, light: Value) -> usize {
        let lights = &mut self.root["extensions"]["KHR_lights_punctual"]["lights"];
        push(lights, light)
    }

    /// A channel that moves `path` ("translation", "rotation" or "scale") of `node` through `values` at `times`, in seconds, linearly.
    /// All channels are one animation.
    pub fn animate(&mut self, node: usize, path: &str, times: &[f32], values: &[Vec<f32>]) {
        let input = self.add_accessor(bytemuck::cast_slice(times), "SCALAR", FLOAT, 4, None);
        self.root["accessors"][input]["min"] = json!([times.iter().copied().fold(f32::INFINITY, f32::min)]);
        self.root["accessors"][input]["max"] = json!([times.iter().copied().fold(f32::NEG_INFINITY, f32::max)]);
        let (kind, width) = if path == "rotation" { ("VEC4", 4) } else { ("VEC3", 3) };
        let output = self.add_accessor(bytemuck::cast_slice(&values.concat()), kind, FLOAT, 4 * width, None);
        if self.root["animations"].is_null() {
            self.root["animations"] = json!([{}]);
        }
        let animation = &mut self.root["animations"][0];
        let sampler = push(&mut animation["samplers"], json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
        push(&mut animation["channels"], json!({ "sampler": sampler, "target": { "node": node, "path": path } }));
    }

    pub fn into_glb(mut self) -> Vec<u8> {
        let mut names = BTreeSet::new();
        collect_extensions(&self.root, &mut names);
        if !names.is_empty() {
            self.root["extensionsUsed"] = json!(names);
        }
        self.root["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        let mut text = serde_json::to_vec(&self.root).expect("a JSON value can be written");
        text.resize(text.len().next_multiple_of(4), b' ');
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let total = 12 + 8 + text.len() + 8 + self.binary.len();
        let mut glb = Vec::with_capacity(total);
        glb.extend(b"glTF");
        glb.extend(2u32.to_le_bytes());
        glb.extend((total as u32).to_le_bytes());
        for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &self.binary)] {
            glb.extend((chunk.len() as u32).to_le_bytes());
            glb.extend(kind);
            glb.extend(chunk);
        }
        glb
    }

    fn add_accessor(&mut self, bytes: &[u8], kind: &str, component: u32, element_size: usize, target: Option<u32>) -> usize {
        let view = self.add_view(bytes, target);
        let count = bytes.len() / element_size;
        self.add("accessors", json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }))
    }

    fn add_view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.binary.extend(bytes);
        self.add("bufferViews", view)
    }

    fn add(&mut self, array: &str, item: Value) -> usize {
        push(&mut self.root[array], item)
    }
}

/// A node's `extensions` that places light `index`.
pub fn light_reference(index: usize) -> Value {
    json!({ "KHR_lights_punctual": { "light": index } })
}

/// Rotation of a camera or light, whose own axis is -z, towards `direction`, with +y up.
pub fn look_rotation(direction: Vec3) -> Quat {
    let up = if direction.normalize().y.abs() < 0.999 { Vec3::Y } else { Vec3::X };
    let z = -direction.normalize();
    let x = up.cross(z).normalize();
    Quat::from_mat3(&Mat3::from_cols(x, z.cross(x), z))
}

fn push(array: &mut Value, item: Value) -> usize {
    if array.is_null() {
        *array = json!([]);
    }
    let items = array.as_array_mut().expect("the document keeps arrays under these keys");
    items.push(item);
    items.len() - 1
}

fn collect_extensions(value: &Value, names: &mut BTreeSet<String>) {
    match value {
        Value::Object(members) => {
            if let Some(Value::Object(extensions)) = members.get("extensions") {
                names.extend(extensions.keys().cloned());
            }
            members.values().for_each(|member| collect_extensions(member, names));
        }
        Value::Array(items) => items.iter().for_each(|item| collect_extensions(item, names)),
        _ => {}
    }
}
