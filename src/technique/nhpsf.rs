//! `nhpsf`: hpsf at every diffuse vertex of a path; light travels from cell to cell, a bounce or more with every frame.

use super::{PassOptions, Technique, hpsf};
use crate::filter::hpsf::Paths;
use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;
use crate::paths::vertices::ListOptions;

pub(super) const TECHNIQUE: Technique = Technique {
    name: "nhpsf",
    help: "hpsf at every diffuse vertex of a short path, which goes on in what the last frame's cells know",
    defaults: &[("hpsf.recency", "1"), ("hpsf.normal_bits", "6")],
    fixed: &SHARED_CELLS,
    passes,
    ..hpsf::TECHNIQUE
};

/// Vertices of the picture and those behind share cells, and must not differ in what light they hold.
pub(super) const SHARED_CELLS: [(&str, &str); 1] = [("lights.sole", "sampled")];

fn passes(frame: &mut FrameBuilder, options: PassOptions) -> Result<ImageHandle, GpuError> {
    let list = list_of(options);
    hpsf::passes_of(frame, options, 1 + list.sampled(), false, |frame, table| {
        let (terms, vertices) = options.kernel().add_with_vertices(frame, list, &|pass, keys| table.looks_up(pass, keys))?;
        Ok(Paths { terms, behind: Some(vertices), chains: None, retraced: None })
    })
}

/// A list has the vertices behind the first one. The thesis ends paths with one that enters its cell, the balanced form with one that is read,
/// which has to come within the bounces of a path.
pub(super) fn list_of(options: PassOptions) -> ListOptions {
    let number = |key| options.parameters.number(key) as u32;
    let last_is_read = options.parameters.number("nhpsf.form") == 0.0;
    let most = if last_is_read { number("nhpsf.vertices").min(number("paths.max_bounces")) } else { number("nhpsf.vertices") - 1 };
    ListOptions { most: most.max(1), last_is_read }
}
