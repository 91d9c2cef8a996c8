// What the vertices of a path send to the ones before them, by what cells know of them: Meijer, section 4.3.
//
// The list (paths/vertices.glsl) is worked off from its end. With R_k what vertex k receives and C_k what its cell knows of that,
//
//   balanced   R_k = radiance_k + attenuation_(k+1) C_(k+1), or with R_(k+1) in place of it where nothing is known
//   paper      R_k = radiance_k + attenuation_(k+1) (R_(k+1) + C_(k+1))
//
// and R_k then enters the cell of k. In operators, with D the direct light that a vertex receives and T the transport from what all
// vertices receive to one of them, the balanced table goes to the solution of C = D + T C, the path tracer's sum D + T D + T^2 D + ...: a
// frame adds one bounce to what is known. What counts as D enters R_k alone, and what a cell knows is sent alone, so nothing is there
// twice. Where a list would end at a vertex that no cell knows, the path goes on as the path tracer's (nhpsf.unknown), so that the first
// frame, and what comes into view, is no darker.
//
// Deviations and why: the thesis adds the cell's radiance to what the path itself has found behind the vertex. That light is in the cell, too:
// C = D + T (D + C) has the solution C + T C, the right one and all indirect light once more, and with longer lists each vertex doubles what
// those behind it send. It is what makes the thesis' pictures too bright and fills its shadows, which have no other light than this (5.3,
// 6). There, the last vertex enters its cell with direct light alone; where that is also a cell of the picture's, it takes away some
// of the surplus, and where it is not, the cell knows of no indirect light. Here what the ray from there hits is looked up, too, so
// that every sample that enters a cell is complete.
//
// Where the table is of vertices behind the first one alone (hpsf.second), that one sends when they have entered it, in a dispatch of its own
// (SENDS without RECEIVES), and so what all paths of this frame have found, too. In the first frame there is nothing else: FLIP of hpsf+
// 0.0462 for 0.0496 on cornell, 0.135 for 0.149 on Sponza (256x144); 2 % of a frame's time.
//
// Measured on cornell, 32 frames, mean radiance over that of 32 bounces: cells of two vertices 1.00 as is; with the thesis' form 1.004 where
// cells are apart (nhpsf.wider=3, hpsf.levels=1), which is D + 2 T D = 1.008 and not D + T D = 0.897, the light of its two vertices; 0.96
// where they share cells. With 4, 8, 16 vertices 1.00 each; the thesis' form 1.33, 2.10, 3.02.
// Depth is that of the frames, not that of the lists (Meijer, figure 16, which is of paths continued over frames): where a list ends in the
// dark and not in a path (nhpsf.unknown), 32 frames with 2, 4, 8, 16 vertices reach 0.981, 0.988, 0.995, 0.998. relMSE does not depend
// on it (0.0011 each), and is about that of hpsf (256x144: 0.0013, 0.0012; the hall at 128x72 after 16 frames: 0.037, 0.043), with 2.5
// rays per pixel for 3.4.
#include "filter/nhpsf/known.glsl"
#include "lib/colour.glsl"
#include "lib/storage.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, COLOR_FORMAT) uniform image2D diffuse_indirect;
layout(set = 1, binding = 1, COLOR_FORMAT) uniform image2D specular_indirect;
layout(set = 1, binding = 2, COLOR_FORMAT) readonly uniform image2D specular_attenuation;
layout(set = 1, binding = 3, r32ui) readonly uniform uimage2D path_vertices;
layout(set = 1, binding = 4, scalar) readonly buffer VertexPlaces { vec4 at[]; } vertex_places;
layout(set = 1, binding = 5, scalar) readonly buffer VertexLinks { uvec4 at[]; } vertex_links;
layout(set = 1, binding = 6, scalar) buffer VertexLight { uvec4 at[]; } vertex_light;

/// Whether vertices receive what those behind them send, and whether the first one sends to the pixel's.
layout(constant_id = 207) const bool RECEIVES = true;
layout(constant_id = 208) const bool SENDS = true;

void add_to(ivec2 pixel, vec3 diffuse, vec3 specular) {
    vec4 before = imageLoad(diffuse_indirect, pixel);
    bool finite = before.w > 0.0 && all_finite(diffuse);
    imageStore(diffuse_indirect, pixel, storable(finite ? vec4(before.rgb + diffuse, 1.0) : vec4(0.0)));
    if (all_finite(specular)) {
        imageStore(specular_indirect, pixel, storable(imageLoad(specular_indirect, pixel) + vec4(specular, 0.0)));
    }
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), frame.extent))) {
        return;
    }
    uint pixels = frame.extent.x * frame.extent.y;
    uint place = uint(pixel.y) * frame.extent.x + uint(pixel.x);
    uint vertices = imageLoad(path_vertices, pixel).x;
    vec3 arrives = vec3(0.0);
    vec3 sent = vec3(0.0);
    for (uint index = RECEIVES ? vertices : min(vertices, 1u); index-- > 0u;) {
        uint at = index * pixels + place;
        uvec4 link = vertex_links.at[at];
        uvec4 light = vertex_light.at[at];
        vec3 received = uintBitsToFloat(light.xyz) + arrives;
        if (RECEIVES) {
            vertex_light.at[at] = uvec4(floatBitsToUint(received), light.w);
        }
        if (SENDS || index > 0u) {
            FilterPoint point = vertex_point(uvec2(pixel), vertex_places.at[at], link.w, light.w);
            sent = sent_by(known_at(point, vertex_numbers(uvec2(pixel), index)), received);
            arrives = uintBitsToFloat(link.xyz) * sent;
        }
    }
    if (SENDS) {
        add_to(pixel, arrives, imageLoad(specular_attenuation, pixel).rgb * sent);
    }
}
