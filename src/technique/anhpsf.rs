//! `anhpsf`: nhpsf along paths that grow by a bounce with every frame. Their ends are the megakernel's, whatever paths.kernel says.

use super::{PassOptions, Technique, hpsf, nhpsf};
use crate::filter::anhpsf;
use crate::filter::hpsf::Paths;
use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;
use crate::paths;
use crate::paths::vertices::ListOptions;

pub(super) const TECHNIQUE: Technique = Technique {
    name: "anhpsf",
    help: "nhpsf along paths that are continued from frame to frame, by one scattered ray and one shadow ray of each pixel",
    // Deep vertices come back to a cell by chance: it must outlast the frames between.
    defaults: &[("hpsf.recency", "1"), ("hpsf.normal_bits", "6"), ("hpsf.age", "64"), ("nhpsf.vertices", "1"), ("paths.max_bounces", "16")],
    fixed: &nhpsf::SHARED_CELLS,
    passes,
    ..hpsf::TECHNIQUE
};

fn passes(frame: &mut FrameBuilder, options: PassOptions) -> Result<ImageHandle, GpuError> {
    let number = |key| options.parameters.number(key) as u32;
    // Paths are continued from vertices that they have only looked up, in the thesis' form, too.
    let list = ListOptions { most: number("nhpsf.vertices").min(number("paths.max_bounces")).max(1), last_is_read: true };
    let (whole, chooses) = (number("anhpsf.transport") == 1, number("anhpsf.choice") == 1);
    let growth = anhpsf::Options::new(whole, chooses, number("paths.max_bounces"));
    hpsf::passes_of(frame, options, 1 + list.sampled() + growth.sampled(), false, |frame, table| {
        let (terms, vertices, ends) = paths::add_with_ends(frame, list, &|pass, keys| table.looks_up(pass, keys))?;
        let chains = anhpsf::add(frame, table, &vertices, ends, growth)?;
        Ok(Paths { terms, behind: Some(vertices), chains: Some(chains), retraced: None })
    })
}
