//! Energy: the one error that no filter hides.

use super::Pair;

/// The picture's mean over pixels and channels by the reference's. 1 is right; NaN where both are black.
pub fn mean_ratio(pair: &Pair) -> f64 {
    let sums =
        pair.pixels().fold([0.0; 2], |[a, b], (image, reference)| [a + image.iter().sum::<f64>(), b + reference.iter().sum::<f64>()]);
    sums[0] / sums[1]
}

#[cfg(test)]
mod tests {
    use super::super::judged::{assert_close, images};
    use super::*;

    #[test]
    fn mean_ratio_agrees_with_numpy() {
        let (image, reference) = images();
        assert_close(mean_ratio(&Pair::new(&image, &reference).unwrap()), 1.0000674182918308, 1e-7);
    }
}
