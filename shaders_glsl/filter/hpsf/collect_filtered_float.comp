// hpsf, what pixels have been filtered to into cells once more, summed by float atomics: filter/hpsf/collect.glsl.
#extension GL_EXT_shader_atomic_float : require
#include "filter/hpsf/collect.glsl"
#include "filter/hpsf/filtered_sample.glsl"
#include "filter/hpsf/sums_float.glsl"
