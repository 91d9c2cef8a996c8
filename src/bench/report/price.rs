//! The price list: what each step in accuracy costs in milliseconds, and what each shortcut costs in accuracy.

use super::contest::Candidate;
use super::loss::Loss;
use crate::bench::figure::Better;
use serde::Serialize;

/// What a change did, as far as intervals tell it from chance. In the order of the list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Better in one of time and error, and not worse in the other.
    Gain,
    /// Less error for more time.
    Step,
    /// More error for less time.
    Shortcut,
    /// Worse in one of time and error, and not better in the other.
    Loss,
    NoDifference,
}

/// Two points that are held against each other.
#[derive(Debug, Clone, Copy)]
pub struct Pair<'a> {
    pub base: &'a Candidate<'a>,
    pub changed: &'a Candidate<'a>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Price {
    pub kind: Kind,
    /// Indices into the report's points.
    pub base: usize,
    pub changed: usize,
    /// None: no measurable difference.
    pub ms: Option<Difference>,
    /// In the metric's own terms: negative is better for FLIP, worse for PSNR.
    pub error: Option<Difference>,
    /// Metric's units per millisecond, positive; of steps and shortcuts.
    pub per_ms: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Difference {
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

/// The prices of all pairs: by kind, the best bargains of each first.
pub fn list<'a>(pairs: impl IntoIterator<Item = Pair<'a>>, better: Better) -> Vec<Price> {
    let mut prices: Vec<_> = pairs.into_iter().map(|pair| price(pair, better)).collect();
    prices.sort_by(|a, b| a.kind.cmp(&b.kind).then(bargain(a).total_cmp(&bargain(b))));
    prices
}

/// Much is gained per millisecond by a good step, little is lost by a good shortcut.
fn bargain(price: &Price) -> f64 {
    let per_ms = price.per_ms.unwrap_or(0.0);
    if price.kind == Kind::Step { -per_ms } else { per_ms }
}

fn price(Pair { base, changed }: Pair, better: Better) -> Price {
    let (ms, loss) = (changed.ms.since(&base.ms), changed.loss.since(&base.loss));
    let kind = kind(ms.direction(), loss.direction());
    Price {
        kind,
        base: base.point,
        changed: changed.point,
        ms: measurable(ms),
        error: measurable(loss.in_terms_of(better)),
        per_ms: matches!(kind, Kind::Step | Kind::Shortcut).then(|| (loss.value / ms.value).abs()),
    }
}

fn kind(ms: i8, loss: i8) -> Kind {
    match (ms, loss) {
        (0, 0) => Kind::NoDifference,
        (1, -1) => Kind::Step,
        (-1, 1) => Kind::Shortcut,
        (-1 | 0, -1 | 0) => Kind::Gain,
        _ => Kind::Loss,
    }
}

fn measurable(difference: Loss) -> Option<Difference> {
    let Loss { value, low, high } = difference;
    (difference.direction() != 0).then_some(Difference { value, low, high })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(point: usize, ms: f64, loss: f64) -> Candidate<'static> {
        let around = |value: f64, half: f64| Loss { value, low: value - half, high: value + half };
        Candidate { point, technique: "a", ms: around(ms, 0.25), loss: around(loss, 0.03125) }
    }

    fn prices(changed: &[(f64, f64)]) -> Vec<Price> {
        let base = candidate(0, 10.0, 0.5);
        let changed: Vec<_> = changed.iter().enumerate().map(|(i, &(ms, loss))| candidate(i + 1, ms, loss)).collect();
        list(changed.iter().map(|changed| Pair { base: &base, changed }), Better::Less)
    }

    #[test]
    fn a_step_costs_time_and_a_shortcut_error() {
        let list = prices(&[(12.0, 0.25), (8.0, 0.75)]);
        let ms = |value: f64| Some(Difference { value, low: value - 0.5, high: value + 0.5 });
        let error = |value: f64| Some(Difference { value, low: value - 0.0625, high: value + 0.0625 });
        assert_eq!(
            list,
            [
                Price { kind: Kind::Step, base: 0, changed: 1, ms: ms(2.0), error: error(-0.25), per_ms: Some(0.125) },
                Price { kind: Kind::Shortcut, base: 0, changed: 2, ms: ms(-2.0), error: error(0.25), per_ms: Some(0.125) },
            ]
        );
    }

    #[test]
    fn differences_within_the_intervals_are_none() {
        let list = prices(&[(10.25, 0.5625)]);
        assert_eq!(list, [Price { kind: Kind::NoDifference, base: 0, changed: 1, ms: None, error: None, per_ms: None }]);
        let kinds: Vec<_> =
            prices(&[(10.0, 0.25), (8.0, 0.5), (12.0, 0.5), (10.0, 0.75)]).iter().map(|price| (price.changed, price.kind)).collect();
        assert_eq!(kinds, [(1, Kind::Gain), (2, Kind::Gain), (3, Kind::Loss), (4, Kind::Loss)]);
    }

    #[test]
    fn the_best_bargains_come_first() {
        let order: Vec<_> = prices(&[(14.0, 0.25), (11.0, 0.25), (8.0, 0.75), (4.0, 0.75)]).iter().map(|price| price.changed).collect();
        assert_eq!(order, [2, 1, 4, 3]);
    }

    #[test]
    fn better_psnr_is_a_step_and_is_shown_as_a_plus() {
        let base = Candidate { loss: Loss { value: -30.0, low: -31.0, high: -29.0 }, ..candidate(0, 1.0, 0.0) };
        let changed = Candidate { loss: Loss { value: -40.0, low: -41.0, high: -39.0 }, ..candidate(1, 2.0, 0.0) };
        let list = list([Pair { base: &base, changed: &changed }], Better::More);
        assert_eq!((list[0].kind, list[0].error), (Kind::Step, Some(Difference { value: 10.0, low: 8.0, high: 12.0 })));
    }
}
