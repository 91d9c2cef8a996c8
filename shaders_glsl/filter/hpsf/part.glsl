// The part of the light behind the filter vertex that a table is about. The kernel has images `direct` and `indirect`, of the diffuse lobe, or
// of the others where that part is glossy.
//
// Glossy lobes (hpsf.glossy; Binder, section 3.1.2): keys also hold the material, its roughness and the direction that the path arrives from
// (lib/layer.glsl), and cells are the narrower the smoother the surface is (chapter 4 asks for finer quantisation there). What is averaged is
// what the lobes reflect, their colour included, and that of mirrors and glass in front, which nothing divides out; so where a texture gives
// the colour, or the path has passed anything, keys also hold the colour, quantised: cells share samples of like colours alone, and where those
// are few, the coarser cell helps out. Lobes are left alone where one of them has a single direction. A metal that qualifies is a filter
// vertex without a diffuse sample.
//
// Deviations and why: layers have a table each instead of sharing one, since each is looked up when its own sums are complete; the layer is part of
// the key all the same. Exact keys have no bits left for it: fingerprints tell glossy ones apart.
//
// Measured on FlightHelmet, whose lobes all have textures, under a sky (128x72, 16 frames): FLIP 0.0519, relMSE 0.0116 without the worst 0.1 % of the
// pixels; where painted lobes are left alone 0.0535 and 0.0153, without glossy cells 0.0615 and 0.0295.
// On material-glossy (128x72, three seeds, against 1024 samples): after 16 frames FLIP 0.150, relMSE 0.109, without 0.178 and 0.217; of
// that, 0.172 and 0.179 are there without the metals. After one frame 0.259 and 0.51, without 0.263 and 0.42 (0.223 and 0.231 without the
// worst 0.1 % of the pixels): cells of a few samples spread a firefly, and what a metal shows of diffuse cells is as noisy as the
// path found it. With a still camera hpsf.incident_bits of 0, 6 and 8 hardly differ; hpsf.glossy_finer of 0, 1, 2, without metals: 0.184, 0.184 and
// 0.179.
#ifndef FILTER_HPSF_PART_GLSL
#define FILTER_HPSF_PART_GLSL

#include "filter/hpsf/table.glsl"

/// A pixel's own sample; w is 0 where it is not a number, in whatever part: a path that meets infinite radiance counts for neither.
vec4 own_sample(ivec2 pixel) {
    vec4 a = imageLoad(direct, pixel);
    vec4 b = imageLoad(indirect, pixel);
    vec3 part = a.rgb + b.rgb;
    if (PART == PART_DIRECT || PART == PART_INDIRECT) {
        part = PART == PART_DIRECT ? a.rgb : b.rgb;
    }
    return vec4(part, a.w * b.w);
}

#endif
