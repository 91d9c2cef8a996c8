//! FLIP, the difference that a person sees when flipping between two pictures: Andersson et al. 2020, "FLIP: A Difference
//! Evaluator for Alternating Images", on the paper's screen of 67.02 pixels per degree: 3840 pixels on 0.7 m, seen from 0.7 m.
//!
//! Colours and details are compared apart (sections 4.1 and 4.2) and combined (4.3). Everything up to the comparison depends on one
//! picture alone: that is its [`Percept`].
//!
//! *Deviations and why.* Kernels are applied as rows and columns, which their being Gaussians permits without approximation.
//! Pictures are not rounded to 8 bits.

mod colour;
mod filter;
pub mod hdr;

use super::{ErrorMap, Pair};
use crate::display::{Image, tonemap::srgb_decode};
use colour::{huntlab, hyab, linear_to_opponent, opponent_to_linear};
use filter::{Contrast, Features, Plane};
use rayon::prelude::*;
use std::sync::LazyLock;

/// Metres from eye to screen, over pixels per metre, over one degree: `distance * (pixels / width) * pi / 180`.
const PIXELS_PER_DEGREE: f64 = 0.7 * (3840.0 / 0.7) * (std::f64::consts::PI / 180.0);

/// q_c, p_c and p_t of section 4.1: colour differences are compressed by a power; those up to 40 % of the largest fill the range up
/// to 0.95.
const COLOUR_EXPONENT: f64 = 0.7;
const KNEE: f64 = 0.4;
const KNEE_ERROR: f64 = 0.95;
/// q_f of section 4.2.
const FEATURE_EXPONENT: f64 = 0.5;

/// The largest compressed colour difference that a screen can show: green against blue.
static LARGEST_DIFFERENCE: LazyLock<f64> = LazyLock::new(|| hyab(huntlab([0.0, 1.0, 0.0]), huntlab([0.0, 0.0, 1.0])).powf(COLOUR_EXPONENT));

/// LDR-FLIP of sRGB-encoded values, each pixel 0 (none) to 1. Values beyond [0, 1] are clipped.
pub fn flip(encoded: &Pair) -> ErrorMap {
    flip_of_each(&[encoded.image], encoded.reference).remove(0)
}

/// LDR-FLIP of several pictures of one reference.
pub(super) fn flip_of_each(encoded: &[&Image], reference: &Image) -> Vec<ErrorMap> {
    let seen = Percept::new(&decoded(reference));
    encoded.iter().map(|image| seen.difference(&Percept::new(&decoded(image)))).collect()
}

/// sRGB bytes of the magma colour map, three a pixel, rows from the top: black is no error, bright yellow is 1.
pub fn heatmap(map: &ErrorMap) -> Vec<u8> {
    map.errors.iter().flat_map(|error| colorous::MAGMA.eval_continuous(*error).into_array()).collect()
}

fn decoded(encoded: &Image) -> Image {
    let pixels = encoded.pixels.par_iter().map(|pixel| pixel.map(|value| srgb_decode(value.clamp(0.0, 1.0)))).collect();
    Image::new(encoded.width, encoded.height, pixels)
}

/// What an observer sees of one picture.
struct Percept {
    width: usize,
    /// L*a*b* under the Hunt effect, of the colours that the eye resolves.
    colours: Vec<[f64; 3]>,
    /// Strength of edges and of points, for each pixel.
    features: [Vec<f64>; 2],
}

impl Percept {
    /// Of linear display values in [0, 1].
    fn new(display_values: &Image) -> Percept {
        let width = display_values.width as usize;
        let opponent: Vec<[f64; 3]> = display_values.pixels.par_iter().map(|pixel| linear_to_opponent(pixel.map(f64::from))).collect();
        let plane = |value: fn(&[f64; 3]) -> f64| Plane { width, values: opponent.iter().map(value).collect() };
        let features = Features::at(PIXELS_PER_DEGREE).strengths(&plane(|[y, ..]| (y + 16.0) / 116.0));
        let [y, cx, cz] = Contrast::at(PIXELS_PER_DEGREE).seen([plane(|c| c[0]), plane(|c| c[1]), plane(|c| c[2])]);
        let colour = |i: usize| huntlab(opponent_to_linear([y.values[i], cx.values[i], cz.values[i]]).map(|value| value.clamp(0.0, 1.0)));
        Percept { width, colours: (0..opponent.len()).into_par_iter().map(colour).collect(), features }
    }

    /// Equation 15: differences of features make those of colours worse.
    fn difference(&self, other: &Percept) -> ErrorMap {
        let errors = (0..self.colours.len()).into_par_iter().map(|i| {
            let colour = redistributed(hyab(self.colours[i], other.colours[i]));
            let [edges, points] = [0, 1].map(|kind: usize| (self.features[kind][i] - other.features[kind][i]).abs());
            let feature = (edges.max(points) * std::f64::consts::FRAC_1_SQRT_2).powf(FEATURE_EXPONENT);
            colour.powf(1.0 - feature)
        });
        ErrorMap { width: self.width, errors: errors.collect() }
    }
}

/// Section 4.1.4: a colour difference to [0, 1].
fn redistributed(difference: f64) -> f64 {
    let (compressed, largest) = (difference.powf(COLOUR_EXPONENT), *LARGEST_DIFFERENCE);
    let knee = KNEE * largest;
    match compressed < knee {
        true => KNEE_ERROR / knee * compressed,
        false => KNEE_ERROR + (compressed - knee) / (largest - knee) * (1.0 - KNEE_ERROR),
    }
}

#[cfg(test)]
mod tests {
    use super::super::judged::{assert_close, images};
    use super::*;

    #[test]
    fn flip_agrees_with_its_authors_python_package() {
        let (image, reference) = images();
        let map = flip(&Pair::new(&image, &reference).unwrap());
        assert_close(map.mean(), 0.06851343810558319, 1e-5);
        assert_close(map.percentile_99(), 0.13970715, 1e-5);
    }

    #[test]
    fn black_and_white_are_nearly_as_far_apart_as_can_be() {
        let [black, white] = [0.0, 1.0].map(|value| Image::new(4, 4, vec![[value; 3]; 16]));
        let error = flip(&Pair::new(&black, &white).unwrap()).mean();
        assert!((0.95..1.0).contains(&error), "{error}");
    }

    #[test]
    fn heatmaps_go_from_black_to_bright_yellow() {
        let bytes = heatmap(&ErrorMap { width: 2, errors: vec![0.0, 1.0] });
        assert_eq!(bytes, [0, 0, 4, 252, 253, 191]);
    }
}
