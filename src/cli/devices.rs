//! `pathspace devices`: every Vulkan device, what it lacks, and what is used instead.

use super::Outcome;
use super::output::print_result;
use crate::gpu::{Capabilities, GpuError, Substitute, list_devices};
use serde::Serialize;
use std::fmt::Write;

/// List the Vulkan devices: capabilities, what is missing, what is used instead
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Serialize)]
struct Report<'a> {
    version: u32,
    devices: Vec<Row<'a>>,
}

#[derive(Serialize)]
struct Row<'a> {
    index: usize,
    usable: bool,
    #[serde(flatten)]
    capabilities: &'a Capabilities,
    substitutes: Vec<Substitute>,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let devices = list_devices()?;
    if devices.is_empty() {
        return Err(GpuError::NoDevice.into());
    }
    let report = Report { version: 1, devices: devices.iter().enumerate().map(|(index, capabilities)| row(index, capabilities)).collect() };
    print_result(&if args.json { serde_json::to_string_pretty(&report)? } else { table(&report) })?;
    Ok(Outcome::Done)
}

fn row(index: usize, capabilities: &Capabilities) -> Row<'_> {
    Row { index, usable: capabilities.usable(), capabilities, substitutes: capabilities.substitutes() }
}

fn table(report: &Report) -> String {
    let mut text = String::new();
    for Row { index, capabilities: c, substitutes, .. } in &report.devices {
        let memory = c.device_local_memory as f64 / (1u64 << 30) as f64;
        let yes = |has: bool| if has { "yes" } else { "no" };
        writeln!(text, "{index}  {}\n   {}, Vulkan {}, {memory:.1} GiB, subgroups of {}", c.name, c.driver, c.vulkan, c.subgroup_size).ok();
        writeln!(text, "   ray query: {}, float atomics: {}", yes(c.ray_query), yes(c.float_atomics)).ok();
        for missing in &c.missing {
            writeln!(text, "   cannot be used: it lacks {missing}").ok();
        }
        for Substitute { lacks, instead } in substitutes {
            writeln!(text, "   without {lacks}: {instead}").ok();
        }
    }
    text
}
