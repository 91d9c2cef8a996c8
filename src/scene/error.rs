//! Why a file could not become a scene.

/// A file that cannot be loaded: which one, what is wrong with it and where.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {problem}")]
pub struct LoadError {
    /// Path as the user gave it, or the name of an in-memory file.
    pub file: String,
    pub problem: Problem,
}

/// What is wrong with a file, and what to do about it.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    #[error("cannot be read ({0}); check the path and its permissions")]
    Unreadable(#[from] std::io::Error),
    #[error("is not {expected}: {reason}; the file may be damaged or of another kind")]
    Malformed { expected: &'static str, reason: String },
    #[error("needs the extension {0}, which is not supported; export the scene without it")]
    UnsupportedExtension(String),
    /// `place` is a JSON path, or the name of a mesh, node or image.
    #[error("{place}: {what}")]
    Invalid { place: String, what: String },
    #[error("has nothing to render: no triangle is placed by its nodes{skipped}")]
    NothingToRender { skipped: String },
}

impl Problem {
    pub(crate) fn invalid(place: impl Into<String>, what: impl Into<String>) -> Self {
        Problem::Invalid { place: place.into(), what: what.into() }
    }

    pub(crate) fn in_file(self, file: impl Into<String>) -> LoadError {
        LoadError { file: file.into(), problem: self }
    }
}
