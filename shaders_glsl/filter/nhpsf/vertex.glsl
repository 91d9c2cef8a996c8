// A vertex of a path's list (paths/vertices.glsl) as a point to be filtered.
//
// nhpsf.distance decides what its cell's width is as large as: what would be hpsf.width pixels at the end of the path so far (Meijer, section
// 4.2.2), or at its own distance from the camera. By the camera's distance a place has one level, whoever comes there: vertices behind the
// first one and those of the picture share their cells, and what comes into view has been filled before.
#ifndef FILTER_NHPSF_VERTEX_GLSL
#define FILTER_NHPSF_VERTEX_GLSL

#include "filter/hpsf/cell.glsl"

const uint DISTANCE_CAMERA = 0u;

/// View-plane distance, of what is not in view at least that of the picture's corners; metres.
float camera_distance(vec3 from_camera, float corner_cosine) {
    return max(dot(from_camera, frame.camera.forward), length(from_camera) * corner_cosine);
}

/// `place`: position, and view-plane distance of the path.
FilterPoint vertex_point(uvec2 pixel, vec4 place, uint normal, uint incident) {
    FilterPoint point = filter_point(pixel, place, normal, incident);
    if (NHPSF_DISTANCE == DISTANCE_CAMERA) {
        vec3 right = frame.camera.right;
        vec3 up = frame.camera.up;
        float corner_cosine = inversesqrt(1.0 + dot(right, right) + dot(up, up));
        vec3 from_camera = point.position - frame.camera.position;
        point.distance = camera_distance(from_camera, corner_cosine);
        bool in_view = dot(from_camera, frame.camera.forward) >= point.distance;
        point.away = in_view ? frame.camera.forward : normalize(from_camera) * corner_cosine;
    }
    return point;
}

/// Of the list's vertex `index`, counted from 0: other numbers than any pixel's.
vec4 vertex_numbers(uvec2 pixel, uint index) {
    return jitter_numbers(pixel + uvec2(0u, (index + 1u) * frame.extent.y), 0u);
}

#endif
