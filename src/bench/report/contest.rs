//! Who is best: the Pareto front, equal-time and equal-error comparisons. Only measured points compete, nothing is interpolated, and
//! whose intervals overlap have tied.

use super::loss::Loss;
use serde::Serialize;

/// A point with both a time and the metric that is compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate<'a> {
    /// Index into the report's points.
    pub point: usize,
    pub technique: &'a str,
    /// Milliseconds of a frame.
    pub ms: Loss,
    pub loss: Loss,
}

/// Candidates that no other beats in both time and loss, by ascending time.
pub fn front<'a>(candidates: &[Candidate<'a>]) -> Vec<Candidate<'a>> {
    let mut sorted = candidates.to_vec();
    sorted.sort_by(|a, b| a.ms.value.total_cmp(&b.ms.value).then(a.loss.value.total_cmp(&b.loss.value)));
    let mut least = f64::INFINITY;
    sorted.retain(|candidate| {
        let improves = candidate.loss.value < least;
        least = least.min(candidate.loss.value);
        improves
    });
    sorted
}

/// One row of a table: under one limit, each technique sends its best point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Contest {
    /// Milliseconds for equal time, the metric's unit for equal error.
    pub limit: f64,
    /// The best point and those that tied with it, best first; empty where nothing keeps to the limit.
    pub best: Vec<usize>,
    /// The first that is measurably worse.
    pub next: Option<usize>,
}

/// Least loss within `budget_ms`.
pub fn equal_time(candidates: &[Candidate], budget_ms: f64) -> Contest {
    contest(budget_ms, candidates.iter().filter(|candidate| candidate.ms.value <= budget_ms), |candidate| (candidate.loss, candidate.ms))
}

/// Least time to reach `level`, a loss.
pub fn equal_error(candidates: &[Candidate], level: f64) -> Contest {
    contest(level, candidates.iter().filter(|candidate| candidate.loss.value <= level), |candidate| (candidate.ms, candidate.loss))
}

/// `by`: what decides, and what decides between equals.
fn contest<'a>(limit: f64, admitted: impl Iterator<Item = &'a Candidate<'a>>, by: impl Fn(&Candidate) -> (Loss, Loss)) -> Contest {
    let mut sorted: Vec<_> = admitted.collect();
    let rank = |candidate: &Candidate| (by(candidate).0.value, by(candidate).1.value);
    sorted.sort_by(|a, b| rank(a).0.total_cmp(&rank(b).0).then(rank(a).1.total_cmp(&rank(b).1)));
    let mut seen = std::collections::BTreeSet::new();
    sorted.retain(|candidate| seen.insert(candidate.technique));
    let ties = |candidate: &&&Candidate| by(sorted[0]).0.overlaps(&by(candidate).0);
    Contest {
        limit,
        best: sorted.iter().filter(ties).map(|candidate| candidate.point).collect(),
        next: sorted.iter().find(|candidate| !ties(candidate)).map(|candidate| candidate.point),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around(value: f64, half_width: f64) -> Loss {
        Loss { value, low: value - half_width, high: value + half_width }
    }

    fn candidate(point: usize, technique: &str, ms: f64, loss: f64) -> Candidate<'_> {
        Candidate { point, technique, ms: around(ms, 0.1), loss: around(loss, 0.01) }
    }

    fn points(candidates: &[Candidate]) -> Vec<usize> {
        candidates.iter().map(|candidate| candidate.point).collect()
    }

    #[test]
    fn nothing_beats_a_point_of_the_front_in_both() {
        let all = [
            candidate(0, "a", 8.0, 0.1),
            candidate(1, "a", 2.0, 0.4),
            candidate(2, "b", 4.0, 0.4),
            candidate(3, "b", 2.0, 0.5),
            candidate(4, "c", 9.0, 0.2),
            candidate(5, "c", 5.0, 0.3),
        ];
        assert_eq!(points(&front(&all)), [1, 5, 0]);
        assert!(front(&[]).is_empty());
    }

    #[test]
    fn the_least_error_within_the_budget_wins() {
        let all = [candidate(0, "a", 4.0, 0.3), candidate(1, "b", 5.0, 0.2), candidate(2, "a", 50.0, 0.05)];
        assert_eq!(equal_time(&all, 5.0), Contest { limit: 5.0, best: vec![1], next: Some(0) });
        assert_eq!(equal_time(&all, 100.0), Contest { limit: 100.0, best: vec![2], next: Some(1) });
        assert_eq!(equal_time(&all, 1.0), Contest { limit: 1.0, best: vec![], next: None });
    }

    #[test]
    fn the_least_time_to_the_level_wins() {
        let all = [candidate(0, "a", 4.0, 0.2), candidate(1, "b", 9.0, 0.1), candidate(2, "a", 16.0, 0.1)];
        assert_eq!(equal_error(&all, 0.1), Contest { limit: 0.1, best: vec![1], next: Some(2) });
        assert_eq!(equal_error(&all, 0.2), Contest { limit: 0.2, best: vec![0], next: Some(1) });
    }

    #[test]
    fn techniques_whose_intervals_overlap_tie() {
        let all = [candidate(0, "a", 4.0, 0.200), candidate(1, "b", 4.0, 0.215), candidate(2, "c", 4.0, 0.23)];
        assert_eq!(equal_time(&all, 5.0), Contest { limit: 5.0, best: vec![0, 1], next: Some(2) });
        // A technique does not tie with itself.
        let all = [candidate(0, "a", 4.0, 0.200), candidate(1, "a", 4.0, 0.205)];
        assert_eq!(equal_time(&all, 5.0), Contest { limit: 5.0, best: vec![0], next: None });
    }
}
