//! Peak signal-to-noise ratio.

use super::{Pair, mse};

/// -10 log10(mse) in dB, for encoded values whose peak is 1. Infinite for equal pictures; more is better.
pub fn psnr(encoded: &Pair) -> f64 {
    -10.0 * mse(encoded).log10()
}

#[cfg(test)]
mod tests {
    use super::super::judged::{assert_close, images};
    use super::*;

    #[test]
    fn psnr_agrees_with_scikit_image() {
        let (image, reference) = images();
        assert_close(psnr(&Pair::new(&image, &reference).unwrap()), 28.729916601667597, 1e-6);
    }
}
