// Each pixel's sample where it is filtered again (filter/hpsf/iteration.glsl): what its own has been filtered to.
#include "filter/hpsf/pixel_point.glsl"

layout(set = 1, binding = 13, COLOR_FORMAT) readonly uniform image2D filtered;

bool find_sample(out CellSample one) {
    if (!find_point(one.at)) {
        return false;
    }
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    vec4 own = imageLoad(filtered, pixel);
    one.radiance = own.rgb;
    one.dither = unit_float(pcg3d(uvec3(pixel, (frame.first_sample ^ frame.seed) + ITERATION)).z);
    return own.w >= 0.0;
}
