// Each pixel's sample: what its filter vertex receives.
#include "filter/hpsf/pixel_point.glsl"

layout(set = 1, binding = 13, COLOR_FORMAT) readonly uniform image2D direct;
layout(set = 1, binding = 14, COLOR_FORMAT) readonly uniform image2D indirect;

#include "filter/hpsf/part.glsl"

bool find_sample(out CellSample one) {
    if (!find_point(one.at)) {
        return false;
    }
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    vec4 own = own_sample(pixel);
    one.radiance = own.rgb;
    one.dither = unit_float(pcg3d(uvec3(pixel, frame.first_sample ^ frame.seed)).z);
    return own.w != 0.0;
}
