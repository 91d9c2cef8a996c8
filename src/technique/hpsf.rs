//! `hpsf`: the radiance behind the filter vertex, averaged over cells of the world that a hash table keeps.

use super::{PassOptions, Technique, nhpsf};
use crate::display::temporal::{Changes, Known};
use crate::display::{composite, temporal};
use crate::filter::hpsf::{self, Filtered, Options, Part, Paths, Table};
use crate::filter::smooth::{self, Layer, Passes};
use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;
use crate::paths::gbuffer;
use crate::paths::gbuffer::GBuffer;
use crate::paths::terms::Terms;
use crate::paths::vertices::ListOptions;
use crate::scene::effects::Effect;

/// The value of hpsf.time.
const HYBRID: f64 = 3.0;

pub(super) const TECHNIQUE: Technique = Technique {
    name: "hpsf",
    help: "one path per pixel; what arrives at its first diffuse vertex is averaged over hashed cells of the world, and over frames",
    accumulates: false,
    rounds: true,
    extra_outputs: &hpsf::STATISTICS,
    defaults: &[],
    fixed: &[],
    passes,
};

fn passes(frame: &mut FrameBuilder, options: PassOptions) -> Result<ImageHandle, GpuError> {
    let splits = options.parameters.number("hpsf.split") == 1.0;
    passes_of(frame, options, 1, splits, |frame, _| add_paths(frame, options))
}

/// `vertices`: of a path that are added to cells. `splits`: direct and indirect light have a table each, which light that vertices send each
/// other cannot be parted into.
pub(super) fn passes_of(
    frame: &mut FrameBuilder,
    options: PassOptions,
    vertices: u32,
    splits: bool,
    add_paths: impl FnOnce(&mut FrameBuilder, &Table) -> Result<Paths, GpuError>,
) -> Result<ImageHandle, GpuError> {
    let over_frames = options.parameters.number("hpsf.temporal") == 1.0;
    let wanted = over_frames || options.wants(&gbuffer::OUTPUTS);
    let gbuffer = wanted.then(|| gbuffer::add(frame)).transpose()?;
    let history = match gbuffer {
        Some(gbuffer) if over_frames => Some((gbuffer, Known::new(frame)?)),
        _ => None,
    };
    let part = if splits { Part::Direct } else { Part::Both };
    let table = Table::new(frame, Options { vertices, ..table_options(options, part) })?;
    let mut further_table = |wanted: bool, part| wanted.then(|| Table::new(frame, table_options(options, part))).transpose();
    let indirect = further_table(splits, Part::Indirect)?;
    let glossy = further_table(options.parameters.number("hpsf.glossy") == 1.0, Part::Glossy)?;
    let paths = add_paths(frame, &table)?;
    let (mut diffuse, mut indirect, change) = filter_diffuse(frame, &table, indirect.as_ref(), &paths, options)?;
    let mut specular = filter_specular(frame, glossy.as_ref(), &paths, history.as_ref(), options)?;
    let terms = &paths.terms;
    smooth::add(frame, &terms.vertex, [Some(&mut diffuse), indirect.as_mut(), specular.as_mut()])?;
    let mean = |layer: Layer| layer.noisy.mean;
    let diffuse = [mean(diffuse), mean(indirect.unwrap_or(diffuse))];
    let specular = specular.map_or([terms.specular_direct, terms.specular_indirect], |both| [mean(both); 2]);
    let radiance = composite::add_parts(frame, terms, diffuse, specular)?;
    match history {
        Some((gbuffer, known)) => {
            let changes = change.map(|change| Changes { change, vertices: paths.terms.vertex.position });
            temporal::add(frame, &gbuffer, &known, radiance, changes)
        }
        None => options.mean_of_rounds(frame, radiance),
    }
}

/// Paths; some of the last frame's, too, where cells want to know of changes and something moves that could make one. Where nothing does,
/// they would find exactly none.
fn add_paths(frame: &mut FrameBuilder, options: PassOptions) -> Result<Paths, GpuError> {
    let moves = options.effects.contains(Effect::ObjectAnimation);
    if options.parameters.number("hpsf.time") == HYBRID && moves {
        let (terms, retraced) = options.kernel().add_with_retraced(frame, options.parameters.number("hpsf.retrace") as u32)?;
        return Ok(Paths { terms, behind: None, chains: None, retraced: Some(retraced) });
    }
    let list = nhpsf::list_of(options);
    let reads = options.parameters.number("hpsf.second") == 1.0 && list.sampled() > 0;
    let terms =
        if reads && !moves { add_paths_to_second_vertices(frame, options, list)? } else { options.kernel().add_with_terms(frame)? };
    Ok(Paths { terms, behind: None, chains: None, retraced: None })
}

/// What arrives at a second vertex is what a table of its own knows of it, whose cells come to know of light that changes too late.
fn add_paths_to_second_vertices(frame: &mut FrameBuilder, options: PassOptions, list: ListOptions) -> Result<Terms, GpuError> {
    let cells = Table::new(frame, Options { vertices: list.sampled(), ..table_options(options, Part::Behind) })?;
    let (terms, vertices) = options.kernel().add_with_vertices(frame, list, &|pass, keys| cells.looks_up(pass, keys))?;
    cells.learn(frame, &terms, &vertices)?;
    Ok(terms)
}

/// Direct and indirect light, or their sum alone; and where it changes.
fn filter_diffuse(
    frame: &mut FrameBuilder,
    table: &Table,
    indirect: Option<&Table>,
    paths: &Paths,
    options: PassOptions,
) -> Result<(Layer, Option<Layer>, Option<ImageHandle>), GpuError> {
    let changes = table.changes(frame, paths)?;
    let Filtered { noisy, change } = table.filter(frame, paths, changes)?;
    let layer = |noisy, names, key| Layer { noisy, names, passes: smoothing(options, key) };
    let Some(indirect) = indirect else { return Ok((layer(noisy, smooth::DIFFUSE, "hpsf.smooth"), None, change)) };
    let direct = layer(noisy, smooth::DIRECT, "hpsf.smooth");
    let noisy = indirect.filter(frame, paths, changes)?.noisy;
    Ok((direct, Some(layer(noisy, smooth::INDIRECT, "hpsf.smooth_indirect")), change))
}

/// What other lobes reflect, likewise; none where the path's own terms stay as they are.
fn filter_specular(
    frame: &mut FrameBuilder,
    glossy: Option<&Table>,
    paths: &Paths,
    history: Option<&(GBuffer, Known)>,
    options: PassOptions,
) -> Result<Option<Layer>, GpuError> {
    let passes = smoothing(options, "hpsf.smooth_specular");
    let noisy = match glossy {
        Some(table) => {
            let changes = table.changes(frame, paths)?;
            table.filter(frame, &Paths { behind: None, chains: None, ..*paths }, changes)?.noisy
        }
        None if passes.count == 0 => return Ok(None),
        None => smooth::add_specular(frame, &paths.terms, history)?,
    };
    Ok(Some(Layer { noisy, names: smooth::SPECULAR, passes }))
}

fn smoothing(options: PassOptions, key: &str) -> Passes {
    let number = |end: &str| options.parameters.number(&format!("{key}{end}"));
    Passes { count: number("") as usize, blind: number("_blind") as usize, few: number("_few") as f32 }
}

fn table_options(options: PassOptions, part: Part) -> Options {
    let number = |key| options.parameters.number(key);
    Options {
        part,
        cells_per_pixel: number("hpsf.cells"),
        levels: number("hpsf.levels") as u32,
        vertices: 1,
        swapped: number("hpsf.table") == 1.0,
        ordered: number("hpsf.insertion") == 1.0,
        evicts: number("hpsf.eviction") == 1.0,
        exact_keys: number("hpsf.keys") == 1.0 && part != Part::Glossy,
        float_sums: number("hpsf.sums") == 1.0,
        iterations: number("hpsf.iterations") as u32,
        statistics: !matches!(part, Part::Indirect | Part::Glossy | Part::Behind) && options.wants(&hpsf::STATISTICS),
    }
}
