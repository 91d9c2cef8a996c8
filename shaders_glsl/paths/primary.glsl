// Rays that leave the camera.
#ifndef PATHS_PRIMARY_GLSL
#define PATHS_PRIMARY_GLSL

#include "shared/bindings.glsl"
#include "accel/ray.glsl"
#include "lib/constants.glsl"
#include "lib/ray_cone.glsl"

/// Through a point of the image; `offset` in -1/2..1/2 from the pixel's centre.
Ray primary_ray(uvec2 pixel, vec2 offset) {
    vec2 ndc = (vec2(pixel) + 0.5 + offset) / vec2(frame.extent) * 2.0 - 1.0;
    vec3 on_plane = ndc.x * frame.camera.right - ndc.y * frame.camera.up;
    if (frame.camera.projection == 0u) {
        return Ray(frame.camera.position + on_plane, 0.0, frame.camera.forward, FAR_AWAY);
    }
    return Ray(frame.camera.position, 0.0, normalize(frame.camera.forward + on_plane), FAR_AWAY);
}

RayCone primary_cone() {
    return RayCone(frame.camera.pixel_width, frame.camera.pixel_spread);
}

#endif
