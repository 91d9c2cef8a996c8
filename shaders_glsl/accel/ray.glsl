#ifndef ACCEL_RAY_GLSL
#define ACCEL_RAY_GLSL

/// World space, relative to the frame's origin. `direction` is unit; distances in metres.
struct Ray {
    vec3 origin;
    float t_min;
    vec3 direction;
    float t_max;
};

/// Barycentrics weigh vertices 1 and 2. After a miss nothing but the return value means anything.
struct Hit {
    float t;
    uint instance;
    uint primitive;
    vec2 barycentrics;
};

#endif
