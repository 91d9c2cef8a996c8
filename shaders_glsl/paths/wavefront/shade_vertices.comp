// paths/wavefront/shade.glsl, the terms apart, with lists of filter vertices.
#extension GL_KHR_shader_subgroup_ballot : require
#define SEPARATE_TERMS
#define SHARED_JITTER
#define VERTEX_LIST
#include "paths/wavefront/shade.glsl"
