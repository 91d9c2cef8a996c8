// hpsf, samples of pixels into cells, summed in fixed point: filter/hpsf/collect.glsl.
#include "filter/hpsf/collect.glsl"
#include "filter/hpsf/pixel_sample.glsl"
#include "filter/hpsf/sums_fixed.glsl"
