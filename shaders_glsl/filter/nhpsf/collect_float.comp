// nhpsf, samples of the vertices behind the first one into cells, summed by float atomics: filter/hpsf/collect.glsl.
#extension GL_EXT_shader_atomic_float : require
#include "filter/hpsf/collect.glsl"
#include "filter/nhpsf/vertex_sample.glsl"
#include "filter/hpsf/sums_float.glsl"
