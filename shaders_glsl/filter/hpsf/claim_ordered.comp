// hpsf, slots for the keys of the pixels' vertices that are new in this frame: filter/hpsf/claim_ordered.glsl.
#include "filter/hpsf/claim_ordered.glsl"
#include "filter/hpsf/pixel_point.glsl"
