// paths/wavefront/shade.glsl, the terms apart.
#extension GL_KHR_shader_subgroup_ballot : require
#define SEPARATE_TERMS
#define SHARED_JITTER
#include "paths/wavefront/shade.glsl"
