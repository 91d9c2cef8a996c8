//! `pathspace bench`: what accuracy costs in time, on this device.

use super::Outcome;
use super::progress::Progress;
use crate::bench::log;
use crate::bench::plan::{self, Planned, Shard};
use crate::bench::runner::{BenchError, Runner};
use crate::bench::suite::Suite;
use crate::gpu::{DeviceOptions, Gpu};
use anyhow::{Context, bail};
use std::path::PathBuf;

/// Measure time and accuracy of a suite: scenes x techniques x parameters x sizes x frames
#[derive(Debug, clap::Args)]
pub struct Args {
    /// What to measure [default: the suite that ships]
    #[arg(value_name = "SUITE.toml")]
    pub suite: Option<PathBuf>,
    /// Folder for results.jsonl, pictures and report
    #[arg(short, long, value_name = "DIR", default_value = "out/bench")]
    pub output: PathBuf,
    /// What takes minutes instead of hours: the suite's [quick] part
    #[arg(long)]
    pub quick: bool,
    /// Measure only part K of N; shards share nothing, so any scheduler can spread them
    #[arg(long, value_name = "K/N")]
    pub shard: Option<Shard>,
    /// Go on where an earlier run into the same folder ended
    #[arg(long)]
    pub resume: bool,
    /// Vulkan device, as 'pathspace devices' lists them [default: the best]
    #[arg(long, value_name = "NAME|INDEX")]
    pub device: Option<String>,
    /// List the points and measure none
    #[arg(long)]
    pub list: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let suite = Suite::load(args.suite.as_deref())?;
    let suite = if args.quick { suite.quick() } else { suite };
    let mut points = plan::plan(&suite)?;
    if let Some(shard) = args.shard {
        points = plan::shard(points, shard);
    }
    if args.list {
        let line = |planned: &Planned| Ok(format!("{} {}\n", planned.key, serde_json::to_string(&planned.point)?));
        let lines: anyhow::Result<String> = points.iter().map(line).collect();
        super::output::print_result(&lines?)?;
        return Ok(Outcome::Done);
    }
    let results = args.output.join(log::FILE_NAME);
    if !args.resume && results.exists() {
        bail!("'{}' holds results already: --resume goes on there, another -o begins anew", results.display());
    }
    let gpu = Gpu::open(&DeviceOptions { device: args.device.clone(), ..Default::default() })?;
    std::fs::create_dir_all(&args.output).with_context(|| format!("cannot make the folder '{}'", args.output.display()))?;
    let mut runner = Runner::new(&gpu, &suite, &args.output)?;
    points.retain(|planned| !runner.has(planned));
    let failed = measure(&mut runner, &points, suite.seeds)?;
    drop(runner);
    super::report::write(std::slice::from_ref(&args.output), &args.output.join("report"))?;
    super::output::print_result(&format!("{}", args.output.join("report/index.html").display()))?;
    Ok(if failed == 0 { Outcome::Done } else { Outcome::CheckFailed })
}

/// A point that cannot be measured is reported and passed over; the number of these.
fn measure(runner: &mut Runner, points: &[Planned], seeds: u32) -> anyhow::Result<usize> {
    let total = points.iter().map(|planned| planned.samples(seeds)).sum();
    let progress = Progress::new("measuring", total, "samples");
    let mut failed = 0;
    for planned in points {
        let point = &planned.point;
        progress.what(&format!("{}, {} spp {} frames {}", point.scene, point.technique, point.spp, point.frames));
        match runner.measure(planned) {
            Ok(record) => report_faults(&record),
            Err(error @ (BenchError::Log(_) | BenchError::Picture { .. })) => return Err(error.into()),
            Err(error) => {
                tracing::error!("{} with {} at {} spp could not be measured: {error}", point.scene, point.technique, point.spp);
                failed += 1;
            }
        }
        progress.advance(planned.samples(seeds));
    }
    Ok(failed)
}

fn report_faults(record: &crate::bench::Record) {
    for key in ["nan", "infinite", "negative"] {
        if let Some(figure) = record.figures.get(key).filter(|figure| figure.value != 0.0) {
            let point = &record.point;
            tracing::warn!("{} with {} at {} spp: {} {} pixels", point.scene, point.technique, point.spp, figure.value, key);
        }
    }
}
