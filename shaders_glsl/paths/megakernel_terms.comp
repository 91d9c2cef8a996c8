// Path tracing, one path per pixel through the g-buffer's point, the terms apart: paths/terms.glsl.
#define SEPARATE_TERMS
#define SHARED_JITTER
#include "paths/megakernel.glsl"
#include "paths/terms_output.glsl"

layout(local_size_x = 32) in;

void write_pixel(uvec2 pixel, Terms terms, uint samples, uvec2 counts) {
    write_terms_and_rays(pixel, terms, counts);
}

void main() {
    trace_pixels(gl_WorkGroupID.x, gl_LocalInvocationIndex);
}
