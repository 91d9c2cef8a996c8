// Where a path has ended at a filter vertex that it has not looked for light at: 48 bytes, from which it can be continued.
#ifndef PATHS_END_GLSL
#define PATHS_END_GLSL

#include "accel/ray.glsl"
#include "lib/ray_cone.glsl"

struct PathEnd {
    /// The way it has arrived, unit.
    vec3 direction;
    /// Vertices before this one; ~0 where the path has ended elsewhere.
    uint vertex;
    RayCone cone;
    /// Metres.
    float travelled;
    Hit hit;
};

#endif
