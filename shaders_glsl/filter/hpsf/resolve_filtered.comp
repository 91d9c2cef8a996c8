// Looks up what each pixel's filtered radiance is when it is filtered again: filter/hpsf/iteration.glsl.
#include "filter/hpsf/pixel_point.glsl"
#include "lib/storage.glsl"

layout(set = 1, binding = 0, COLOR_FORMAT) readonly uniform image2D filtered;
layout(set = 1, binding = 5, scalar) readonly buffer Keys { uint at[]; } keys;
layout(set = 1, binding = 6, scalar) readonly buffer Cells { CELL_WORDS at[]; } cells;
/// w: as it was, more than what is left, since means that share samples do not tell by how much their mean is better.
layout(set = 1, binding = 7, COLOR_FORMAT) writeonly uniform image2D mean;

#include "filter/hpsf/look_up.glsl"

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), frame.extent))) {
        return;
    }
    vec4 next = imageLoad(filtered, pixel);
    CellPoint at;
    if (find_point(at)) {
        Known known = known_of(at.point, uvec2(pixel));
        next.rgb = known.cells > 0u ? known.mean : next.rgb;
    }
    imageStore(mean, pixel, storable(next));
}
