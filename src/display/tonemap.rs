//! Exposure, tone curve and sRGB encoding, on the CPU.

use super::Image;
use rayon::prelude::*;

/// How radiance above what a screen shows is compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum ToneCurve {
    /// Narkowicz 2015, "ACES Filmic Tone Mapping Curve": a rational fit to the ACES reference rendering transform,
    /// applied per channel, without the 0.6 that matches ACES' own exposure. It maps 1 to 0.80.
    #[default]
    Aces,
    /// Values above 1 are clipped.
    None,
}

/// Exposure, then the curve.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ToneMapping {
    /// Radiance is multiplied by 2^exposure.
    pub exposure: f32,
    pub curve: ToneCurve,
}

impl ToneMapping {
    /// Linear radiance to linear display values in [0, 1].
    pub fn display_values(&self, radiance: [f32; 3]) -> [f32; 3] {
        let gain = self.exposure.exp2();
        radiance.map(|channel| {
            let x = (channel * gain).max(0.0);
            match self.curve {
                ToneCurve::Aces => aces(x),
                ToneCurve::None => x.min(1.0),
            }
        })
    }

    /// The same size, its values linear in [0, 1]: tonemapped without gamma.
    pub fn displayed(&self, image: &Image) -> Image {
        let pixels = image.pixels.par_iter().map(|&pixel| self.display_values(pixel)).collect();
        Image::new(image.width, image.height, pixels)
    }

    /// The same size, its values sRGB-encoded in [0, 1] as a screen takes them; not quantised.
    pub fn encoded(&self, image: &Image) -> Image {
        let pixels = image.pixels.par_iter().map(|&pixel| self.display_values(pixel).map(srgb_encode)).collect();
        Image::new(image.width, image.height, pixels)
    }

    /// sRGB bytes, three a pixel, rows from the top.
    pub fn encoded_bytes(&self, image: &Image) -> Vec<u8> {
        quantised(&self.encoded(image))
    }
}

/// Encoded values in [0, 1] as bytes, three a pixel, rows from the top.
pub fn quantised(encoded: &Image) -> Vec<u8> {
    encoded.pixels.iter().flat_map(|pixel| pixel.map(|value| (value * 255.0).round() as u8)).collect()
}

fn aces(x: f32) -> f32 {
    // The curve is 1.03 at infinity, where inf/inf would be NaN; it passes 1 near 7.
    let x = x.min(1e4);
    ((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)).min(1.0)
}

/// IEC 61966-2-1: linear [0, 1] to encoded [0, 1].
pub fn srgb_encode(linear: f32) -> f32 {
    match linear <= 0.003_130_8 {
        true => 12.92 * linear,
        false => 1.055 * linear.powf(1.0 / 2.4) - 0.055,
    }
}

/// IEC 61966-2-1: encoded [0, 1] to linear [0, 1].
pub fn srgb_decode(encoded: f32) -> f32 {
    match encoded <= 0.040_45 {
        true => encoded / 12.92,
        false => ((encoded + 0.055) / 1.055).powf(2.4),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_decodes_what_it_encodes() {
        for i in 0..=255u8 {
            let encoded = f32::from(i) / 255.0;
            assert_eq!((srgb_encode(srgb_decode(encoded)) * 255.0).round(), f32::from(i));
        }
    }

    #[test]
    fn tone_curves_rise_and_stay_in_range() {
        for curve in [ToneCurve::Aces, ToneCurve::None] {
            let mapping = ToneMapping { exposure: 0.0, curve };
            let values: Vec<f32> =
                [-1.0, 0.0, 1e-4, 0.18, 0.5, 1.0, 1e3, 1e30, f32::INFINITY].map(|x| mapping.display_values([x; 3])[0]).to_vec();
            assert!(values.is_sorted() && values[0] == 0.0 && values[8] == 1.0, "{values:?}");
        }
        assert!((aces(1.0) - 0.8038).abs() < 1e-4);
    }

    #[test]
    fn one_stop_doubles_the_light() {
        let plain = ToneMapping { exposure: 0.0, curve: ToneCurve::Aces };
        let brighter = ToneMapping { exposure: 1.0, ..plain };
        assert_eq!(brighter.display_values([0.1, 0.2, 0.3]), plain.display_values([0.2, 0.4, 0.6]));
    }
}
