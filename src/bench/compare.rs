//! Two runs against each other: what became worse, beyond its limit and beyond chance.
//!
//! A regression is a change for the worse that is larger than the figure's limit *and* significant. Many figures of many points are tested,
//! so each runs at a significance that keeps the whole comparison, of two runs of one program, below [`FALSE_ALARMS`] (Sidak 1967): one half
//! for the points, one half for the summaries over points. Summaries find what is too small for any single point but common to many.

use super::change::{Change, Scale, Spread};
use super::figure::{Better, FIGURES, FigureKind};
use super::record::{Figure, Point, Record};
use crate::metrics::statistics::{BatchMeans, sidak};
use serde::Serialize;
use std::collections::BTreeSet;

/// Probability that comparing two runs of one program reports any regression.
pub const FALSE_ALARMS: f64 = 0.05;
/// Fewer points make no summary: the spread over them would be a guess.
const FEWEST_POINTS: usize = 3;

/// What fails where nothing else is asked for, in percent.
pub const DEFAULT_LIMITS: &[(&str, f64)] = &[
    ("frame_ms", 5.0),
    ("memory_bytes", 5.0),
    ("relmse", 10.0),
    ("flip", 5.0),
    ("energy", 0.5),
    ("reference_radiance", 0.5),
    ("nan", 0.0),
    ("infinite", 0.0),
];

/// A figure to compare.
#[derive(Debug, Clone, Copy)]
pub struct Subject {
    pub kind: &'static FigureKind,
    /// Worse by more than this fails: percent of A for ratios, of 1 for differences of pure numbers, else the figure's own unit.
    pub limit: Option<f64>,
}

/// The figures named, or all that have a limit; `limits` in place of the default ones.
pub fn subjects(named: &[&'static FigureKind], limits: &[(&'static FigureKind, f64)]) -> Vec<Subject> {
    let limit = |kind: &FigureKind| {
        let given = limits.iter().rev().find(|(limited, _)| limited.key == kind.key).map(|(_, limit)| *limit);
        given.or_else(|| DEFAULT_LIMITS.iter().find(|(key, _)| *key == kind.key).map(|(_, limit)| *limit))
    };
    let all = FIGURES.iter().map(|kind| Subject { kind, limit: limit(kind) });
    all.filter(|subject| match named {
        [] => subject.limit.is_some(),
        named => named.iter().any(|kind| kind.key == subject.kind.key),
    })
    .collect()
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Worse than its limit, and not by chance.
    Regressed,
    /// Not by chance, but within its limit, or without one.
    Worse,
    Better,
    /// Chance explains it.
    Same,
    /// One measurement each: chance cannot be told.
    Unknown,
}

/// One figure at one point.
#[derive(Debug, Clone)]
pub struct PointChange {
    pub key: String,
    pub point: Point,
    pub subject: Subject,
    pub change: Change,
    pub verdict: Verdict,
}

/// Which points a summary is over.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scope {
    All,
    Technique(String),
}

/// One figure over many points: geometric mean of ratios, mean of differences; of the distance from 1 where 1 is right. Its error is the
/// spread over the points, so it also covers what differs from point to point between runs.
#[derive(Debug, Clone)]
pub struct Summary {
    pub scope: Scope,
    pub points: usize,
    pub subject: Subject,
    pub change: Change,
    pub verdict: Verdict,
}

#[derive(Debug, Clone)]
pub struct Comparison {
    pub summaries: Vec<Summary>,
    /// In the order of A's points, then of figures.
    pub points: Vec<PointChange>,
    pub only_in_a: Vec<Point>,
    pub only_in_b: Vec<Point>,
    /// What makes the two runs differ beside the program, and what could not be compared.
    pub warnings: Vec<String>,
    /// Of each test of a point, of each test of a summary.
    pub significance: [f64; 2],
}

impl Comparison {
    /// `a` and `b`: one record per key, see [`super::log::newest`].
    pub fn new(a: &[Record], b: &[Record], subjects: &[Subject]) -> Self {
        let partner = |record: &Record, others: &[Record]| others.iter().find(|other| other.key == record.key).cloned();
        let pairs: Vec<(&Record, Record)> = a.iter().filter_map(|record| Some((record, partner(record, b)?))).collect();
        let alone = |records: &[Record], others: &[Record]| {
            records.iter().filter(|record| partner(record, others).is_none()).map(|record| record.point.clone()).collect()
        };
        let mut comparison = Comparison {
            summaries: Vec::new(),
            points: Vec::new(),
            only_in_a: alone(a, b),
            only_in_b: alone(b, a),
            warnings: circumstances(&pairs),
            significance: [FALSE_ALARMS; 2],
        };
        for (a, b) in &pairs {
            for subject in subjects {
                comparison.add_point(a, b, *subject);
            }
        }
        comparison.summaries = scopes(&pairs).iter().flat_map(|scope| comparison.summaries_of(scope, subjects)).collect();
        comparison.judge();
        comparison
    }

    pub fn regressed(&self) -> bool {
        let points = self.points.iter().map(|point| point.verdict);
        points.chain(self.summaries.iter().map(|summary| summary.verdict)).any(|verdict| verdict == Verdict::Regressed)
    }

    fn add_point(&mut self, a: &Record, b: &Record, subject: Subject) {
        let key = subject.kind.key;
        let figures: [Option<&Figure>; 2] = [a, b].map(|record| record.figures.get(key));
        let same_seeds = a.provenance.seeds == b.provenance.seeds;
        match figures {
            [Some(figure_a), Some(figure_b)] => match Change::of(subject.kind, figure_a, figure_b, same_seeds) {
                Some(change) => {
                    let (key, point) = (a.key.clone(), a.point.clone());
                    self.points.push(PointChange { key, point, subject, change, verdict: Verdict::Unknown });
                }
                None => self.warnings.push(format!("{key} of {} is not above 0 on both sides and has no ratio", label(&a.point))),
            },
            [None, None] => {}
            [found, _] => {
                let only = if found.is_some() { "A" } else { "B" };
                self.warnings.push(format!("{key} of {} was measured in {only} alone", label(&a.point)));
            }
        }
    }

    fn summaries_of(&self, scope: &Scope, subjects: &[Subject]) -> Vec<Summary> {
        let summary = |subject: &Subject| {
            let here = self.points.iter().filter(|point| point.subject.kind.key == subject.kind.key && scope.holds(&point.point));
            let changes: Vec<Change> = here.map(|point| point.change).collect();
            let change = mean_change(subject.kind, &changes)?;
            Some(Summary { scope: scope.clone(), points: changes.len(), subject: *subject, change, verdict: Verdict::Unknown })
        };
        subjects.iter().filter_map(summary).collect()
    }

    fn judge(&mut self) {
        let is_test = |subject: &Subject, change: &Change| subject.limit.is_some() && matches!(change.spread, Spread::Estimated { .. });
        let tests = [
            self.points.iter().filter(|point| is_test(&point.subject, &point.change)).count(),
            self.summaries.iter().filter(|summary| is_test(&summary.subject, &summary.change)).count(),
        ];
        self.significance = tests.map(|tests| sidak(sidak(FALSE_ALARMS, 2), tests.max(1)));
        for point in &mut self.points {
            let worse = worsening(point.subject.kind.better, &point.change);
            point.verdict = verdict(&point.subject, &point.change, worse, self.significance[0]);
        }
        for summary in &mut self.summaries {
            let worse = worsening(better_of_mean(summary.subject.kind), &summary.change);
            summary.verdict = verdict(&summary.subject, &summary.change, worse, self.significance[1]);
        }
    }
}

impl Scope {
    fn holds(&self, point: &Point) -> bool {
        match self {
            Scope::All => true,
            Scope::Technique(technique) => *technique == point.technique,
        }
    }
}

/// All points, and each technique's where there are several.
fn scopes(pairs: &[(&Record, Record)]) -> Vec<Scope> {
    let techniques: BTreeSet<&str> = pairs.iter().map(|(a, _)| a.point.technique.as_str()).collect();
    let several = techniques.len() > 1;
    let techniques = techniques.into_iter().filter(|_| several).map(|technique| Scope::Technique(technique.to_owned()));
    std::iter::once(Scope::All).chain(techniques).collect()
}

/// Over points, by Student's t of their effects. None for few points and for what each point tells for itself: exact figures, and those
/// of references, which points share.
fn mean_change(kind: &FigureKind, changes: &[Change]) -> Option<Change> {
    let scale = Scale::of(kind);
    let changes: Vec<&Change> = changes.iter().filter(|change| change.scale == scale && change.spread != Spread::Exact).collect();
    if changes.len() < FEWEST_POINTS || kind.better == Better::Same {
        return None;
    }
    let mean = |values: &dyn Fn(&Change) -> f64| changes.iter().map(|change| values(change)).collect::<BatchMeans>();
    let of = |value: f64| if kind.better == Better::One { (value - 1.0).abs() } else { value };
    let (a, b, spread) = match scale {
        Scale::Ratio => (mean(&|change| change.a.ln()).mean.exp(), mean(&|change| change.b.ln()).mean.exp(), mean(&Change::effect)),
        Scale::Difference => {
            (mean(&|change| of(change.a)).mean, mean(&|change| of(change.b)).mean, mean(&|change| of(change.b) - of(change.a)))
        }
    };
    let degrees_of_freedom = changes.len() as f64 - 1.0;
    Some(Change { scale, a, b, spread: Spread::Estimated { standard_error: spread.variance_of_mean().sqrt(), degrees_of_freedom } })
}

/// [`mean_change`] averages distances from 1.
fn better_of_mean(kind: &FigureKind) -> Better {
    match kind.better {
        Better::One => Better::Less,
        better => better,
    }
}

/// How much worse B is than A: as a share of A for ratios, else in the figure's unit. Negative for better.
fn worsening(better: Better, change: &Change) -> f64 {
    let change_from_none = match change.scale {
        Scale::Ratio => change.estimate() - 1.0,
        Scale::Difference => change.estimate(),
    };
    match better {
        Better::Less => change_from_none,
        Better::More => -change_from_none,
        Better::One => (change.b - 1.0).abs() - (change.a - 1.0).abs(),
        Better::Same => change_from_none.abs(),
        Better::Neither => 0.0,
    }
}

fn verdict(subject: &Subject, change: &Change, worse: f64, significance: f64) -> Verdict {
    let percent = change.scale == Scale::Ratio || subject.kind.unit.is_empty();
    let beyond = subject.limit.is_some_and(|limit| worse > if percent { limit / 100.0 } else { limit });
    match change.p_value() {
        None => Verdict::Unknown,
        Some(p) if p >= significance => Verdict::Same,
        Some(_) if beyond => Verdict::Regressed,
        Some(_) if worse > 0.0 => Verdict::Worse,
        Some(_) if worse < 0.0 => Verdict::Better,
        Some(_) => Verdict::Same,
    }
}

/// What differs between the runs beside the program.
fn circumstances(pairs: &[(&Record, Record)]) -> Vec<String> {
    let differing = |what: fn(&Record) -> String| pairs.iter().filter(move |(a, b)| what(a) != what(b)).count();
    let all = [
        ("another device or driver", differing(|record| format!("{} {}", record.provenance.device, record.provenance.driver))),
        ("another machine", differing(|record| format!("{} {}", record.provenance.machine, record.provenance.cpu))),
        ("another reference: errors are not comparable", differing(|record| record.reference.key.clone())),
        ("other seeds: they are compared unpaired", differing(|record| format!("{:?}", record.provenance.seeds))),
    ];
    let found = all.into_iter().filter(|(_, points)| *points > 0);
    found.map(|(what, points)| format!("{points} of {} points were measured with {what}", pairs.len())).collect()
}

/// A point in a few words.
pub fn label(point: &Point) -> String {
    let [width, height] = point.size;
    let mut text = format!("{} {} {width}x{height} {} spp", point.scene, point.technique, point.spp);
    if point.frames != 1 {
        text += &format!(" {} frames", point.frames);
    }
    text += &format!(" {}", point.trace);
    point.settings.iter().for_each(|(key, value)| text += &format!(" {key}={value}"));
    if point.all_effects {
        text += " all effects";
    }
    text
}
