//! Pixels that no correct renderer makes.

use crate::display::Image;
use rayon::prelude::*;

/// Numbers of pixels of which at least one channel is so.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Faults {
    pub nan: usize,
    /// Of either sign.
    pub infinite: usize,
    /// Below zero, -infinity too; not -0.
    pub negative: usize,
}

impl Faults {
    pub fn of(image: &Image) -> Faults {
        let count = |fault: fn(&f32) -> bool| image.pixels.par_iter().filter(|pixel| pixel.iter().any(fault)).count();
        Faults { nan: count(|x| x.is_nan()), infinite: count(|x| x.is_infinite()), negative: count(|x| *x < 0.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_fault_is_counted_once_a_pixel() {
        let (nan, infinity) = (f32::NAN, f32::INFINITY);
        let pixels = vec![[0.0, -0.0, 1.0], [nan, nan, 1.0], [infinity, -infinity, nan], [-1e-30, 0.0, 0.0], [0.0, 0.0, infinity]];
        assert_eq!(Faults::of(&Image::new(5, 1, pixels)), Faults { nan: 2, infinite: 2, negative: 2 });
    }
}
