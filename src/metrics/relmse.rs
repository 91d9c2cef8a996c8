//! Relative mean squared error, as the papers on adaptive sampling and denoising report it
//! (Rousselle, Knaus and Zwicker 2011, section 5: squared error over squared reference plus 0.01).

use super::Pair;

/// The fraction of pixels that published figures usually leave out, so that fireflies of one method do not decide.
pub const WORST_TRIMMED: f64 = 0.001;

/// What a squared error is multiplied by where the reference is `reference`.
pub fn weight(reference: f64) -> f64 {
    1.0 / (reference * reference + 0.01)
}

/// Mean over pixels and channels of (a - b)^2 / (b^2 + 0.01), without the `trimmed` fraction (0 to 1) of the worst pixels.
pub fn relmse(pair: &Pair, trimmed: f64) -> f64 {
    let mut errors = pair.pixel_errors(|a, b| (a - b).powi(2) * weight(b));
    let kept = errors.len() - (errors.len() as f64 * trimmed) as usize;
    if kept < errors.len() {
        errors.select_nth_unstable_by(kept, f64::total_cmp);
    }
    errors[..kept].iter().sum::<f64>() / kept as f64
}

#[cfg(test)]
mod tests {
    use super::super::judged::{assert_close, images};
    use super::*;

    #[test]
    fn relmse_agrees_with_numpy() {
        let (image, reference) = images();
        let pair = Pair::new(&image, &reference).unwrap();
        assert_close(relmse(&pair, 0.0), 0.014939483567326958, 1e-6);
        assert_close(relmse(&pair, WORST_TRIMMED), 0.014837351570788497, 1e-6);
    }

    #[test]
    fn trimming_forgets_a_firefly() {
        let (mut image, reference) = images();
        let calm = relmse(&Pair::new(&image, &reference).unwrap(), WORST_TRIMMED);
        image.pixels[700] = [1e6; 3];
        let pair = Pair::new(&image, &reference).unwrap();
        assert!(relmse(&pair, 0.0) > 1e6 && relmse(&pair, WORST_TRIMMED) < 1.01 * calm);
    }
}
