//! Node animation: translation, rotation and scale sampled over time.

/// Channels of all of a file's animations, played together from time 0.
#[derive(Debug, Clone, Default)]
pub struct Animation {}
