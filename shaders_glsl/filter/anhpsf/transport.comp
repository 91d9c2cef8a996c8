// What the vertices of a continued path's chain receive, those that are complete: filter/nhpsf/transport.comp, for cells alone. With
// anhpsf.transport = all the chain is all of the path (Meijer, section 7), so that a frame takes light from each of its cells to the one
// before; else it is the last vertex that is complete and the one behind it.
//
// The thesis' form (nhpsf.form = paper) takes every vertex for complete.
//
// Measured on cornell, 32 frames, 128x72, mean radiance over that of 32 bounces, for paths of 2, 4, 8, 16 bounces: path tracing 0.950, 0.987, 0.999,
// 1.000. Here 0.99 or more each: cells pass on what they know, so depth adds nothing to the picture but vertices (Meijer's figure 16 brightens
// with depth). The thesis' form 0.95, 0.96, 0.96, 0.97, as vertices that have their direct light alone pull the mean down; between all cells
// 0.99, 1.13, 1.41, 2.02, as each vertex sends again what those behind it send.
#include "filter/nhpsf/known.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, r32ui) readonly uniform uimage2D chain_vertices;
layout(set = 1, binding = 1, r32ui) uniform uimage2D chain_samples;
layout(set = 1, binding = 2, scalar) readonly buffer ChainPlaces { vec4 at[]; } chain_places;
layout(set = 1, binding = 3, scalar) readonly buffer ChainLinks { uvec4 at[]; } chain_links;
layout(set = 1, binding = 4, scalar) readonly buffer ChainLight { uvec4 at[]; } chain_light;
/// What enters cells, and the bits of the way that the path arrives.
layout(set = 1, binding = 5, scalar) writeonly buffer SampleLight { uvec4 at[]; } sample_light;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), frame.extent))) {
        return;
    }
    uint pixels = frame.extent.x * frame.extent.y;
    uint place = uint(pixel.y) * frame.extent.x + uint(pixel.x);
    uint vertices = imageLoad(chain_vertices, pixel).x;
    if (NHPSF_FORM == FORM_PAPER) {
        imageStore(chain_samples, pixel, uvec4(vertices));
    }
    vec3 arrives = vec3(0.0);
    for (uint index = vertices; index-- > 0u;) {
        uint at = index * pixels + place;
        uvec4 link = chain_links.at[at];
        uvec4 light = chain_light.at[at];
        vec3 received = uintBitsToFloat(light.xyz) + arrives;
        sample_light.at[at] = uvec4(floatBitsToUint(received), light.w);
        FilterPoint point = vertex_point(uvec2(pixel), chain_places.at[at], link.w, light.w);
        arrives = uintBitsToFloat(link.xyz) * sent_by(known_at(point, vertex_numbers(uvec2(pixel), index)), received);
    }
}
