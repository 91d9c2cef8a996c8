// Wavefront path tracing, last stage: the mean of each pixel's samples.
#include "lib/elements.glsl"
#include "paths/path.glsl"
#include "paths/wavefront/records.glsl"

layout(local_size_x = 64) in;

layout(set = 1, binding = 0, COLOR_FORMAT) writeonly uniform image2D radiance;
layout(set = 1, binding = 1, scalar) readonly buffer Front { StoredFront at[]; } front;

void main() {
    uint slot = element_index();
    uvec2 pixel = pixel_of_slot(slot);
    if (all(lessThan(pixel, frame.extent))) {
        imageStore(radiance, ivec2(pixel), finite_or_black(front.at[slot].before / float(samples_of(pixel))));
    }
}
