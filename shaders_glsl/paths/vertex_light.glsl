// What the vertices of lists receive (paths/vertices.glsl), and where a list's vertices lie.
#ifndef PATHS_VERTEX_LIGHT_GLSL
#define PATHS_VERTEX_LIGHT_GLSL

#include "shared/bindings.glsl"

struct ReceivedLight {
    vec3 radiance;
    /// Bits of the way that the path arrives.
    uint incident;
};

/// Of a pixel's vertex `index`, in each of the buffers.
uint place_in_list(uint pixel, uint index) {
    return index * frame.extent.x * frame.extent.y + pixel;
}

#endif
