// nhpsf, slots of untouched cells for the keys of vertices behind the first one: filter/hpsf/evict.glsl.
#include "filter/hpsf/evict.glsl"
#include "filter/nhpsf/vertex_point.glsl"
