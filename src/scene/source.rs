//! What a user calls a scene: a file, or a built-in one by its name.

use super::{LoadError, Scene, builtin, gltf};
use std::path::Path;

/// Why there is no scene.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    #[error(transparent)]
    Builtin(#[from] builtin::BuiltinError),
    #[error(transparent)]
    File(#[from] LoadError),
    #[error("'{name}' is neither a file nor a built-in scene; built in are {known}")]
    Unknown { name: String, known: String },
}

/// A built-in scene where one has that name (`hall`, `hall:100000`), else the .gltf or .glb file.
///
/// # Errors
/// Neither is there, or the file is not what it should be.
pub fn load(source: &str) -> Result<Scene, SourceError> {
    let path = Path::new(source);
    Ok(match builtin::find(source)? {
        Some(request) => request.load()?,
        None if path.extension().is_none() && !path.exists() => {
            let known = builtin::names().collect::<Vec<_>>().join(", ");
            return Err(SourceError::Unknown { name: source.to_owned(), known });
        }
        None => gltf::load(path)?,
    })
}
