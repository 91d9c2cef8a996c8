//! `pathspace inspect`: what is in a scene, which effects it calls for, and why.

mod summary;

use self::summary::Summary;
use super::{Outcome, arguments, output};
use crate::scene::{builtin, source};
use anyhow::bail;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Tell what is in a scene, which effects it calls for, and why
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A .gltf or .glb file, or a built-in scene's name
    #[arg(default_value = builtin::DEFAULT)]
    scene: String,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Write a built-in scene as a .glb that other renderers read
    #[arg(long, value_name = "OUT.glb", value_parser = arguments::glb)]
    export: Option<PathBuf>,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    if let Some(path) = &args.export {
        export(&args.scene, path)?;
    }
    let summary = Summary::of(&source::load(&args.scene)?);
    output::print_result(&if args.json { serde_json::to_string_pretty(&summary)? } else { summary.to_string() })?;
    Ok(Outcome::Done)
}

fn export(scene: &str, path: &Path) -> anyhow::Result<()> {
    let Some(request) = builtin::find(scene)? else {
        bail!(
            "'{scene}' is no built-in scene, and only those are exported; built in are {}",
            builtin::names().collect::<Vec<_>>().join(", ")
        );
    };
    output::write_atomically(path, |file| file.write_all(&request.glb()))
}
