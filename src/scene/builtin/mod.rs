//! Scenes made by code. Each is a glTF document in memory, which goes through the one loader; `pathspace inspect NAME --export` writes it
//! for other renderers. To add one: a file with `make`, and a line in [`REGISTRY`].

mod cornell;
mod document;
mod furnace;
mod hall;
mod material;
mod picture;
mod surface;

use super::{Environment, LoadError, Scene};

/// A scene made by code.
#[derive(Debug)]
pub struct Builtin {
    pub name: &'static str,
    /// One line for the user.
    pub help: &'static str,
    /// Triangles that `name:N` may ask for; `None`: the scene has one size.
    pub triangles: Option<TriangleRange>,
    /// Radiance from everywhere, which core glTF cannot say; black where `None`.
    pub environment: Option<[f32; 3]>,
    /// The document as .glb.
    make: fn(&Options) -> Vec<u8>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TriangleRange {
    pub default: u32,
    pub min: u32,
    pub max: u32,
}

/// What a generator may be told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// Within the scene's [`TriangleRange`]; ignored by scenes without one.
    pub triangles: u32,
}

/// The scene that is shown where none is named.
pub const DEFAULT: &str = "cornell";

pub static REGISTRY: [Builtin; 10] = [
    Builtin {
        name: "cornell",
        help: "Cornell box with the classic dimensions, diffuse, one area light",
        triangles: None,
        environment: None,
        make: cornell::make,
    },
    Builtin {
        name: "cornell-light",
        help: "'cornell' with a lamp that moves below the ceiling, back and forth in 1.2 s",
        triangles: None,
        environment: None,
        make: cornell::make_moving_light,
    },
    Builtin {
        name: "cornell-object",
        help: "'cornell' with a sphere that moves through it, back and forth in 1.2 s",
        triangles: None,
        environment: None,
        make: cornell::make_moving_object,
    },
    Builtin {
        name: "furnace",
        help: "white spheres in a white environment: radiance is 1 everywhere where energy is conserved",
        triangles: None,
        environment: Some(furnace::ENVIRONMENT),
        make: furnace::make,
    },
    Builtin {
        name: "material",
        help: "spheres: ramps of roughness and metalness, glass, mirror, clearcoat, a normal map; textured floor",
        triangles: None,
        environment: Some(material::ENVIRONMENT),
        make: material::make,
    },
    Builtin {
        name: "material-glossy",
        help: "of 'material', the ramps of roughness and metalness",
        triangles: None,
        environment: Some(material::ENVIRONMENT),
        make: material::make_glossy,
    },
    Builtin {
        name: "material-glass",
        help: "solid glass from smooth to rough on the floor of 'material'",
        triangles: None,
        environment: Some(material::ENVIRONMENT),
        make: material::make_glass,
    },
    Builtin {
        name: "hall",
        help: "vaulted hall with columns, carved stone, some eighty small lamps and a turning sculpture",
        triangles: Some(hall::TRIANGLES),
        environment: None,
        make: hall::make,
    },
    Builtin {
        name: "hall-flight",
        help: "'hall' from a camera that winds along the nave, past its columns, in 7 s",
        triangles: Some(hall::TRIANGLES),
        environment: None,
        make: hall::make_flight,
    },
    Builtin {
        name: "still-life",
        help: "all kinds of material and light on one table: assets/scenes/still_life.glb",
        triangles: None,
        environment: None,
        make: |_| include_bytes!("../../../assets/scenes/still_life.glb").to_vec(),
    },
];

pub fn names() -> impl Iterator<Item = &'static str> {
    REGISTRY.iter().map(|builtin| builtin.name)
}

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum BuiltinError {
    #[error("built-in scene '{0}' has one size: leave out what follows the colon")]
    NoSize(&'static str),
    #[error("'{size}' is no size for built-in scene '{name}': give a number of triangles from {} to {}", range.min, range.max)]
    BadSize { name: &'static str, size: String, range: TriangleRange },
}

/// A built-in scene with its size, as the user asked for it.
#[derive(Debug, Clone, Copy)]
pub struct Request {
    pub builtin: &'static Builtin,
    pub options: Options,
}

impl Request {
    /// The scene as a .glb file.
    pub fn glb(&self) -> Vec<u8> {
        (self.builtin.make)(&self.options)
    }

    /// # Errors
    /// None that is not a bug here: the loader is the one that reads users' files.
    pub fn load(&self) -> Result<Scene, LoadError> {
        let mut scene = super::gltf::load_slice(&self.glb(), None, self.builtin.name)?;
        if let Some(radiance) = self.builtin.environment {
            scene.environment = Environment::Constant(radiance);
        }
        Ok(scene)
    }
}

/// Looks up `NAME` or `NAME:TRIANGLES`; `None` where no built-in scene has that name.
///
/// # Errors
/// The name is known, but its size is not one that the scene can have.
pub fn find(spec: &str) -> Result<Option<Request>, BuiltinError> {
    let (name, size) = spec.split_once(':').map_or((spec, None), |(name, size)| (name, Some(size)));
    let Some(builtin) = REGISTRY.iter().find(|builtin| builtin.name == name) else { return Ok(None) };
    let triangles = match (builtin.triangles, size) {
        (None, None) => 0,
        (None, Some(_)) => return Err(BuiltinError::NoSize(builtin.name)),
        (Some(range), None) => range.default,
        (Some(range), Some(size)) => {
            parse_size(size, range).ok_or(BuiltinError::BadSize { name: builtin.name, size: size.to_owned(), range })?
        }
    };
    Ok(Some(Request { builtin, options: Options { triangles } }))
}

fn parse_size(size: &str, range: TriangleRange) -> Option<u32> {
    size.parse().ok().filter(|n| (range.min..=range.max).contains(n))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_document_is_valid_gltf_with_a_camera() {
        for name in names() {
            let bytes = find(name).unwrap().unwrap().glb();
            let file = gltf::Gltf::from_slice(&bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(file.cameras().len(), 1, "{name}");
            assert!(file.nodes().any(|node| node.mesh().is_some()), "{name}");
        }
    }

    #[test]
    fn cornell_has_the_34_triangles_of_the_classic_box() {
        let file = gltf::Gltf::from_slice(&find("cornell").unwrap().unwrap().glb()).unwrap();
        let indices: usize = file.meshes().flat_map(|mesh| mesh.primitives()).map(|primitive| primitive.indices().unwrap().count()).sum();
        assert_eq!(indices, 3 * 34);
    }

    #[test]
    fn a_name_that_is_not_built_in_is_left_to_the_file_system() {
        assert!(find("cornell.glb").unwrap().is_none());
        assert!(find("scenes/cornell").unwrap().is_none());
    }

    #[test]
    fn a_size_for_a_scene_of_one_size_is_an_error() {
        assert_eq!(find("cornell:5").unwrap_err(), BuiltinError::NoSize("cornell"));
    }
}
