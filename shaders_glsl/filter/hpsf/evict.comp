// hpsf, slots of untouched cells for the keys of the pixels' vertices: filter/hpsf/evict.glsl.
#include "filter/hpsf/evict.glsl"
#include "filter/hpsf/pixel_point.glsl"
