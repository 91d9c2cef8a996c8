//! Mean squared error.

use super::Pair;

/// Mean over pixels and channels of (a - b)^2; the unit is that of the picture squared.
pub fn mse(pair: &Pair) -> f64 {
    let errors = pair.pixel_errors(|a, b| (a - b).powi(2));
    errors.iter().sum::<f64>() / errors.len() as f64
}

#[cfg(test)]
mod tests {
    use super::super::judged::{assert_close, images};
    use super::*;

    #[test]
    fn mse_agrees_with_scikit_image() {
        let (image, reference) = images();
        assert_close(mse(&Pair::new(&image, &reference).unwrap()), 0.001339702413719753, 1e-6);
    }
}
