// paths/wavefront/generate.glsl, the terms summed up.
#extension GL_KHR_shader_subgroup_ballot : require
#include "paths/wavefront/generate.glsl"
