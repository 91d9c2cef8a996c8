// paths/megakernel_vertices.glsl, and where its paths can be continued: at the last vertex of a list, which is only looked up.
#define KEEP_ENDS
#include "paths/megakernel_vertices.glsl"
#include "paths/end.glsl"

layout(set = 1, binding = 15, scalar) writeonly buffer Ends { PathEnd at[]; } ends;

void keep_end(uvec2 pixel, Path path, Hit hit, Terms terms) {
    bool at_list_end = list_ends(terms) && path.filter_vertex == path.vertex;
    uint vertex = at_list_end ? path.vertex : NO_VERTEX;
    ends.at[pixel.y * frame.extent.x + pixel.x] = PathEnd(path.ray.direction, vertex, path.cone, path.travelled, hit);
}
