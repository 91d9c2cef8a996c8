// nhpsf, samples of the vertices behind the first one into cells, summed in fixed point: filter/hpsf/collect.glsl.
#include "filter/hpsf/collect.glsl"
#include "filter/nhpsf/vertex_sample.glsl"
#include "filter/hpsf/sums_fixed.glsl"
