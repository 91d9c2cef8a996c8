//! Each step of all paths in a kernel of its own, with queues between them: shaders_glsl/paths/wavefront/, Laine, Karras and Aila, "Megakernels
//! Considered Harmful", HPG 2013, sections 3 and 4; the stages are those of Meijer, section 4.4. The steps themselves are the megakernel's
//! (paths/path.glsl), and so is the picture.
//!
//! Takes the scene. Also returns `ray_count`: scattered rays in the low, shadow rays in the high 16 bits. No history.
//!
//! A turn is one visit to a vertex: extend traces the paths' rays, shade visits what they have hit and appends shadow rays and the paths that
//! go on to the queues of this turn and the next, connect traces the shadow rays and adds their light up. The first vertex is
//! visited once for each of its shadow rays. What is in a queue sizes the dispatches over it. All samples of a pixel but the first are these
//! passes recorded again.
//!
//! Keeps 196 bytes per pixel, 288 with terms apart: 100 of path (ray 32, weights 32, footprint 16, hit 20), 64 of shadow ray and
//! its light, 8 of queues, 24 of sums, or 72 and 44 of filter vertex; lists of vertices grow where they are put out (lists.glsl). Deviations and why: one kernel shades all materials, for they differ by numbers, not by code;
//! a pixel's paths do not overlap, so that sums need no atomics and are the same in every run. Declared bytes are those of a frame in
//! which no path ends early.
//!
//! Measured on a software driver with two cores, 256x144: paths of hpsf+ take 0.75 of the megakernel's time in Sponza, 0.85 on cornell, 0.92 on
//! material, and a frame 0.83, 0.94 and 0.95. Threads that fetch their next ray where one of their subgroup has ended, within the traversal (Aila
//! and Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009), make extend slower there, by 1.1 to 1.5.

use super::terms::Terms;
use super::tiles;
use super::vertices::{ListOptions, LooksUp, PathVertices};
use crate::frame::{BufferHandle, FrameBuilder, ImageHandle, MOST_GROUPS, PassBuilder};
use crate::gpu::{GpuError, vk};

/// Specialization constant: queues.
const HEADS: u32 = 203;
/// Threads of a workgroup over a queue (queue.glsl).
const QUEUE_GROUP: u32 = 128;

/// Bytes (queue.glsl, records.glsl).
const HEAD: u64 = 16;
pub const RAY: u64 = 32;
pub const WEIGHTS: u64 = 32;
pub const FOOTPRINT: u64 = 16;
const HIT: u64 = 20;
const LIGHT: u64 = 32;
const SUMS: u64 = 24;
const VERTEX: u64 = 44;

/// What the number of turns follows from.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    pub max_bounces: u32,
    /// To the first vertex, one for each of its shadow rays.
    pub first_visits: u32,
}

impl Options {
    /// Visits to vertices: the one after the last scattering can only find a light.
    fn turns(self) -> u32 {
        self.first_visits + self.max_bounces + 1
    }

    /// Vertices before the one that is visited.
    fn vertex(self, turn: u32) -> u32 {
        (turn + 1).saturating_sub(self.first_visits)
    }

    /// Whether the turn begins with a ray that arrives, or is another visit to the first vertex.
    fn arrives(self, turn: u32) -> bool {
        turn == 0 || self.vertex(turn) > 0
    }
}

/// Radiance, the mean of the frame's samples per pixel.
pub fn add(frame: &mut FrameBuilder, options: Options) -> Result<ImageHandle, GpuError> {
    let wavefront = Wavefront::new(frame, false)?;
    wavefront.trace(frame, options)?;
    let radiance = frame.color_image("radiance")?;
    let pass = frame.pass("wavefront write", "paths/wavefront/write").elements(wavefront.slots);
    pass.writes("radiance", radiance).reads("front", wavefront.front).add()?;
    Ok(radiance)
}

/// One sample per pixel, through the same point of the pixel as the g-buffer's.
pub fn add_with_terms(frame: &mut FrameBuilder, options: Options) -> Result<Terms, GpuError> {
    let wavefront = Wavefront::new(frame, true)?;
    wavefront.trace(frame, options)?;
    wavefront.write_terms(frame)
}

/// The same, with the vertices of the path behind its filter vertex: no bytes more than the lists themselves.
pub fn add_with_vertices(
    frame: &mut FrameBuilder,
    options: Options,
    list: ListOptions,
    known: &LooksUp,
) -> Result<(Terms, PathVertices), GpuError> {
    let vertices = PathVertices::new(frame, list)?;
    let wavefront = Wavefront { lists: Some(Lists { vertices, known }), ..Wavefront::new(frame, true)? };
    wavefront.trace(frame, options)?;
    Ok((wavefront.write_terms(frame)?, vertices))
}

/// What the kernels pass on to each other.
struct Wavefront<'k> {
    /// Of paths: pixels, tile by tile.
    slots: u32,
    sample_number: BufferHandle,
    /// Of even and odd turns.
    queues: [BufferHandle; 2],
    rays: BufferHandle,
    weights: BufferHandle,
    footprints: BufferHandle,
    hits: BufferHandle,
    shadow_rays: BufferHandle,
    lights: BufferHandle,
    front: BufferHandle,
    ray_count: ImageHandle,
    apart: Option<TermsApart>,
    lists: Option<Lists<'k>>,
}

/// Sums that only filters ask for.
struct TermsApart {
    direct: BufferHandle,
    indirect: BufferHandle,
    vertices: BufferHandle,
}

/// What the paths' lists of vertices go to, and where they are known to end.
struct Lists<'k> {
    vertices: PathVertices,
    known: &'k LooksUp<'k>,
}

impl Wavefront<'_> {
    fn new(frame: &mut FrameBuilder, terms_apart: bool) -> Result<Self, GpuError> {
        let slots = 32 * tiles(frame.extent());
        check_device(frame, slots)?;
        let mut buffer = |name: &str, bytes: u64| frame.buffer(&format!("wavefront {name}"), u64::from(slots) * bytes);
        let apart = terms_apart.then(|| {
            Ok::<_, GpuError>(TermsApart {
                direct: buffer("direct terms", SUMS)?,
                indirect: buffer("indirect terms", SUMS)?,
                vertices: buffer("filter vertices", VERTEX)?,
            })
        });
        Ok(Self {
            slots,
            apart: apart.transpose()?,
            lists: None,
            queues: [buffer("queue of even turns", 4)?, buffer("queue of odd turns", 4)?],
            rays: buffer("rays", RAY)?,
            weights: buffer("weights", WEIGHTS)?,
            footprints: buffer("footprints", FOOTPRINT)?,
            hits: buffer("hits", HIT)?,
            shadow_rays: buffer("shadow rays", RAY)?,
            lights: buffer("lights", LIGHT)?,
            front: buffer("sums", SUMS)?,
            sample_number: frame.buffer("wavefront sample number", 4)?,
            ray_count: frame.image("ray_count", vk::Format::R32_UINT)?,
        })
    }

    /// A kernel of paths to radiance, of paths with terms apart, or of those with lists of vertices, too.
    fn variant(&self, [plain, terms_apart, vertices]: [&'static str; 3]) -> &'static str {
        match (&self.lists, &self.apart) {
            (Some(_), _) => vertices,
            (None, Some(_)) => terms_apart,
            (None, None) => plain,
        }
    }

    fn trace(&self, frame: &mut FrameBuilder, options: Options) -> Result<(), GpuError> {
        let queues = 2 * (options.turns() + 1);
        let heads = frame.buffer("wavefront heads of queues", u64::from(queues) * HEAD)?;
        frame.fill("wavefront begin", self.sample_number, u32::MAX);
        let first = frame.next_pass();
        let pass = frame.pass("wavefront begin", "paths/wavefront/begin").elements(queues).constant(HEADS, queues);
        pass.writes("heads", heads).updates("sample_number", self.sample_number).add()?;
        self.generate(frame, heads)?;
        for turn in 0..options.turns() {
            if options.arrives(turn) {
                self.extend(frame, heads, turn)?;
            }
            self.shade(frame, heads, options, turn)?;
            // The last arrivals look for no light.
            if turn + 1 < options.turns() {
                self.connect(frame, heads, turn)?;
            }
        }
        frame.repeat_per_sample("wavefront further samples", first);
        Ok(())
    }

    fn generate(&self, frame: &mut FrameBuilder, heads: BufferHandle) -> Result<(), GpuError> {
        let kernel = self.variant(["paths/wavefront/generate", "paths/wavefront/generate_terms", "paths/wavefront/generate_vertices"]);
        let pass = frame.pass("wavefront generate", kernel).elements(self.slots).writes("queue", self.queues[0]);
        let pass = pass.updates("heads", heads).reads("sample_number", self.sample_number).writes("rays", self.rays);
        let pass = pass.writes("weights", self.weights).writes("footprints", self.footprints).writes("front", self.front);
        let pass = pass.writes("ray_count", self.ray_count);
        let apart = self.apart.iter().fold(pass, |pass, apart| {
            pass.writes("direct", apart.direct).writes("indirect", apart.indirect).writes("vertices", apart.vertices)
        });
        self.lists.iter().fold(apart, |pass, lists| lists.vertices.begun_by(pass)).add()
    }

    fn extend(&self, frame: &mut FrameBuilder, heads: BufferHandle, turn: u32) -> Result<(), GpuError> {
        let pass = frame.pass("wavefront extend", "paths/wavefront/extend").argument(turn).indirect(heads, paths_of(turn));
        let pass = pass.reads("heads", heads).reads("queue", self.queues[turn as usize % 2]);
        pass.reads("rays", self.rays).writes("hits", self.hits).add()
    }

    fn shade(&self, frame: &mut FrameBuilder, heads: BufferHandle, options: Options, turn: u32) -> Result<(), GpuError> {
        let kernel = self.variant(["paths/wavefront/shade", "paths/wavefront/shade_terms", "paths/wavefront/shade_vertices"]);
        let pixels = u64::from(frame.pixels());
        let pass = frame.pass("wavefront shade", kernel).argument(turn).indirect(heads, paths_of(turn)).updates("heads", heads);
        let pass = pass.reads("sample_number", self.sample_number).reads("hits", self.hits);
        let pass = pass.reads("queue", self.queues[turn as usize % 2]).writes("next_queue", self.queues[(turn as usize + 1) % 2]);
        let pass = pass.updates("rays", self.rays).updates("weights", self.weights).updates("footprints", self.footprints);
        let pass = pass.writes("shadow_rays", self.shadow_rays).writes("lights", self.lights);
        let pass = pass.updates("front", self.front).updates("ray_count", self.ray_count);
        let apart = self.apart.iter().fold(pass, |pass, apart| {
            pass.updates("direct", apart.direct).updates("indirect", apart.indirect).writes("vertices", apart.vertices)
        });
        self.lists.iter().fold(apart, |pass, lists| lists.lengthened_by(pass, pixels, options.vertex(turn))).add()
    }

    fn connect(&self, frame: &mut FrameBuilder, heads: BufferHandle, turn: u32) -> Result<(), GpuError> {
        let kernel = self.variant(["paths/wavefront/connect", "paths/wavefront/connect_terms", "paths/wavefront/connect_vertices"]);
        let pixels = u64::from(frame.pixels());
        let pass = frame.pass("wavefront connect", kernel).argument(turn).indirect(heads, shadow_rays_of(turn)).reads("heads", heads);
        let pass = pass.reads("shadow_rays", self.shadow_rays).reads("lights", self.lights).updates("front", self.front);
        let apart = self.apart.iter();
        let pass = apart.fold(pass, |pass, apart| pass.updates("direct", apart.direct).updates("indirect", apart.indirect));
        self.lists.iter().fold(pass, |pass, lists| lists.vertices.lit_by(pass, pixels)).add()
    }

    fn write_terms(&self, frame: &mut FrameBuilder) -> Result<Terms, GpuError> {
        let terms = Terms::new(frame)?;
        let pass = frame.pass("wavefront write", "paths/wavefront/write_terms").elements(self.slots).reads("front", self.front);
        let pass = self.apart.iter().fold(pass, |pass, apart| {
            pass.reads("direct", apart.direct).reads("indirect", apart.indirect).reads("vertices", apart.vertices)
        });
        terms.written_by(pass).add()?;
        Ok(terms)
    }
}

impl Lists<'_> {
    /// By the visits to so many paths' vertex number `vertex`: a list's last vertex has at least the others and the filter vertex before it.
    fn lengthened_by<'b, 'a>(&self, pass: PassBuilder<'b, 'a>, paths: u64, vertex: u32) -> PassBuilder<'b, 'a> {
        let keys = if vertex >= self.vertices.options.most { paths } else { 0 };
        (self.known)(self.vertices.lengthened_by(pass, paths), keys)
    }
}

/// Bytes in front of the heads of a turn's queues (queue.glsl).
fn paths_of(turn: u32) -> u64 {
    HEAD * u64::from(2 * turn)
}

fn shadow_rays_of(turn: u32) -> u64 {
    HEAD * u64::from(2 * turn + 1)
}

fn check_device(frame: &FrameBuilder, slots: u32) -> Result<(), GpuError> {
    let capabilities = frame.gpu().capabilities();
    if !capabilities.subgroup_ballot {
        let missing =
            "ballots of subgroups, which paths.kernel=wavefront appends to queues by; paths.kernel=megakernel does without".to_owned();
        return Err(GpuError::MissingFeatures { device: capabilities.name.clone(), missing });
    }
    let most = MOST_GROUPS * QUEUE_GROUP;
    if slots > most {
        let message = format!("paths.kernel=wavefront takes at most {most} pixels; paths.kernel=megakernel takes more");
        return Err(GpuError::Memory { what: "the wavefront's queues".to_owned(), bytes: u64::from(slots) * (RAY + WEIGHTS), message });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bounce_has_a_turn_and_so_has_every_further_shadow_ray() {
        let turns = |max_bounces, first_visits| {
            let options = Options { max_bounces, first_visits };
            let arrivals = (0..options.turns()).filter(|&turn| options.arrives(turn)).count();
            (options.turns(), arrivals)
        };
        assert_eq!(turns(0, 1), (2, 2));
        assert_eq!(turns(8, 1), (10, 10));
        assert_eq!(turns(2, 3), (6, 4));
    }
}
