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
    let (pixels, most) = (u64::from(frame.pixels()), u64::from(vertices.options.most));
    let (name, seen, looked_up) = match sending {
        Sending::All => ("nhpsf transport", most, most),
        Sending::Behind => ("nhpsf transport", most, most - 1),
        Sending::First => ("nhpsf send", 1, 1),
    };
    let (receives, sends, touched) = (sending != Sending::First, sending != Sending::Behind, 16 * pixels * seen);
    let pass = frame.pass(name, "filter/nhpsf/transport").constant(RECEIVES, receives.into()).constant(SENDS, sends.into());
    let pass = pass.reads("path_vertices", vertices.count).reads("vertex_places", vertices.places).touching(touched);
    let pass = pass.reads("vertex_links", vertices.links).touching(touched).updates("vertex_light", vertices.light).touching(touched);
    let pass = touched_if(sends, pass.reads("specular_attenuation", vertices.specular_attenuation));
    let pass = touched_if(sends, pass.updates("diffuse_indirect", terms.diffuse_indirect));
    let pass = touched_if(sends, pass.updates("specular_indirect", terms.specular_indirect));
    if receives { table.looks_up(pass, pixels * looked_up).add() } else { table.looks_up_now(pass, pixels * looked_up).add() }
}

/// The image named last may be bound for nothing.
fn touched_if<'b, 'a>(touched: bool, pass: PassBuilder<'b, 'a>) -> PassBuilder<'b, 'a> {
    if touched { pass } else { pass.touching(0) }
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
