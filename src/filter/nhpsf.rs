//! Filtering at every diffuse vertex of a path: shaders_glsl/filter/nhpsf/, Meijer, section 4.3. Two passes around those of
//! [`super::hpsf`], whose table they share.
//!
//! transport: takes the lists of vertices and the last frame's table; adds what the vertices send to the one before them to the lists'
//! radiance, and to the terms `diffuse_indirect` and `specular_indirect`; of a table of these vertices alone, the terms get theirs from this
//! frame's table, in a pass behind collect. Reads 40 bytes a pixel and 48 a vertex, 20 (at fp16: 12) for
//! each level of a vertex, and writes 32 and 16. collect: takes the lists; adds each vertex's radiance to its cell, as hpsf's collect does.

use super::hpsf::Table;
use crate::frame::{FrameBuilder, PassBuilder};
use crate::gpu::GpuError;
use crate::paths::terms::Terms;
use crate::paths::vertices::PathVertices;

/// Specialization constants: vertices of a list that enter cells; steps of transport.
const STORED_VERTICES: u32 = 206;
const RECEIVES: u32 = 207;
const SENDS: u32 = 208;

/// Which vertices send, and which cells they look up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sending {
    /// All of them, those of the last frame.
    All,
    /// Those behind the first one of the list, the same.
    Behind,
    /// The first one of the list, this frame's.
    First,
}

pub(super) fn transport(
    frame: &mut FrameBuilder,
    table: &Table,
    terms: &Terms,
    vertices: &PathVertices,
    sending: Sending,
) -> Result<(), GpuError> {
    let pixels = u64::from(frame.pixels());
    let (first, name) = (sending == Sending::First, if sending == Sending::First { "nhpsf send" } else { "nhpsf transport" });
    let pass = frame.pass(name, "filter/nhpsf/transport").constant(RECEIVES, (!first).into());
    let pass = reads_places(pass.constant(SENDS, (sending != Sending::Behind).into()), vertices);
    let pass = pass.updates("vertex_light", vertices.light).reads("specular_attenuation", vertices.specular_attenuation);
    let pass = pass.updates("diffuse_indirect", terms.diffuse_indirect).updates("specular_indirect", terms.specular_indirect);
    let pass = if first { table.looks_up_now(pass, pixels) } else { table.looks_up(pass, pixels * u64::from(vertices.options.most)) };
    pass.add()
}

pub(super) fn collect(frame: &mut FrameBuilder, table: &Table, vertices: &PathVertices) -> Result<(), GpuError> {
    let stem = table.stem("filter/nhpsf/collect_float", "filter/nhpsf/collect_fixed");
    let (pass, samples) = sampled_vertices(frame, "nhpsf collect", stem, vertices);
    table.insert(pass, samples)
}

pub(super) fn claim(frame: &mut FrameBuilder, table: &Table, vertices: &PathVertices) -> Result<(), GpuError> {
    let (pass, samples) = sampled_vertices(frame, "nhpsf claim", "filter/nhpsf/claim_ordered", vertices);
    table.claim(pass, samples)
}

pub(super) fn evict(frame: &mut FrameBuilder, table: &Table, vertices: &PathVertices) -> Result<(), GpuError> {
    let (pass, samples) = sampled_vertices(frame, "nhpsf evict", "filter/nhpsf/evict", vertices);
    table.evict(pass, samples)
}

/// A pass over all vertices that enter cells, and their number.
fn sampled_vertices<'b, 'a>(
    frame: &'b mut FrameBuilder<'a>,
    name: &'static str,
    stem: &'static str,
    vertices: &PathVertices,
) -> (PassBuilder<'b, 'a>, u32) {
    let samples = frame.pixels() * vertices.options.sampled();
    let pass = reads_places(frame.pass(name, stem), vertices).elements(samples);
    (pass.constant(STORED_VERTICES, vertices.options.sampled()).reads("vertex_light", vertices.light), samples)
}

fn reads_places<'b, 'a>(pass: PassBuilder<'b, 'a>, vertices: &PathVertices) -> PassBuilder<'b, 'a> {
    let pass = pass.reads("path_vertices", vertices.count);
    pass.reads("vertex_places", vertices.places).reads("vertex_links", vertices.links)
}
