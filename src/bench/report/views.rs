//! Points that can be compared, and every table over them: one run, one scene, one movement, one size.

use super::contest::{self, Candidate, Contest};
use super::loss::Loss;
use super::points::PointData;
use super::price::{self, Pair, Price};
use crate::bench::figure::{self, Better, FIGURES, FigureKind, Group};
use crate::bench::record::{Moves, Point, Record};
use serde::Serialize;
use std::collections::BTreeMap;

/// From 200 Hz to a still.
const BUDGETS_MS: [f64; 6] = [5.0, 10.0, 16.6, 33.0, 100.0, 1000.0];
/// Of the time that path tracing takes for one sample per pixel, so that scenes, sizes and devices can be compared.
const BUDGET_MULTIPLES: [u32; 5] = [1, 2, 4, 8, 16];
/// LDR-FLIP, from rough to hardly told apart.
const FLIP_LEVELS: [f64; 4] = [0.2, 0.1, 0.05, 0.02];
/// Techniques that are path tracing and nothing else, the first that was measured counts.
const PATH_TRACING: [&str; 2] = ["reference", "unfiltered"];

#[derive(Serialize)]
pub struct View<'a> {
    /// Index into the runs.
    run: usize,
    scene: &'a str,
    source: &'a str,
    moves: Moves,
    size: [u32; 2],
    /// Indices into the points; tables refer to these too.
    points: Vec<usize>,
    /// One sample per pixel, without filter.
    path_tracing: Option<usize>,
    /// By metric.
    tables: BTreeMap<&'static str, Tables>,
    /// Of FLIP.
    equal_error: Vec<Contest>,
}

#[derive(Serialize)]
struct Tables {
    front: Vec<usize>,
    equal_time: Vec<EqualTime>,
    /// Of the accuracy switches.
    switches: Vec<Price>,
    /// Between neighbours on the front.
    steps: Vec<Price>,
}

#[derive(Serialize)]
struct EqualTime {
    /// Of the 1 spp path-tracing time; none for absolute budgets.
    multiple: Option<u32>,
    #[serde(flatten)]
    contest: Contest,
}

/// `records` and `points` are parallel.
pub fn group<'a>(records: &[&'a Record], points: &[PointData]) -> Vec<View<'a>> {
    let mut views: Vec<View> = Vec::new();
    for (index, (record, data)) in records.iter().zip(points).enumerate() {
        let point = &record.point;
        let same = |view: &View| {
            (view.run, view.scene, view.source, view.moves, view.size) == (data.run, &point.scene, &point.source, point.moves, point.size)
        };
        match views.iter_mut().find(|view| same(view)) {
            Some(view) => view.points.push(index),
            None => views.push(View {
                run: data.run,
                scene: &point.scene,
                source: &point.source,
                moves: point.moves,
                size: point.size,
                points: vec![index],
                path_tracing: None,
                tables: BTreeMap::new(),
                equal_error: Vec::new(),
            }),
        }
    }
    views.iter_mut().for_each(|view| view.compare(records));
    views
}

impl View<'_> {
    fn compare(&mut self, records: &[&Record]) {
        self.path_tracing = self.path_tracing(records);
        let path_tracing_ms = self.path_tracing.and_then(|point| records[point].figures.get("frame_ms")).map(|figure| figure.value);
        self.tables = metrics()
            .map(|metric| (metric, self.candidates(records, metric)))
            .filter(|(_, candidates)| !candidates.is_empty())
            .map(|(metric, candidates)| (metric.key, tables(records, &candidates, metric.better, path_tracing_ms)))
            .collect();
        let flip: Vec<_> = figure::find("flip").into_iter().flat_map(|metric| self.candidates(records, metric)).collect();
        let flip = techniques(records, &flip);
        self.equal_error = FLIP_LEVELS.iter().map(|&level| contest::equal_error(&flip, level)).collect();
    }

    fn candidates<'r>(&self, records: &[&'r Record], metric: &FigureKind) -> Vec<Candidate<'r>> {
        let candidate = |&point: &usize| {
            let Record { figures, point: Point { technique, .. }, .. } = records[point];
            let ms = Loss::of(figures.get("frame_ms")?, Better::Less)?;
            Some(Candidate { point, technique, ms, loss: Loss::of(figures.get(metric.key)?, metric.better)? })
        };
        self.points.iter().filter_map(candidate).collect()
    }

    fn path_tracing(&self, records: &[&Record]) -> Option<usize> {
        let plain = |technique: &str| {
            let is = |point: &&Point| point.technique == technique && point.spp == 1 && point.switch.is_none() && !point.all_effects;
            self.points.iter().copied().find(|&index| is(&&records[index].point))
        };
        PATH_TRACING.iter().find_map(|technique| plain(technique))
    }
}

/// What pictures are compared by.
fn metrics() -> impl Iterator<Item = &'static FigureKind> {
    FIGURES.iter().filter(|figure| matches!(figure.group, Group::Error | Group::Split | Group::Temporal))
}

/// Without points that price a switch.
fn techniques<'a>(records: &[&Record], candidates: &[Candidate<'a>]) -> Vec<Candidate<'a>> {
    candidates.iter().filter(|candidate| records[candidate.point].point.switch.is_none()).copied().collect()
}

fn tables(records: &[&Record], candidates: &[Candidate], better: Better, path_tracing_ms: Option<f64>) -> Tables {
    let techniques = techniques(records, candidates);
    let front = contest::front(&techniques);
    let absolute = BUDGETS_MS.iter().map(|&budget| (None, budget));
    let relative = path_tracing_ms.into_iter().flat_map(|ms| BUDGET_MULTIPLES.iter().map(move |&n| (Some(n), f64::from(n) * ms)));
    let steps = front.windows(2).map(|pair| Pair { base: &pair[0], changed: &pair[1] });
    Tables {
        equal_time: absolute
            .chain(relative)
            .map(|(multiple, budget)| EqualTime { multiple, contest: contest::equal_time(&techniques, budget) })
            .collect(),
        switches: price::list(switch_pairs(records, candidates), better),
        steps: price::list(steps, better),
        front: front.iter().map(|candidate| candidate.point).collect(),
    }
}

/// Each point that prices a switch, beside its base.
fn switch_pairs<'a>(records: &[&Record], candidates: &'a [Candidate<'a>]) -> Vec<Pair<'a>> {
    let base_of = |changed: &Candidate| {
        let switch = records[changed.point].point.switch.as_ref()?;
        candidates.iter().find(|candidate| records[candidate.point].key == switch.base)
    };
    candidates.iter().filter_map(|changed| Some(Pair { base: base_of(changed)?, changed })).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::report::fixtures::{measured, switched};
    use crate::bench::report::pictures::PictureSet;
    use crate::bench::report::price::Kind;
    use crate::bench::report::{Measured, points};

    fn views<R>(measured: &[Measured], check: impl FnOnce(&[View]) -> R) -> R {
        let merged: Vec<&Measured> = measured.iter().collect();
        let records: Vec<&Record> = measured.iter().map(|measured| &measured.record).collect();
        let (_, points) = points::collect(&merged, &mut PictureSet::default()).unwrap();
        check(&group(&records, &points))
    }

    #[test]
    fn scenes_movements_sizes_and_runs_are_not_compared_with_each_other() {
        let mut all: Vec<_> = (0..5).map(|i| measured(&i.to_string(), "reference", 1, 1.0, 0.1)).collect();
        all[1].record.point.scene = "hall".to_owned();
        all[2].record.point.moves = Moves::Camera;
        all[3].record.point.size = [128, 64];
        all[4].record.provenance.device = "other".to_owned();
        views(&all, |views| assert_eq!(views.iter().map(|view| view.points.clone()).collect::<Vec<_>>(), [[0], [1], [2], [3], [4]]));
    }

    #[test]
    fn budgets_are_absolute_and_multiples_of_path_tracing() {
        let all =
            [measured("a", "filtered", 1, 6.0, 0.1), measured("b", "reference", 1, 4.0, 0.4), measured("c", "reference", 16, 60.0, 0.05)];
        views(&all, |views| {
            assert_eq!(views[0].path_tracing, Some(1));
            let rows: Vec<_> =
                views[0].tables["flip"].equal_time.iter().map(|row| (row.multiple, row.contest.limit, row.contest.best.clone())).collect();
            assert_eq!(rows[..2], [(None, 5.0, vec![1]), (None, 10.0, vec![0])]);
            assert_eq!(
                rows[BUDGETS_MS.len()..],
                [
                    (Some(1), 4.0, vec![1]),
                    (Some(2), 8.0, vec![0]),
                    (Some(4), 16.0, vec![0]),
                    (Some(8), 32.0, vec![0]),
                    (Some(16), 64.0, vec![2]),
                ]
            );
            let levels: Vec<_> = views[0].equal_error.iter().map(|row| row.best.clone()).collect();
            assert_eq!(levels, [vec![0], vec![0], vec![2], vec![]]);
        });
    }

    #[test]
    fn switches_are_priced_against_their_base_and_take_no_part_in_contests() {
        let base = measured("a", "reference", 1, 4.0, 0.4);
        let all = [switched("b", &base, "mis", "0", 2.0, 0.5), base.clone(), switched("c", &base, "caustics", "1", 5.0, 0.3)];
        views(&all, |views| {
            let tables = &views[0].tables["flip"];
            assert_eq!(tables.front, [1]);
            let prices: Vec<_> = tables.switches.iter().map(|price| (price.kind, price.base, price.changed)).collect();
            assert_eq!(prices, [(Kind::Step, 1, 2), (Kind::Shortcut, 1, 0)]);
            assert!(views[0].equal_error[0].best.is_empty() && tables.steps.is_empty());
        });
    }

    #[test]
    fn neighbours_on_the_front_are_priced() {
        let all =
            [measured("a", "reference", 1, 4.0, 0.4), measured("b", "reference", 4, 8.0, 0.2), measured("c", "reference", 2, 9.0, 0.3)];
        views(&all, |views| {
            let steps = &views[0].tables["flip"].steps;
            assert_eq!(steps.iter().map(|price| (price.kind, price.base, price.changed)).collect::<Vec<_>>(), [(Kind::Step, 0, 1)]);
        });
    }

    #[test]
    fn points_without_the_metric_are_left_out() {
        let mut missing = measured("a", "reference", 1, 4.0, 0.4);
        missing.record.figures.remove("flip");
        let mut untimed = measured("b", "reference", 1, 4.0, 0.4);
        untimed.record.figures.remove("frame_ms");
        views(&[missing, untimed], |views| assert!(views[0].tables.is_empty() && views[0].points.len() == 2));
    }
}
