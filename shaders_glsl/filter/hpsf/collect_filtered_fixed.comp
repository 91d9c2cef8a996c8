// hpsf, what pixels have been filtered to into cells once more, summed in fixed point: filter/hpsf/collect.glsl.
#include "filter/hpsf/collect.glsl"
#include "filter/hpsf/filtered_sample.glsl"
#include "filter/hpsf/sums_fixed.glsl"
