//! A scene as the host knows it: what a glTF file, or a built-in generator, says, checked and repaired.
//!
//! Units: metres, seconds, radians; radiance in W/(sr m^2), point and spot intensity in W/sr (glTF's candela taken 1:1),
//! directional irradiance in W/m^2 (glTF's lux taken 1:1). Right-handed, y up, as glTF. Colours are linear Rec. 709.
//! Mesh data stays in the mesh's own space, in single precision; node transforms compose in double precision.

pub mod alias;
pub mod animation;
pub mod builtin;
pub mod camera;
pub mod effects;
mod emission;
pub mod environment;
pub mod environment_distribution;
pub mod error;
mod fingerprint;
pub mod gltf;
pub mod lights;
pub mod material;
pub mod merge;
pub mod packing;
pub mod placed;
pub mod pose;
pub mod source;
pub mod texture;
pub mod transform;
pub mod upload;

pub use animation::Animation;
pub use camera::{CameraView, UnknownCamera};
pub use environment::Environment;
pub use error::{LoadError, Problem};
pub use material::{AlphaMode, Material, TextureRef};
pub use texture::Texture;
pub use transform::{Local, Node};

/// Everything a frame can be rendered from.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// File stem or built-in name.
    pub name: String,
    pub meshes: Vec<Mesh>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    /// Parents come before their children.
    pub nodes: Vec<Node>,
    pub instances: Vec<Instance>,
    pub lights: Vec<Light>,
    pub cameras: Vec<Camera>,
    pub animation: Animation,
    pub environment: Environment,
    /// What was repaired, skipped or ignored while loading.
    pub warnings: Vec<Warning>,
}

/// One glTF mesh: all its primitives as one indexed triangle list, so that it is one bottom-level structure.
///
/// `normals` is as long as `positions`, unit length, never NaN. `tangents` (xyz, handedness in w), `uv0`, `uv1` and `colors`
/// (linear RGBA) are either as long as `positions` or empty. Indices are in range; no triangle is degenerate (two equal
/// positions, or zero area in double precision).
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    pub name: String,
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub tangents: Vec<[f32; 4]>,
    pub uv0: Vec<[f32; 2]>,
    pub uv1: Vec<[f32; 2]>,
    pub colors: Vec<[f32; 4]>,
    pub triangles: Vec<[u32; 3]>,
    /// Index into [`Scene::materials`] of each triangle.
    pub triangle_materials: Vec<u32>,
}

/// A mesh placed by a node.
#[derive(Debug, Clone, Copy)]
pub struct Instance {
    pub mesh: u32,
    pub node: u32,
}

/// KHR_lights_punctual, placed by a node: at its origin, shining along its -z.
#[derive(Debug, Clone)]
pub struct Light {
    pub name: String,
    pub node: u32,
    /// Linear colour times intensity; the unit depends on `kind`.
    pub color: [f32; 3],
    pub kind: LightKind,
    /// Metres; no light arrives beyond it, as KHR_lights_punctual's smooth window.
    pub range: Option<f32>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// `color` in W/sr.
    Point,
    /// `color` in W/sr on the axis of the equivalent point light; `radius` in metres, from `extras.radius`. The sphere radiates evenly:
    /// L = color / (pi radius^2).
    Sphere { radius: f32 },
    /// `color` in W/sr on the axis; half angles in radians; falloff as KHR_lights_punctual recommends.
    Spot { inner_cone_angle: f32, outer_cone_angle: f32 },
    /// `color` in W/m^2.
    Directional,
}

#[derive(Debug, Clone)]
pub struct Camera {
    pub name: String,
    /// The camera looks along the node's -z, +y up.
    pub node: u32,
    pub projection: Projection,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Vertical field of view, radians.
    Perspective { yfov: f32 },
    /// Half height of the view in metres.
    Orthographic { ymag: f32 },
}

/// Something that loading repaired or ignored, counted: one line for the user.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Warning {
    /// For example "degenerate triangles skipped in mesh 'Vase'".
    pub message: String,
    pub count: u64,
}
