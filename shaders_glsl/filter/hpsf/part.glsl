// Which part of the light behind the filter vertex a table is about (hpsf.split). The kernel has images `diffuse_direct` and `diffuse_indirect`.
#ifndef FILTER_HPSF_PART_GLSL
#define FILTER_HPSF_PART_GLSL

const uint PART_DIRECT = 1u;
const uint PART_INDIRECT = 2u;

/// 0: all of it.
layout(constant_id = 231) const uint PART = 0;

/// A pixel's own sample; w is 0 where it is not a number, in whatever part: a path that meets infinite radiance counts for neither.
vec4 own_sample(ivec2 pixel) {
    vec4 direct = imageLoad(diffuse_direct, pixel);
    vec4 indirect = imageLoad(diffuse_indirect, pixel);
    vec3 part = direct.rgb + indirect.rgb;
    if (PART != 0u) {
        part = PART == PART_DIRECT ? direct.rgb : indirect.rgb;
    }
    return vec4(part, direct.w * indirect.w);
}

#endif
