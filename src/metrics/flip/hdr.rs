//! HDR-FLIP: Andersson et al. 2021, "Visualizing Errors in Rendered High Dynamic Range Images". No exposure suits all of a picture of
//! high dynamic range, so each pixel has the largest LDR-FLIP over exposures that go from the brightest pixel's to the median's.
//!
//! *Deviations and why.* Negative radiance is black: the authors' tone curve rises below 0, which would show it as light. A
//! reference of one luminance has one exposure, where the authors' program refuses.

use super::super::{ErrorMap, Pair, luminance};
use super::Percept;
use crate::display::{Image, ToneCurve, ToneMapping};

/// A display value that is nearly as bright as a screen gets, but not yet burnt out (section 4).
const NEARLY_WHITE: f64 = 0.85;
/// ACES' own exposure, before Narkowicz's curve.
const ACES_EXPOSURE: f64 = 0.6;
/// Coefficients of Narkowicz's curve: (a x + b) x / ((c x + d) x + e).
const CURVE: [f64; 5] = [2.51, 0.03, 2.43, 0.59, 0.14];

/// HDR-FLIP of radiance, each pixel 0 (none) to 1.
pub fn hdr_flip(radiance: &Pair) -> ErrorMap {
    hdr_flip_of_each(&[radiance.image], radiance.reference).remove(0)
}

/// HDR-FLIP of several pictures of one reference, which is seen but once at each exposure.
pub(in crate::metrics) fn hdr_flip_of_each(images: &[&Image], reference: &Image) -> Vec<ErrorMap> {
    let none = ErrorMap { width: reference.width as usize, errors: vec![0.0; reference.pixels.len()] };
    let mut worst = vec![none; images.len()];
    for exposure in exposures(reference) {
        let mapping = ToneMapping { exposure: (exposure + ACES_EXPOSURE.log2()) as f32, curve: ToneCurve::Aces };
        let percept = |image: &Image| Percept::new(&mapping.displayed(image));
        let seen = percept(reference);
        for (worst, image) in worst.iter_mut().zip(images) {
            let errors = seen.difference(&percept(image)).errors;
            worst.errors.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error));
        }
    }
    worst
}

/// In stops, evenly spaced and about one apart (section 4): from where the brightest pixel of the reference is nearly white to where
/// the median pixel is.
pub fn exposures(reference: &Image) -> Vec<f64> {
    let mut luminances: Vec<f64> = reference.pixels.iter().map(|pixel| luminance(pixel.map(f64::from))).collect();
    let middle = luminances.len() / 2;
    let brightest = luminances.iter().copied().fold(0.0, f64::max);
    let median = *luminances.select_nth_unstable_by(middle, f64::total_cmp).1;
    // Half the picture may be black; the authors stop at the precision of a float, too.
    let exposure_of = |luminance: f64| (radiance_shown_as(NEARLY_WHITE) / luminance.max(f64::from(f32::EPSILON))).log2();
    let (start, stop) = (exposure_of(brightest), exposure_of(median));
    if start == stop {
        return vec![start];
    }
    let count = ((stop - start).ceil() as usize).max(2);
    (0..count).map(|i| start + (stop - start) * i as f64 / (count - 1) as f64).collect()
}

/// The inverse of the tone curve: the positive root of its quadratic equation.
fn radiance_shown_as(display_value: f64) -> f64 {
    let [a, b, c, d, e] = CURVE;
    let [quadratic, linear, constant] = [a - display_value * c, b - display_value * d, -display_value * e];
    let root = (-linear + (linear * linear - 4.0 * quadratic * constant).sqrt()) / (2.0 * quadratic);
    root / ACES_EXPOSURE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_of_the_tone_curve_leads_back() {
        let mapping = ToneMapping { exposure: ACES_EXPOSURE.log2() as f32, curve: ToneCurve::Aces };
        assert!((mapping.display_values([radiance_shown_as(NEARLY_WHITE) as f32; 3])[0] - 0.85).abs() < 1e-6);
    }

    #[test]
    fn one_luminance_has_one_exposure_and_black_half_a_picture_has_many() {
        let grey = |values: &[f32]| Image::new(values.len() as u32, 1, values.iter().map(|value| [*value; 3]).collect());
        assert_eq!(exposures(&grey(&[2.0; 4])).len(), 1);
        assert_eq!(exposures(&grey(&[0.0; 4])).len(), 1);
        // From one times the white radiance of 2.1189 to that over 2^-23.
        let half_black = exposures(&grey(&[0.0, 0.0, 0.0, 1.0]));
        assert_eq!(half_black.len(), 23);
        assert!((half_black[0] - 1.083_297).abs() < 1e-5 && (half_black[22] - 24.083_297).abs() < 1e-5, "{half_black:?}");
    }
}
