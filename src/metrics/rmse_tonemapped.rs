//! Root mean squared error of what a screen emits: tonemapped, but not gamma-corrected (Voorhuis 2018, chapter 7).

use super::{Pair, mse};

/// Root of the mean over pixels and channels of (a - b)^2, for linear display values in [0, 1].
pub fn rmse_tonemapped(displayed: &Pair) -> f64 {
    mse(displayed).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display::{Image, ToneMapping};

    /// Radiance 1 becomes 2.54 / 3.16, radiance 0 stays 0.
    #[test]
    fn a_wrong_half_of_the_picture_counts_half_its_square() {
        let [image, reference] = [[1.0, 0.0], [0.0, 0.0]]
            .map(|values: [f32; 2]| ToneMapping::default().displayed(&Image::new(2, 1, values.map(|value| [value; 3]).to_vec())));
        let error = rmse_tonemapped(&Pair::new(&image, &reference).unwrap());
        assert!((error - 2.54 / 3.16 * 0.5f64.sqrt()).abs() < 1e-6, "{error}");
    }
}
