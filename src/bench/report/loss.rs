//! A figure turned so that less is better, whatever its own direction: fronts, contests and prices compare only these.

use crate::bench::figure::Better;
use crate::bench::record::Figure;

/// How bad a measured value is, with the interval that it lies in. Finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loss {
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

impl Loss {
    /// None for facts, neither good nor bad at one point, and for what is not finite.
    pub fn of(figure: &Figure, better: Better) -> Option<Loss> {
        let Figure { value, low, high, .. } = *figure;
        let loss = match better {
            Better::Less => Loss { value, low, high },
            Better::More => Loss { value: -value, low: -high, high: -low },
            Better::One => distance_from_one(value, low, high),
            Better::Same | Better::Neither => return None,
        };
        [loss.value, loss.low, loss.high].iter().all(|x| x.is_finite()).then_some(loss)
    }

    /// The intervals have a value in common: no difference is to be shown.
    pub fn overlaps(&self, other: &Loss) -> bool {
        self.low <= other.high && other.low <= self.high
    }

    /// From `base` to here. The range holds 0 exactly where the two intervals overlap.
    pub fn since(&self, base: &Loss) -> Loss {
        Loss { value: self.value - base.value, low: self.low - base.high, high: self.high - base.low }
    }

    /// Of a difference: which way it went, 0 where the intervals overlapped.
    pub fn direction(&self) -> i8 {
        match (self.low > 0.0, self.high < 0.0) {
            (true, _) => 1,
            (_, true) => -1,
            _ => 0,
        }
    }

    /// A difference in the figure's own terms: a gain in PSNR is positive again.
    pub fn in_terms_of(&self, better: Better) -> Loss {
        match better {
            Better::More => Loss { value: -self.value, low: -self.high, high: -self.low },
            _ => *self,
        }
    }
}

fn distance_from_one(value: f64, low: f64, high: f64) -> Loss {
    let (a, b) = ((low - 1.0).abs(), (high - 1.0).abs());
    let holds_one = low <= 1.0 && 1.0 <= high;
    Loss { value: (value - 1.0).abs(), low: if holds_one { 0.0 } else { a.min(b) }, high: a.max(b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::report::fixtures::figure;

    fn loss(low: f64, value: f64, high: f64, better: Better) -> Loss {
        Loss::of(&figure(value, low, high), better).unwrap()
    }

    #[test]
    fn less_loss_is_better_whatever_the_figures_direction() {
        assert_eq!(loss(1.0, 2.0, 3.0, Better::Less), Loss { value: 2.0, low: 1.0, high: 3.0 });
        assert_eq!(loss(1.0, 2.0, 3.0, Better::More), Loss { value: -2.0, low: -3.0, high: -1.0 });
        assert_eq!(loss(0.5, 0.75, 1.25, Better::One), Loss { value: 0.25, low: 0.0, high: 0.5 });
        assert_eq!(loss(0.5, 0.625, 0.75, Better::One), Loss { value: 0.375, low: 0.25, high: 0.5 });
        assert_eq!(Loss::of(&figure(1.0, 1.0, 1.0), Better::Neither), None);
        assert_eq!(Loss::of(&figure(1.0, 1.0, f64::INFINITY), Better::Less), None);
    }

    #[test]
    fn a_difference_has_no_direction_exactly_where_intervals_overlap() {
        let base = loss(1.0, 2.0, 3.0, Better::Less);
        for (low, value, high, direction) in [(3.5, 4.0, 5.0, 1), (3.0, 4.0, 5.0, 0), (0.0, 0.5, 1.0, 0), (0.0, 0.25, 0.5, -1)] {
            let other = loss(low, value, high, Better::Less);
            assert_eq!(other.since(&base).direction(), direction);
            assert_eq!(other.overlaps(&base), direction == 0);
        }
    }

    #[test]
    fn a_gain_in_psnr_is_positive_where_it_is_shown() {
        let gain = loss(30.0, 31.0, 32.0, Better::More).since(&loss(20.0, 21.0, 22.0, Better::More));
        assert_eq!(gain.direction(), -1);
        assert_eq!(gain.in_terms_of(Better::More), Loss { value: 10.0, low: 8.0, high: 12.0 });
    }
}
