// How large a pixel is in the world.
#ifndef FILTER_FOOTPRINT_GLSL
#define FILTER_FOOTPRINT_GLSL

#include "shared/bindings.glsl"

/// Height of a pixel at a view-plane distance, metres.
float pixel_footprint(float distance) {
    float at_one = 2.0 * length(frame.camera.up) / float(frame.extent.y);
    return frame.camera.projection == 0u ? at_one : at_one * distance;
}

#endif
