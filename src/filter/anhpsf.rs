//! Paths that are continued from frame to frame, filtered at every diffuse vertex: shaders_glsl/filter/anhpsf/, Meijer, section 4.4. Two passes
//! beside those of [`super::nhpsf`], whose functions and table they share.
//!
//! continue: takes the ends of this frame's paths, their lists and the last frame's table; one scattered ray and one shadow ray for the path
//! that each pixel continues. transport: takes the chains that come of it and the same table; returns the chains' samples as a list, which
//! enters cells as nhpsf's does. History: the paths, 108 bytes a pixel, and 48 for each vertex of a chain: two, three where paths give
//! way to others, or all of a path. Reads and writes as much, 48 more of ends, 20 for each lookup, and 16 for each sample.

use super::hpsf::Table;
use crate::frame::FrameBuilder;
use crate::gpu::{GpuError, vk};
use crate::paths::vertices::{ListOptions, PathEnds, PathVertices};
use crate::paths::{FOOTPRINT, RAY, WEIGHTS, tiles};

/// Specialization constant: last vertex of this frame's lists.
const LIST_END: u32 = 207;

/// Bytes (chain.glsl).
const CONTINUED: u64 = 28;
const VERTEX_PART: u64 = 16;

/// How paths are continued.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// Vertices of a chain: two, or as many as a path can have behind its first filter vertex, the one that is only looked up included.
    length: u32,
    /// A path may give way to another (shaders_glsl/filter/anhpsf/choice.glsl).
    chooses: bool,
}

impl Options {
    /// `whole`: light travels between all vertices of a path, which then gives way to none.
    pub fn new(whole: bool, chooses: bool, max_bounces: u32) -> Self {
        if whole && chooses {
            tracing::warn!("anhpsf.choice=importance is for anhpsf.transport=last: the deepest path goes on");
        }
        Self { length: if whole { (max_bounces + 1).max(2) } else { 2 }, chooses: chooses && !whole }
    }

    /// Vertices of a chain that may have samples.
    pub fn sampled(&self) -> u32 {
        self.length
    }
}

/// `lists`: of this frame's paths, which can be continued at `ends`.
pub fn add(
    frame: &mut FrameBuilder,
    table: &Table,
    lists: &PathVertices,
    ends: PathEnds,
    options: Options,
) -> Result<PathVertices, GpuError> {
    let pixels = u64::from(frame.pixels());
    let Options { length, chooses } = options;
    // Behind a chain's vertices waits the one that it has given way to.
    let part = VERTEX_PART * pixels * u64::from(length + u32::from(chooses));
    let light = frame.kept_buffer("light of chains", part)?;
    let chains = PathVertices {
        options: ListOptions { most: length, last_is_read: false },
        count: frame.image("chain_samples", vk::Format::R32_UINT)?,
        places: frame.kept_buffer("places of chains", part)?,
        links: frame.kept_buffer("links of chains", part)?,
        light: frame.buffer("samples of chains", part)?,
        ..*lists
    };
    let vertices = frame.image("chain_vertices", vk::Format::R32_UINT)?;
    let state = [("continued", CONTINUED), ("rays", RAY), ("weights", WEIGHTS), ("footprints", FOOTPRINT)];
    let state = state.map(|(name, bytes)| frame.kept_buffer(&format!("{name} of chains"), bytes * pixels).map(|buffer| (name, buffer)));
    let groups = tiles(frame.extent());
    let pass = frame.pass("anhpsf continue", "filter/anhpsf/continue").groups(groups).updates("ray_count", ends.ray_count);
    // What ends a chain is its path's depth, not its length.
    let pass = ListOptions { most: u32::MAX, last_is_read: false }.constants(pass.constant(LIST_END, lists.options.most - 1));
    let last = VERTEX_PART * pixels;
    let pass = pass.reads("ends", ends.places).reads("list_places", lists.places).touching(last);
    let pass = pass.reads("list_links", lists.links).touching(last).reads("list_light", lists.light).touching(last);
    let pass = state.into_iter().try_fold(pass, |pass, state| state.map(|(name, buffer)| pass.updates(name, buffer)))?;
    let pass = pass.updates("chain_places", chains.places).touching(2 * last).updates("chain_links", chains.links).touching(2 * last);
    let pass = pass.updates("chain_light", light).touching(2 * last);
    let pass = table.looks_up(pass, if chooses { 2 * pixels } else { 0 });
    pass.writes("chain_vertices", vertices).writes("chain_samples", chains.count).add()?;

    let pass = frame.pass("anhpsf transport", "filter/anhpsf/transport").reads("chain_vertices", vertices);
    let pass = pass.updates("chain_samples", chains.count).reads("chain_places", chains.places).reads("chain_links", chains.links);
    let pass = pass.reads("chain_light", light).writes("sample_light", chains.light);
    table.looks_up(pass, pixels * u64::from(length)).add()?;
    Ok(chains)
}
