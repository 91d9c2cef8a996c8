//! An error for each pixel, and what sums it up.

use super::statistics::quantile;

/// Side of the tiles of [`ErrorMap::worst_tile`], in pixels.
const TILE: usize = 16;

/// Rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorMap {
    pub width: usize,
    pub errors: Vec<f64>,
}

impl ErrorMap {
    pub fn mean(&self) -> f64 {
        self.errors.iter().sum::<f64>() / self.errors.len() as f64
    }

    /// What 99 % of the pixels stay below.
    pub fn percentile_99(&self) -> f64 {
        quantile(self.errors.clone(), 0.99)
    }

    /// The largest mean over a tile of 16x16 pixels: an error that is small on the whole may ruin one place. Tiles at the right
    /// and bottom edges are averaged over the pixels that they have.
    pub fn worst_tile(&self) -> f64 {
        let columns = self.width.div_ceil(TILE);
        self.errors.chunks(self.width * TILE).map(|band| self.worst_of_band(band, columns)).fold(f64::NEG_INFINITY, f64::max)
    }

    fn worst_of_band(&self, band: &[f64], columns: usize) -> f64 {
        let mut tiles = vec![(0.0, 0usize); columns];
        for row in band.chunks(self.width) {
            for (tile, part) in tiles.iter_mut().zip(row.chunks(TILE)) {
                *tile = (tile.0 + part.iter().sum::<f64>(), tile.1 + part.len());
            }
        }
        tiles.iter().map(|(sum, count)| sum / *count as f64).fold(f64::NEG_INFINITY, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(width: usize, height: usize, error: impl Fn(usize, usize) -> f64) -> ErrorMap {
        ErrorMap { width, errors: (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| error(x, y)).collect() }
    }

    #[test]
    fn the_worst_tile_is_found_wherever_it_lies() {
        for (left, top) in [(0, 0), (16, 0), (32, 16)] {
            let spot = map(48, 32, |x, y| if (left..left + 16).contains(&x) && (top..top + 16).contains(&y) { 0.5 } else { 0.25 });
            assert_eq!(spot.worst_tile(), 0.5);
        }
        // Half in one tile, half in the next.
        assert_eq!(map(32, 16, |x, _| if (8..24).contains(&x) { 1.0 } else { 0.0 }).worst_tile(), 0.5);
    }

    #[test]
    fn tiles_at_the_edge_count_the_pixels_that_they_have() {
        assert_eq!(map(20, 18, |x, y| if x >= 16 && y >= 16 { 0.75 } else { 0.0 }).worst_tile(), 0.75);
        assert_eq!(map(3, 2, |x, _| x as f64).worst_tile(), 1.0);
    }

    #[test]
    fn mean_and_percentile_of_a_ramp() {
        let ramp = map(101, 1, |x, _| x as f64);
        assert_eq!((ramp.mean(), ramp.percentile_99()), (50.0, 99.0));
    }
}
