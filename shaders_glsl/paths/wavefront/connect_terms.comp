// paths/wavefront/connect.glsl, the terms apart.
#define SEPARATE_TERMS
#define SHARED_JITTER
#include "paths/wavefront/connect.glsl"
