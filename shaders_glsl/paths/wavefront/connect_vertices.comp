// paths/wavefront/connect.glsl, the terms apart, with lists of filter vertices.
#define SEPARATE_TERMS
#define SHARED_JITTER
#define VERTEX_LIST
#include "paths/wavefront/connect.glsl"
