// Rays that leave the camera.
#ifndef PATHS_PRIMARY_GLSL
#define PATHS_PRIMARY_GLSL

#include "shared/bindings.glsl"
#include "accel/ray.glsl"
#include "lib/constants.glsl"
#include "lib/ray_cone.glsl"

/// Through a point of a camera's image; `offset` in -1/2..1/2 from the pixel's centre.
Ray camera_ray(Camera camera, uvec2 pixel, vec2 offset) {
    vec2 ndc = (vec2(pixel) + 0.5 + offset) / vec2(frame.extent) * 2.0 - 1.0;
    vec3 on_plane = ndc.x * camera.right - ndc.y * camera.up;
    if (camera.projection == 0u) {
        return Ray(camera.position + on_plane, 0.0, camera.forward, FAR_AWAY);
    }
    return Ray(camera.position, 0.0, normalize(camera.forward + on_plane), FAR_AWAY);
}

Ray primary_ray(uvec2 pixel, vec2 offset) {
    return camera_ray(frame.camera, pixel, offset);
}

RayCone camera_cone(Camera camera) {
    return RayCone(camera.pixel_width, camera.pixel_spread);
}

/// Pixel of a thread of 32 in a tile; tiles of 8x4 pixels go along the rows of a picture of `width` pixels, at least 1.
uvec2 pixel_in_tile(uint width, uint tile, uint thread) {
    uint tiles = (width + 7u) / 8u;
    return uvec2(tile % tiles, tile / tiles) * uvec2(8u, 4u) + uvec2(thread % 8u, thread / 8u);
}

/// How far a camera without mirrors would see a vertex, measured along its view: reflections keep the angle between a ray and the view
/// direction that they mirror along with it. `travelled`: length of the path of this ray, metres.
float view_plane_distance(Ray from_camera, Camera camera, float travelled) {
    return travelled * dot(from_camera.direction, camera.forward);
}

#endif
