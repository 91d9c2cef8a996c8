// Every switch and number that `--set key=value` can change, defined once: field, key, default, range, unit, help.
//
//   //@ key default [min..max | a|b|c] [unit]
//   /// help: effect on the picture; cost.
//   type field;
//
// build.rs reads these lines into the host's table, from which CLI, GUI, benchmark and report take them. An enumeration's
// values count from 0 in the order given. Constants are specialization constants (a change compiles a new pipeline);
// fields of Parameters are read at run time.

#ifndef SHARED_PARAMETERS_GLSL
#define SHARED_PARAMETERS_GLSL

//@ rays.intersection watertight watertight|moller-trumbore
/// Ray-triangle test of the BVH structures. Watertight (Woop et al. 2013) leaves no gaps along shared edges; Moeller-Trumbore is a little faster.
layout(constant_id = 100) const uint INTERSECTION = 0;
//@ rays.offset error-bound error-bound|epsilon
/// How secondary rays leave a surface: by the error bound of the hit point, or by a fixed 1e-4 m along the normal.
layout(constant_id = 101) const uint RAY_OFFSET = 0;
//@ paths.sampler sobol sobol|r2|independent
/// Sample sequence: Owen-scrambled Sobol, R2 with Cranley-Patterson rotation, or independent PCG. Sobol converges fastest; independent is cheapest.
layout(constant_id = 102) const uint SAMPLER = 0;
//@ paths.direct mis mis|nee|bsdf
/// Direct light: both strategies weighted by the power heuristic, light sampling alone, or BSDF sampling alone. The mean is the same; the noise is not.
layout(constant_id = 103) const uint DIRECT = 0;
//@ paths.roulette on off|on
/// Russian roulette after paths.roulette_start bounces. Off: every path goes on to max_bounces; less noise per sample, more time.
layout(constant_id = 104) const uint ROULETTE = 1;
//@ material.diffuse lambert lambert|burley
/// Diffuse lobe: Lambert, as glTF appendix B, or Burley 2012 with its retro-reflection.
layout(constant_id = 105) const uint DIFFUSE_MODEL = 0;
//@ material.energy_compensation on off|on
/// Returns the energy that single-scattering GGX loses at high roughness. Off is the plain glTF appendix B model.
layout(constant_id = 106) const uint ENERGY_COMPENSATION = 1;
//@ textures.level cone cone|zero
/// Texture level of detail: by ray cones, which follow the footprint of a path, or always the finest, which only many samples filter.
layout(constant_id = 107) const uint TEXTURE_LEVEL = 0;
//@ paths.scramble pixel pixel|tile
/// What has a sample sequence of its own, where pixels take one sample a frame: each pixel, or each tile of 16x16, whose pixels share out one sequence. By tile, what a filter averages over neighbours converges like a sequence, not like chance; the same cost.
layout(constant_id = 108) const uint SCRAMBLE = 0;
//@ paths.kernel megakernel megakernel|wavefront
/// Whole paths in one kernel, or a kernel for each step of all paths, with queues between them (Laine et al. 2013). The same picture; wavefront holds 196 bytes per pixel (288 for filters), and pays where rays and materials diverge on wide devices. Paths that hpsf.time=hybrid traces again and those that anhpsf continues are the megakernel's.
layout(constant_id = 109) const uint PATHS_KERNEL = 0;
//@ lights.sole sampled sampled|apart
/// A scene's only point, spot or directional light, where the camera sees what it shines on: one among the lights that shadow rays are sent to by chance, or with a shadow ray of its own, whose light has no noise and goes past all filters. Apart: sharp shadows in the first frame, and less noise of the other lights; one more ray per pixel. Not in nhpsf and anhpsf, whose vertices share cells.
layout(constant_id = 110) const uint LIGHTS_SOLE = 0;
//@ paths.albedo apart apart|divided
/// Albedo at the filter vertex: kept apart and multiplied in after filters, or multiplied in while tracing, divided out for filters (by 0.001 at least), multiplied again. Divided loses channels of zero albedo and precision (Meijer, section 4.1).
layout(constant_id = 120) const uint ALBEDO = 0;
//@ accumulate.sum compensated compensated|plain
/// Sum over frames: two words, the second for what rounding has lost, or one. Plain moves 32 bytes per pixel less (16 at fp16), and drifts over many frames.
layout(constant_id = 121) const uint SUM = 0;
//@ frame.precision fp32 fp32|fp16
/// Images and histories, those of hpsf's cells too, other than positions, motion and identities. fp16 halves their bytes; rounds to 11 bits, and clamps at 65504. Cells are rounded at random, so that means of thousands of frames neither stall nor drift.
layout(constant_id = 122) const uint PRECISION = 0;
//@ frame.jitter off off|on
/// Primary rays of techniques for real time go through the pixel's centre, or through a point of it that changes with every frame, the same in all pixels. On is antialiasing where frames add up, and trembling edges where each stands alone. No cost.
layout(constant_id = 123) const uint JITTER = 0;
//@ hpsf.sums fixed fixed|float
/// Sums of cells: fixed point of 64 bits, the same picture in every run, or float atomics, where the device offers them; fewer bytes.
layout(constant_id = 130) const uint HPSF_SUMS = 0;
//@ hpsf.table persistent persistent|swapped
/// One table that keeps cells until they are evicted, or two that change places with every frame: only cells touched in the last frame are known.
layout(constant_id = 131) const uint HPSF_TABLE = 0;
//@ hpsf.time integrate frame|average|integrate|hybrid|detect
/// What a cell knows: this frame's samples, an exponential moving average, the mean over up to hpsf.samples samples, or that mean as far back as the light was the same. Hybrid traces some paths of the last frame again: one for each square of hpsf.retrace pixels a side. Detect takes for a change what is too far from the mean for chance; no ray, and no change found that is less than the noise.
layout(constant_id = 132) const uint HPSF_TIME = 2;
//@ hpsf.normals key key|fingerprint|similar
/// Quantised normals are part of both hashes, or of the fingerprint alone, so that all normals of one place are near each other in the table. Similar: the latter, and cells with fewer samples than hpsf.few take in those at their place whose normals are no more than hpsf.similar away; less noise on curved surfaces, and flatter shading.
layout(constant_id = 133) const uint HPSF_NORMALS = 0;
//@ hpsf.jitter_by hash hash|sampler
/// Numbers that jitter positions and normals: independent, or of the path's sample sequence.
layout(constant_id = 134) const uint HPSF_JITTER_BY = 0;
//@ hpsf.neighbours off off|on
/// Cells with fewer samples than hpsf.few take in the eight cells around them. Less noise at rims, a little blur; lookups where it happens.
layout(constant_id = 135) const uint HPSF_NEIGHBOURS = 0;
//@ hpsf.seed on off|on
/// New cells begin with what cells of the neighbouring levels know, when the camera has moved. Off: they begin with nothing.
layout(constant_id = 136) const uint HPSF_SEED = 1;
//@ hpsf.keys fingerprint fingerprint|exact
/// What tells the table's keys apart: a hash of 32 bits, or 64 bits that hold all of the key where insertion is not ordered. Exact never takes one cell for another; 4 bytes more a cell (8 swapped), and another word read with each that matches.
layout(constant_id = 138) const uint HPSF_KEYS = 0;
//@ hpsf.insertion first first|ordered
/// Which keys get slots where a table is full: those that come first, or those that a fixed order prefers, the same in every run. Ordered costs a pass over pixels, and leaves fingerprints 20 bits.
layout(constant_id = 139) const uint HPSF_INSERTION = 0;
//@ hpsf.eviction age age|priority
/// Cells leave the table when no sample has touched them for hpsf.age frames; by priority, also before, where new ones find no slot: those of few samples and long untouched first. Insertion is ordered then. Costs another pass over pixels.
layout(constant_id = 140) const uint HPSF_EVICTION = 0;
//@ hpsf.blend off off|on
/// Size of cells between two powers of two: rounded down, which shows where it changes, or of either at random, the nearer the likelier. On needs nearly twice as many cells, each with fewer samples.
layout(constant_id = 145) const uint HPSF_BLEND = 0;
//@ hpsf.temporal off off|on
/// Pictures of earlier frames, moved by motion vectors, are averaged with this one: antialiasing with frame.jitter, less noise in what is not filtered; lag. Costs a primary ray and a pass.
layout(constant_id = 137) const uint HPSF_TEMPORAL = 0;
//@ hpsf.vertex first first|second|third
/// Which of a path's diffuse vertices is filtered. Second resembles final gathering (Binder, fig. 10): no borders or lost shadows in what is seen, whose own light stays as noisy as the path found it. No cost.
layout(constant_id = 150) const uint HPSF_VERTEX = 0;
//@ hpsf.second trace trace|cells
/// What arrives at a path's second diffuse vertex: it is traced, or read from what a table of its own knows of it, of this frame and earlier ones, as nhpsf reads its vertices (nhpsf.vertices, nhpsf.wider). Cells leave half of the variance of indirect light, and take away a quarter of the rays; light that changes comes late, so paths are traced where lights or objects move.
layout(constant_id = 162) const uint HPSF_SECOND = 0;
//@ nhpsf.form balanced balanced|paper
/// What a vertex sends to the one before: what its cell knows, in nhpsf of the last frame, or that and what the path itself has found there (Meijer, section 4.3), by which all indirect light counts twice. The same rays.
layout(constant_id = 151) const uint NHPSF_FORM = 0;
//@ nhpsf.distance camera camera|path
/// By what the cells of vertices behind the first one grow: their distance from the camera, so that they share the cells of the picture, or the length of the path, so that they have wider ones. No cost.
layout(constant_id = 152) const uint NHPSF_DISTANCE = 0;
//@ nhpsf.unknown trace trace|dark
/// Where no cell knows the vertex that a path would end at: it goes on as without a filter, or nothing comes from there, so that depth grows with frames alone. Trace costs whole paths in the first frame, and where the camera shows what is new.
layout(constant_id = 153) const uint NHPSF_UNKNOWN = 0;
//@ hpsf.split off off|on
/// Direct and indirect light share a table, or have one each, and are smoothed apart. On keeps shadows sharp where indirect light is smooth and noisy; costs the table's passes and bytes once more.
layout(constant_id = 160) const uint HPSF_SPLIT = 0;
//@ hpsf.glossy off off|on
/// What glossy lobes reflect at the first filter vertex is averaged in cells, too, a table of their own, told apart by where the path comes from; rough metals are filter vertices then, in mirrors, too. Where a texture gives the colour, cells are of like colours. Not lobes of a single direction, as mirrors and smooth coats have. Less noise over frames, blurrier reflections; costs the table's passes and bytes once more. Their keys are fingerprints, whatever hpsf.keys says.
layout(constant_id = 161) const uint HPSF_GLOSSY = 0;

//@ anhpsf.transport last last|all
/// Between which cells of a continued path light travels in a frame: from its newest vertex to the one before, or from each to the one before (Meijer, section 7). All: light from deep comes sooner; 64 bytes and as many lookups for each bounce of paths.max_bounces. Where things move: the last.
layout(constant_id = 154) const uint ANHPSF_TRANSPORT = 0;
//@ anhpsf.choice deepest deepest|importance
/// Which path a pixel continues: its own until it is as deep as paths.max_bounces, or at each new vertex that one or this frame's, with a chance by what another sample is worth to their cells: more where these are bright, pass much on, or have few samples. Importance goes with anhpsf.transport=last; two lookups, and no frame without a scattered ray.
layout(constant_id = 155) const uint ANHPSF_CHOICE = 0;

struct Parameters {
    //@ paths.max_bounces 8 0..64 bounces
    /// Scattering events after the primary hit; 0 is direct light and emission only. Each adds a scatter and a shadow ray.
    uint max_bounces;
    //@ paths.roulette_start 3 0..64 bounces
    /// First bounce at which Russian roulette may end a path.
    uint roulette_start;
    //@ rays.first_shadow_rays 1 1..64 rays
    /// Shadow rays at the primary hit; every later vertex sends one. More: less noise of direct light, at a ray and a BSDF each.
    uint first_shadow_rays;
    //@ lights.candidates 16 1..64 lights
    /// Lights drawn by power for each shadow ray, which goes to one of them in proportion to what it would bring unshadowed; at most one for
    /// every four lights of the scene. More: less noise where many lights are near some surfaces and far from others; each costs a BSDF.
    uint light_candidates;
    //@ paths.per_submission 2097152 1..4294967295 paths
    /// Paths that the device is asked for at once, but at least one for each pixel: frames of more samples are submitted in shares. The same picture; fewer cost a little, tell progress sooner, and are safer from drivers that end what takes them seconds.
    uint paths_per_submission;
    //@ paths.clamp 0 0..1000000 W/(sr*m^2)
    /// Largest radiance that one indirect contribution may carry; 0: no clamp. Darkens, and removes fireflies.
    float clamp_radiance;
    //@ paths.regularize 0 0..1 roughness
    /// Least roughness of what a path meets behind its first diffuse vertex, but for mirrors and glass (Kaplanyan and Dachsbacher 2013); 0: none. More: caustics blur and lose their fireflies, where filters would make spots of these.
    float regularized_roughness;
    //@ textures.lod_bias 0 -8..8 levels
    /// Added to the ray-cone level of detail of every texture. Negative is sharper and noisier.
    float lod_bias;
    //@ sspsf.window 9 1..31 pixels
    /// Edge of the square window that sspsf averages over. Wider: less noise, blurrier shadows; cost grows with its square.
    uint sspsf_window;
    //@ sspsf.reach 1 0.1..16
    /// How far apart in the world sspsf takes two vertices for similar, in half windows as large as they appear at the vertex.
    float sspsf_reach;
    //@ sspsf.angle 30 1..180 degrees
    /// Largest angle between the normals of vertices that sspsf takes for similar. Smaller keeps the shading of curved surfaces, and more noise.
    float sspsf_angle;
    //@ hpsf.width 16 1..256 pixels
    /// Width of a cell as it appears on the screen; rounded down to a power of two in the world. Wider: less noise, blurrier shadows.
    float hpsf_width;
    //@ hpsf.jitter 0.6 0..4 cells
    /// Positions are moved by up to so much in the tangent plane. 0: none, cells show their borders; more: blur and noise instead.
    float hpsf_jitter;
    //@ hpsf.normal_bits 2 0..8 bits
    /// Cells are told apart by normals quantised to so many bits. More keep the shading of curved surfaces, and more noise.
    uint hpsf_normal_bits;
    //@ hpsf.normal_jitter 0 0..2 cells
    /// Normals are tilted by up to so much of their quantisation.
    float hpsf_normal_jitter;
    //@ hpsf.incident_bits 6 0..8 bits
    /// With hpsf.glossy, cells of glossy lobes are told apart by the direction that paths arrive from, quantised to so many bits. More keep what changes with the view, and more noise.
    uint hpsf_incident_bits;
    //@ hpsf.glossy_finer 2 0..4
    /// And are so many powers of two narrower for each half of roughness. More: sharper highlights of smooth surfaces, and more noise.
    float hpsf_glossy_finer;
    //@ hpsf.similar 30 1..180 degrees
    /// Largest angle between a normal and the middle of another cell's normals, for hpsf.normals=similar. 180: all normals of a place.
    float hpsf_similar;
    //@ hpsf.lookups 1 0..8 cells
    /// Cells that a pixel's radiance is the mean of, each found by a jitter of its own; 0: the cell that the pixel's sample went to. More remove the jitter's noise, at one lookup each.
    uint hpsf_lookups;
    //@ hpsf.iterations 1 1..4
    /// How often the radiance is filtered: each time after the first, what pixels have got goes through cells of this frame alone, with other jitters. More: smoother and wider, where there is hpsf.jitter. Each costs the table's passes over pixels and slots once more; more than one, whatever their number, 20 bytes a cell and 16 a pixel. 1: no cost.
    uint hpsf_iterations;
    //@ hpsf.levels 2 1..4 levels
    /// Resolutions that samples are added to, each twice as coarse as the one before; cells with few samples are looked up coarser. One insertion each.
    uint hpsf_levels;
    //@ hpsf.few 8 0..100000 samples
    /// Fewer samples than this make a cell look for help: at the coarser level, or at its neighbours.
    uint hpsf_few;
    //@ hpsf.probes 8 1..64 slots
    /// Slots that may hold a key. More fail more rarely in a full table; reads of neighbouring words.
    uint hpsf_probes;
    //@ hpsf.cells 1 0.001..8 cells per pixel
    /// Size of the table, 52 bytes a cell (36 with float sums; 72 and 56 swapped). Where it is too small, pixels go unfiltered.
    float hpsf_cells;
    //@ hpsf.shrink 0 0..0.5
    /// Cells are frames^-shrink as wide after so many frames of a still camera. Where time is integrated, pictures converge to the truth; with less than 0.5, cells have ever more samples all the same. More noise in the frames before.
    float hpsf_shrink;
    //@ hpsf.adaptive 0 0..100 standard deviations
    /// Coarser cells stand for the finer ones that they are made of, as long as these differ by no more than their noise and so much of its spread; 0: finer cells stand where they have hpsf.few samples. More: less noise, blurrier shadows. Eight lookups for each level.
    float hpsf_adaptive;
    //@ hpsf.retrace 4 1..16 pixels
    /// Side of the squares of which one path is traced again in the next frame, where hpsf.time is hybrid. Smaller: finer borders between what is forgotten and what is kept; 1 / side^2 of the rays more.
    uint hpsf_retrace;
    //@ hpsf.retraced_few 4 1..1000 paths
    /// Where fewer retraced paths tell of a cell, the next coarser one speaks for it. More: less forgotten by chance, blurrier borders.
    uint hpsf_retraced_few;
    //@ hpsf.adapt 0.5 0..100
    /// How readily hybrid and detect forget where light changes: mean over standard deviation of a sample, as it is taken to be. More: less lag, more noise; 0: never.
    float hpsf_adapt;
    //@ hpsf.alpha 0.9 0..1
    /// Weight of the past where hpsf.time is average. More: less noise, more lag.
    float hpsf_alpha;
    //@ hpsf.samples 65536 1..16777215 samples
    /// Samples of the past that count at most where hpsf.time is integrate. Fewer follow changes sooner, and leave more noise.
    uint hpsf_samples;
    //@ hpsf.recency 0 0..16
    /// Where hpsf.time is integrate: how much more later frames count, as a power of their number. Cells that know of each other's light (nhpsf) forget sooner what they did not know at first; 0.3 times the variance more at 1, 0.8 at 2.
    float hpsf_recency;
    //@ hpsf.age 8 0..254 frames
    /// A persistent table evicts cells that no sample has touched for longer. 0: unless touched in every frame.
    uint hpsf_age;
    //@ hpsf.seed_weight 0.25 0..1
    /// How much a coarser cell's samples count when a finer one begins. More: less noise when coming nearer; coarse cells show longer.
    float hpsf_seed_weight;
    //@ hpsf.largest 65536 1..1000000000 W/(sr*m^2)
    /// Largest radiance of a sample that enters a cell; it takes a share of 2^-40 as the unit of fixed point.
    float hpsf_largest;
    //@ hpsf.limit 0 0..1000000
    /// A sample adds no more than so many times what its cell knows from hpsf.few samples; 0: no limit. Removes fireflies; darkens, and light that fewer samples find fades.
    float hpsf_limit;
    //@ hpsf.smooth 0 0..5 passes
    /// Passes of an edge-avoiding filter over the screen, each twice as wide as the one before, for what cells leave as noise; with hpsf.split, of direct light alone. More blur shadows; 25 taps each.
    uint hpsf_smooth;
    //@ hpsf.smooth_indirect 0 0..5 passes
    /// The same for indirect light where hpsf.split is on.
    uint hpsf_smooth_indirect;
    //@ hpsf.smooth_specular 0 0..5 passes
    /// The same for what other lobes than the diffuse one reflect at the filter vertex, which no cell averages. More blur glossy reflections.
    uint hpsf_smooth_specular;
    //@ hpsf.smooth_reach 2 0.01..16 pixels
    /// How far from a vertex's tangent plane that filter takes others for similar, as large as a pixel appears there.
    float hpsf_smooth_reach;
    //@ hpsf.smooth_angle 60 1..180 degrees
    /// Largest angle between the normals of vertices that it takes for similar.
    float hpsf_smooth_angle;
    //@ hpsf.smooth_blind 2 1..5 passes
    /// How many of these passes take little account of colour while samples are few. More: less noise, and less light lost with bright samples that nothing around resembles; blurrier shadows in the first frames.
    uint hpsf_smooth_blind;
    //@ hpsf.smooth_indirect_blind 3 1..5 passes
    /// The same for indirect light.
    uint hpsf_smooth_indirect_blind;
    //@ hpsf.smooth_specular_blind 3 1..5 passes
    /// The same for what other lobes reflect.
    uint hpsf_smooth_specular_blind;
    //@ hpsf.smooth_few 4 0..10000 samples
    /// In those passes a mean over n samples counts as so much over n times noisier than it seems, for few samples say little about how noisy they are.
    float hpsf_smooth_few;
    //@ hpsf.smooth_indirect_few 64 0..10000 samples
    /// The same for indirect light.
    float hpsf_smooth_indirect_few;
    //@ hpsf.smooth_specular_few 8 0..10000 samples
    /// The same for what other lobes reflect.
    float hpsf_smooth_specular_few;
    //@ hpsf.smooth_noise 1.6 0.01..1000 standard deviations
    /// Largest difference that the later of these passes take for noise. More: less noise, blurrier shadows.
    float hpsf_smooth_noise;
    //@ nhpsf.vertices 2 1..16 vertices
    /// Diffuse vertices of a path whose samples enter cells; one more is only looked up. More fill hidden cells and bring light from farther in a frame, at a shadow ray, a scattered ray and 48 bytes each. 1: cells out of view are unknown. At most paths.max_bounces.
    uint nhpsf_vertices;
    //@ nhpsf.wider 0 0..8 levels
    /// Cells of the vertices behind the first one are so many powers of two wider. More: less noise, more light from around corners.
    uint nhpsf_wider;
    //@ temporal.frames 64 1..1000
    /// Frames that count at most where hpsf.temporal is on. Fewer follow changes sooner, and leave more noise.
    float temporal_frames;
    //@ temporal.clamp 0 0..100
    /// Where lights or objects move, history is kept within so many standard deviations of what surrounds the pixel now; 0: not. Less is less lag, and loses light that few samples find.
    float temporal_clamp;
    //@ temporal.moving 4 1..1000
    /// In place of temporal.frames where lights or objects move. Fewer: less lag, less antialiasing.
    float temporal_moving;
};

#endif
