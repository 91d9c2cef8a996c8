// paths/wavefront/generate.glsl, the terms apart.
#extension GL_KHR_shader_subgroup_ballot : require
#define SEPARATE_TERMS
#define SHARED_JITTER
#include "paths/wavefront/generate.glsl"
