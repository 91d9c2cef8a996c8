//! `pathspace bench-compare`: what became worse from one run to another.

use super::output::print_result;
use super::{Outcome, arguments};
use crate::bench::change::{Change, Scale};
use crate::bench::compare::{Comparison, FALSE_ALARMS, Scope, Subject, Verdict, label, subjects};
use crate::bench::figure::{FIGURES, FigureKind, find};
use crate::bench::log;
use anyhow::bail;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Compare two runs of `pathspace bench`, point by point, with 95 % confidence intervals
///
/// A and B are folders that bench wrote (with shards or without) or files results.jsonl; of several records of a point the newest
/// counts. Exits with 1 when a figure is worse than its limit and the change is significant: two runs of one program on an undisturbed
/// machine give such an alarm at most once in 20 times, over all points together.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The run to compare with
    #[arg(value_name = "A")]
    before: PathBuf,
    /// The run to judge
    #[arg(value_name = "B")]
    after: PathBuf,
    /// How much worse a figure may become: percent of A; for energy and ssim percent of 1; for psnr dB; for counts their number.
    /// [default: frame_ms=5 memory_bytes=5 relmse=10 flip=5 energy=0.5 reference_radiance=0.5 nan=0 infinite=0]
    #[arg(long, value_name = "KEY=PERCENT", value_parser = parse_limit)]
    fail_above: Vec<(&'static FigureKind, f64)>,
    /// Compare this figure only; repeat for several [default: all that have a limit]
    #[arg(long, value_name = "KEY", value_parser = parse_figure)]
    metric: Vec<&'static FigureKind>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Of the intervals that are shown.
const CONFIDENCE: f64 = 0.95;

fn parse_figure(key: &str) -> Result<&'static FigureKind, String> {
    let keys = || FIGURES.iter().map(|kind| kind.key).collect::<Vec<_>>().join(", ");
    find(key).ok_or_else(|| format!("expected one of {}", keys()))
}

fn parse_limit(text: &str) -> Result<(&'static FigureKind, f64), String> {
    let (key, limit) = arguments::assignment(text)?;
    let limit = limit.parse().ok().filter(|limit: &f64| limit.is_finite() && *limit >= 0.0);
    Ok((parse_figure(&key)?, limit.ok_or("expected a finite number of at least 0 after '='")?))
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let [a, b] = [&args.before, &args.after].map(|path| log::read(path).map(log::newest));
    let (a, b) = (a?, b?);
    let comparison = Comparison::new(&a, &b, &subjects(&args.metric, &args.fail_above));
    if comparison.points.is_empty() {
        bail!("'{}' and '{}' share no figure of any point: compare runs of one suite", args.before.display(), args.after.display());
    }
    comparison.warnings.iter().for_each(|warning| tracing::warn!("{warning}"));
    print_result(&if args.json { format!("{:#}", args.document(&comparison)) } else { table(&comparison) })?;
    Ok(if comparison.regressed() { Outcome::CheckFailed } else { Outcome::Done })
}

/// One line of the result, a point's or a summary's.
struct Row<'a> {
    name: String,
    subject: &'a Subject,
    change: &'a Change,
    verdict: Verdict,
}

/// Summaries first: they tell most.
fn rows(comparison: &Comparison) -> impl Iterator<Item = Row<'_>> {
    let summaries = comparison.summaries.iter().map(|summary| {
        let name = match &summary.scope {
            Scope::All => format!("all {} points", summary.points),
            Scope::Technique(technique) => format!("{} points, {technique}", summary.points),
        };
        Row { name, subject: &summary.subject, change: &summary.change, verdict: summary.verdict }
    });
    let points = comparison.points.iter().map(|point| Row {
        name: label(&point.point),
        subject: &point.subject,
        change: &point.change,
        verdict: point.verdict,
    });
    summaries.chain(points)
}

fn table(comparison: &Comparison) -> String {
    let width = rows(comparison).map(|row| row.name.chars().count()).max().unwrap_or_default();
    let header = format!("{:<width$}  {:<16} {:>11} {:>11} {:>9}  {:<21}", "", "figure", "A", "B", "change", "95 % interval");
    let mut lines = vec![header];
    lines.extend(rows(comparison).map(|row| row.line(width)));
    for (points, run) in [(&comparison.only_in_a, "A"), (&comparison.only_in_b, "B")] {
        lines.extend(points.iter().map(|point| format!("only in {run}: {}", label(point))));
    }
    let regressions = rows(comparison).filter(|row| row.verdict == Verdict::Regressed).count();
    lines.push(match regressions {
        0 => format!("no regression; a run of the same program would show one in at most {:.0} % of all comparisons", 100.0 * FALSE_ALARMS),
        count => format!("{count} REGRESSED: worse than --fail-above allows, and not by chance"),
    });
    lines.join("\n")
}

impl Row<'_> {
    fn line(&self, width: usize) -> String {
        let Change { a, b, .. } = self.change;
        let interval = self
            .change
            .interval(CONFIDENCE)
            .map_or("one sample".to_owned(), |[low, high]| format!("[{}, {}]", self.shown(low), self.shown(high)));
        let verdict = match self.verdict {
            Verdict::Regressed => "REGRESSED",
            Verdict::Worse => "worse",
            Verdict::Better => "better",
            Verdict::Same | Verdict::Unknown => "",
        };
        let key = self.subject.kind.key;
        let change = self.shown(self.change.estimate());
        let line = format!("{:<width$}  {key:<16} {:>11} {:>11} {change:>9}  {interval:<21} {verdict}", self.name, number(*a), number(*b));
        line.trim_end().to_owned()
    }

    /// A ratio as percent more or less, a difference in its unit.
    fn shown(&self, value: f64) -> String {
        match self.change.scale {
            Scale::Ratio => format!("{:+.1} %", 100.0 * (value - 1.0)),
            Scale::Difference => format!("{value:+.4}"),
        }
    }
}

fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        1e-2..1e6 => format!("{value:.4}"),
        _ => format!("{value:.3e}"),
    }
}

impl Args {
    fn document(&self, comparison: &Comparison) -> Value {
        let points = comparison.points.iter().map(|point| {
            let about = json!({ "key": point.key, "point": point.point });
            merged(about, change_json(&point.subject, &point.change, point.verdict))
        });
        let summaries = comparison.summaries.iter().map(|summary| {
            let about = json!({ "scope": summary.scope, "points": summary.points });
            merged(about, change_json(&summary.subject, &summary.change, summary.verdict))
        });
        let [of_points, of_summaries] = comparison.significance;
        json!({
            "version": 1,
            "a": self.before.to_string_lossy(), "b": self.after.to_string_lossy(),
            "regressed": comparison.regressed(),
            "confidence": CONFIDENCE, "false_alarms": FALSE_ALARMS,
            "significance": { "points": of_points, "summaries": of_summaries },
            "summaries": summaries.collect::<Vec<_>>(),
            "points": points.collect::<Vec<_>>(),
            "only_in_a": comparison.only_in_a, "only_in_b": comparison.only_in_b,
            "warnings": comparison.warnings,
        })
    }
}

fn change_json(subject: &Subject, change: &Change, verdict: Verdict) -> Value {
    json!({
        "figure": subject.kind.key, "unit": subject.kind.unit, "better": subject.kind.better, "limit": subject.limit,
        "a": change.a, "b": change.b, "scale": change.scale, "change": change.estimate(), "interval": change.interval(CONFIDENCE),
        "p": change.p_value(), "verdict": verdict,
    })
}

fn merged(mut object: Value, other: Value) -> Value {
    if let (Value::Object(object), Value::Object(other)) = (&mut object, other) {
        object.extend(other);
    }
    object
}
