// nhpsf, slots for the keys of vertices behind the first one that are new in this frame: filter/hpsf/claim_ordered.glsl.
#include "filter/hpsf/claim_ordered.glsl"
#include "filter/nhpsf/vertex_point.glsl"
