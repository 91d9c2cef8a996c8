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

/// Pixel of a thread of 32 in a tile; tiles of 8x4 pixels go along the rows of the picture.
uvec2 pixel_in_tile(uint tile, uint thread) {
    uint tiles = (frame.extent.x + 7u) / 8u;
    return uvec2(tile % tiles, tile / tiles) * uvec2(8u, 4u) + uvec2(thread % 8u, thread / 8u);
}

/// How far a camera without mirrors would see a vertex, measured along its view: reflections keep the angle between a ray and the view
/// direction that they mirror along with it. `travelled`: length of the path of the pixel's centre, metres.
float view_plane_distance(uvec2 pixel, float travelled) {
    return travelled * dot(primary_ray(pixel, frame.jitter).direction, frame.camera.forward);
}

#endif
