// hpsf, samples of pixels into cells, summed by float atomics: filter/hpsf/collect.glsl.
#extension GL_EXT_shader_atomic_float : require
#include "filter/hpsf/collect.glsl"
#include "filter/hpsf/pixel_sample.glsl"
#include "filter/hpsf/sums_float.glsl"
