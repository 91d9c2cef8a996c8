// The sample of a vertex behind a path's first one: what it receives, when filter/nhpsf/transport.comp has added what comes from behind.
#include "filter/nhpsf/vertex_point.glsl"

bool find_sample(out CellSample one) {
    if (!find_point(one.at)) {
        return false;
    }
    uint place = element_index();
    one.radiance = uintBitsToFloat(vertex_light.at[place].xyz);
    one.dither = unit_float(pcg3d(uvec3(place, 1u, frame.first_sample ^ frame.seed)).z);
    return true;
}
