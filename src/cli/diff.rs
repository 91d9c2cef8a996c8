//! `pathspace diff`: how far a picture is from a reference.

use super::Outcome;
use super::arguments;
use super::output::{check_writable, print_result, write_atomically};
use crate::display::image::write_png_bytes;
use crate::display::{Image, ToneCurve, ToneMapping};
use crate::metrics::{self, ErrorMap, MetricError, Pair};
use serde_json::json;
use std::cell::LazyCell;
use std::path::{Path, PathBuf};

/// Measure how far a picture is from a reference (EXR, HDR or PNG)
///
/// mse, relmse, hdr-flip and mean-ratio compare radiance, which of PNG files is what a screen emits. rmse-tonemapped, psnr, ssim and
/// flip compare what a screen shows: EXR and HDR files are tonemapped, PNG files taken as they are. relmse_trimmed leaves out the
/// worst 0.1 % of the pixels. Where a value is infinite (psnr of equal pictures), JSON has null.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The picture
    #[arg(value_name = "A")]
    image: PathBuf,
    /// What it should be
    #[arg(value_name = "B")]
    reference: PathBuf,
    #[arg(long, value_enum, default_value = "all")]
    metric: Metric,
    /// Write FLIP's error map in the colours of magma: black is no error
    #[arg(long, value_name = "OUT.png", value_parser = arguments::png)]
    heatmap: Option<PathBuf>,
    /// Exit with 1 when a metric is worse than x: above it; psnr and ssim below it; mean-ratio further than x from 1
    #[arg(long, value_name = "metric=x", value_parser = parse_limit)]
    fail_above: Vec<Limit>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Exposure before tonemapping: radiance is multiplied by 2^EV
    #[arg(long, value_name = "EV", value_parser = arguments::finite, allow_hyphen_values = true, default_value = "0")]
    exposure: f32,
    /// Tone curve for rmse-tonemapped, psnr, ssim and flip
    #[arg(long, value_enum, default_value = "aces")]
    tonemap: ToneCurve,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Metric {
    All,
    Mse,
    Relmse,
    RmseTonemapped,
    Psnr,
    Ssim,
    Flip,
    HdrFlip,
    MeanRatio,
}

#[derive(Debug, Clone, Copy)]
struct Limit {
    metric: Metric,
    bound: f64,
}

fn parse_limit(text: &str) -> Result<Limit, String> {
    let (name, bound) = arguments::assignment(text)?;
    let metric = <Metric as clap::ValueEnum>::from_str(&name, false).ok().filter(|metric| *metric != Metric::All);
    let metric = metric.ok_or("expected one of mse, relmse, rmse-tonemapped, psnr, ssim, flip, hdr-flip, mean-ratio before '='")?;
    let bound = bound.parse().ok().filter(|bound: &f64| bound.is_finite()).ok_or("expected a finite number after '='")?;
    Ok(Limit { metric, bound })
}

impl Limit {
    /// NaN never holds.
    fn holds(&self, value: f64) -> bool {
        match self.metric {
            Metric::Psnr | Metric::Ssim => value >= self.bound,
            Metric::MeanRatio => (value - 1.0).abs() <= self.bound,
            _ => value <= self.bound,
        }
    }
}

/// One line of the result.
struct Row {
    metric: Metric,
    name: &'static str,
    value: f64,
}

/// Both pictures, as radiance, as a screen emits them, and as it takes them.
struct Comparison<'a> {
    radiance: Pair<'a>,
    displayed: Pair<'a>,
    encoded: Pair<'a>,
    flip: LazyCell<ErrorMap, Box<dyn FnOnce() -> ErrorMap + 'a>>,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    check_writable(args.heatmap.as_deref())?;
    let pictures = [Image::read(&args.image)?, Image::read(&args.reference)?];
    let radiance = Pair::new(&pictures[0], &pictures[1])?;
    let mapped = |map: fn(&ToneMapping, &Image) -> Image| {
        [(&args.image, &pictures[0]), (&args.reference, &pictures[1])].map(|(path, image)| map(&args.mapping(path), image))
    };
    let [displayed, encoded] = [mapped(ToneMapping::displayed), mapped(ToneMapping::encoded)];
    let [displayed, encoded] = [Pair::new(&displayed[0], &displayed[1])?, Pair::new(&encoded[0], &encoded[1])?];
    let comparison = Comparison { radiance, displayed, encoded, flip: LazyCell::new(Box::new(|| metrics::flip(&encoded))) };
    let rows = comparison.rows(args)?;
    if let Some(path) = &args.heatmap {
        write_atomically(path, |file| {
            write_png_bytes(pictures[0].width, pictures[0].height, &metrics::flip::heatmap(&comparison.flip), file)
        })?;
    }
    print_result(&if args.json { args.json_text(&pictures[0], &rows) } else { args.table(&rows) })?;
    let all_hold = args.checks(&rows).all(|(_, _, holds)| holds);
    Ok(if all_hold { Outcome::Done } else { Outcome::CheckFailed })
}

impl Comparison<'_> {
    /// What was asked for, and what a limit needs.
    fn rows(&self, args: &Args) -> anyhow::Result<Vec<Row>> {
        use Metric::*;
        let limited = |metric| args.fail_above.iter().any(|limit| limit.metric == metric);
        let mut rows = Vec::new();
        for metric in [Mse, Relmse, RmseTonemapped, Psnr, Ssim, Flip, HdrFlip, MeanRatio] {
            let named = args.metric == metric || limited(metric);
            if !named && args.metric != All {
                continue;
            }
            match self.measure(metric) {
                Ok(values) => rows.extend(values.into_iter().map(|(name, value)| Row { metric, name, value })),
                Err(error) if !named => tracing::warn!("{error}"),
                Err(error) => return Err(error.into()),
            }
        }
        Ok(rows)
    }

    /// The first value of each is the one that limits look at.
    fn measure(&self, metric: Metric) -> Result<Vec<(&'static str, f64)>, MetricError> {
        Ok(match metric {
            Metric::Mse => vec![("mse", metrics::mse(&self.radiance))],
            Metric::Relmse => {
                let trimmed = |fraction| metrics::relmse(&self.radiance, fraction);
                vec![("relmse", trimmed(0.0)), ("relmse_trimmed", trimmed(metrics::relmse::WORST_TRIMMED))]
            }
            Metric::RmseTonemapped => vec![("rmse_tonemapped", metrics::rmse_tonemapped(&self.displayed))],
            Metric::Psnr => vec![("psnr", metrics::psnr(&self.encoded))],
            Metric::Ssim => vec![("ssim", metrics::ssim(&self.encoded)?)],
            Metric::Flip => summary(["flip", "flip_p99", "flip_worst_tile"], &self.flip),
            Metric::HdrFlip => summary(["hdr_flip", "hdr_flip_p99", "hdr_flip_worst_tile"], &metrics::hdr_flip(&self.radiance)),
            Metric::MeanRatio => vec![("mean_ratio", metrics::mean_ratio(&self.radiance))],
            Metric::All => vec![],
        })
    }
}

fn summary([mean, percentile_99, worst_tile]: [&'static str; 3], map: &ErrorMap) -> Vec<(&'static str, f64)> {
    vec![(mean, map.mean()), (percentile_99, map.percentile_99()), (worst_tile, map.worst_tile())]
}

impl Args {
    /// A PNG holds what a screen shows already.
    fn mapping(&self, path: &Path) -> ToneMapping {
        match path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
            true => ToneMapping { exposure: 0.0, curve: ToneCurve::None },
            false => ToneMapping { exposure: self.exposure, curve: self.tonemap },
        }
    }

    /// Each limit, the value that it is about, and whether it holds.
    fn checks(&self, rows: &[Row]) -> impl Iterator<Item = (Limit, f64, bool)> {
        self.fail_above.iter().filter_map(|limit| {
            let value = rows.iter().find(|row| row.metric == limit.metric)?.value;
            Some((*limit, value, limit.holds(value)))
        })
    }

    fn table(&self, rows: &[Row]) -> String {
        let mut lines: Vec<String> = rows.iter().map(|row| format!("{:<21}{}", row.name, number(row.value))).collect();
        lines.extend(self.checks(rows).map(|(limit, value, holds)| {
            let verdict = if holds { "holds" } else { "FAILED" };
            format!("{verdict}: --fail-above {}={} at {}", name(limit.metric), limit.bound, number(value))
        }));
        lines.join("\n")
    }

    fn json_text(&self, image: &Image, rows: &[Row]) -> String {
        let values: serde_json::Map<_, _> = rows.iter().map(|row| (row.name.to_owned(), json!(row.value))).collect();
        let checks: Vec<_> = self
            .checks(rows)
            .map(|(limit, value, passed)| json!({ "metric": name(limit.metric), "limit": limit.bound, "value": value, "passed": passed }))
            .collect();
        let document = json!({
            "version": 1,
            "a": self.image.to_string_lossy(), "b": self.reference.to_string_lossy(), "width": image.width, "height": image.height,
            "exposure": self.exposure, "tonemap": name(self.tonemap),
            "metrics": values, "checks": checks,
        });
        format!("{document:#}")
    }
}

/// As on the command line.
fn name(value: impl clap::ValueEnum) -> String {
    value.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}

fn number(value: f64) -> String {
    match value != 0.0 && value.abs() < 1e-2 {
        true => format!("{value:.3e}"),
        false => format!("{value:.5}"),
    }
}
