// paths/wavefront/generate.glsl, the terms apart, with lists of filter vertices.
#extension GL_KHR_shader_subgroup_ballot : require
#define SEPARATE_TERMS
#define SHARED_JITTER
#define VERTEX_LIST
#include "paths/wavefront/generate.glsl"
