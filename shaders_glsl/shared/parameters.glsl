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
//@ paths.albedo apart apart|divided
/// Albedo at the filter vertex: kept apart and multiplied in after filters, or multiplied in while tracing, divided out for filters (by 0.001 at least), multiplied again. Divided loses channels of zero albedo and precision (Meijer, section 4.1).
layout(constant_id = 120) const uint ALBEDO = 0;
//@ accumulate.sum compensated compensated|plain
/// Sum over frames: two words, the second for what rounding has lost, or one. Plain moves 32 bytes per pixel less (16 at fp16), and drifts over many frames.
layout(constant_id = 121) const uint SUM = 0;
//@ frame.precision fp32 fp32|fp16
/// Images and histories, other than positions, motion and identities. fp16 halves their bytes; rounds to 11 bits, and clamps at 65504.
layout(constant_id = 122) const uint PRECISION = 0;

struct Parameters {
    //@ paths.max_bounces 8 0..64 bounces
    /// Scattering events after the primary hit; 0 is direct light and emission only. Each adds a scatter and a shadow ray.
    uint max_bounces;
    //@ paths.roulette_start 3 0..64 bounces
    /// First bounce at which Russian roulette may end a path.
    uint roulette_start;
    //@ rays.first_shadow_rays 1 1..16 rays
    /// Shadow rays at the primary hit; every later vertex sends one.
    uint first_shadow_rays;
    //@ lights.candidates 16 1..64 lights
    /// Lights drawn by power for each shadow ray, which goes to one of them in proportion to what it would bring unshadowed; at most one for
    /// every four lights of the scene. More: less noise where many lights are near some surfaces and far from others; each costs a BSDF.
    uint light_candidates;
    //@ paths.clamp 0 0..1000000 W/(sr*m^2)
    /// Largest radiance that one indirect contribution may carry; 0: no clamp. Darkens, and removes fireflies.
    float clamp_radiance;
    //@ textures.lod_bias 0 -8..8 levels
    /// Added to the ray-cone level of detail of every texture. Negative is sharper and noisier.
    float lod_bias;
};

#endif
