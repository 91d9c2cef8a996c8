//! What a ray that leaves the scene sees.

/// Radiance from infinity.
#[derive(Debug, Clone, PartialEq)]
pub enum Environment {
    Constant([f32; 3]),
    /// Latitude-longitude map, rows from the top (+y) down. The image's centre is +z, its column at a quarter is +x:
    /// u = 1/2 - atan2(x, z) / (2 pi), v = acos(y) / pi. (Mitsuba's orientation in glTF axes.)
    Map {
        width: u32,
        height: u32,
        pixels: Vec<[f32; 3]>,
    },
}

impl Default for Environment {
    fn default() -> Self {
        Environment::Constant([0.0; 3])
    }
}
