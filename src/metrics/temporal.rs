//! Flicker: what changes between subsequent frames and should not.

use super::{MetricError, Pair, luminance};
use crate::display::Image;

/// Mean absolute difference of the luminance of subsequent frames, given as [earlier, later] of linear display values in [0, 1].
///
/// Without references the viewpoint must be fixed and nothing may move, so that any difference is an error (Schied et al. 2017,
/// section 5; Voorhuis 2018, 7.1). With the references of both frames, only what changes beyond them counts:
/// |(x_t - x_(t-1)) - (r_t - r_(t-1))|.
pub fn temporal(frames: [&Image; 2], references: Option<[&Image; 2]>) -> Result<f64, MetricError> {
    let [earlier, later] = frames;
    let changes = luminance_changes(&Pair::new(later, earlier)?);
    let expected = match references {
        None => vec![0.0; changes.len()],
        Some([earlier, later]) => {
            Pair::new(frames[1], later)?;
            luminance_changes(&Pair::new(later, earlier)?)
        }
    };
    Ok(changes.iter().zip(&expected).map(|(change, expected)| (change - expected).abs()).sum::<f64>() / changes.len() as f64)
}

fn luminance_changes(later_and_earlier: &Pair) -> Vec<f64> {
    later_and_earlier.pixels().map(|(later, earlier)| luminance(later) - luminance(earlier)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: [f32; 4]) -> Image {
        Image::new(2, 2, values.map(|value| [value; 3]).to_vec())
    }

    #[test]
    fn a_fixed_viewpoint_forgives_no_change() {
        let error = temporal([&grey([0.0, 0.5, 0.5, 1.0]), &grey([0.5, 0.0, 0.5, 1.0])], None).unwrap();
        assert!((error - 0.25).abs() < 1e-12, "{error}");
    }

    #[test]
    fn motion_that_the_reference_has_too_is_no_flicker() {
        let [before, after] = [grey([0.0, 0.25, 0.5, 1.0]), grey([0.25, 0.5, 1.0, 0.5])];
        let biased = [grey([0.125, 0.375, 0.625, 0.5]), grey([0.375, 0.625, 1.125, 0.0])];
        assert!(temporal([&biased[0], &biased[1]], Some([&before, &after])).unwrap() < 1e-12, "a constant error does not flicker");
        assert!((temporal([&before, &before], Some([&before, &after])).unwrap() - 0.375).abs() < 1e-12, "a frozen picture does");
    }

    #[test]
    fn frames_of_two_sizes_are_an_error() {
        let small = Image::new(1, 1, vec![[0.0; 3]]);
        let frame = grey([0.0; 4]);
        assert!(temporal([&small, &frame], None).is_err());
        assert!(temporal([&frame, &frame], Some([&small, &small])).is_err());
    }
}
