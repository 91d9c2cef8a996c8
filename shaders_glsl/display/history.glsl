// What earlier frames know of the point that a pixel sees: the means that display/temporal.comp keeps, moved to where the point is now.
#ifndef DISPLAY_HISTORY_GLSL
#define DISPLAY_HISTORY_GLSL

#include "shared/bindings.glsl"

/// Pixels, to where the point was; z: change of its depth, metres; w: 1 where it was in front of the camera.
layout(set = 1, binding = 1, rgba32f) readonly uniform image2D motion;
/// w: distance, negative for a miss.
layout(set = 1, binding = 2, rgba32f) readonly uniform image2D position;
/// rgb: mean; w: frames that it is over.
layout(set = 1, binding = 3, COLOR_FORMAT) readonly uniform image2D known;
/// Along the view, metres.
layout(set = 1, binding = 4, r32f) readonly uniform image2D known_depth;

/// What was not hit is as far as motion vectors take it to be (paths/gbuffer.comp).
const float MISS = 1e6;
/// Of the depth, by which two frames may disagree about a surface.
const float TOLERANCE = 0.05;
/// Pixels; motion below it is rounding, and would blur a still picture.
const float STILL = 1e-2;

float depth_at(ivec2 pixel) {
    vec4 point = imageLoad(position, pixel);
    return point.w < 0.0 ? MISS : dot(point.xyz - frame.camera.position, frame.camera.forward);
}

/// Mean (rgb) and frames (w) of what earlier frames know of the point: bilinear, of the texels whose depth fits; w is 0 where none does.
vec4 history_at(vec2 place, float nearest, float farthest) {
    vec2 corner = floor(place);
    vec2 part = place - corner;
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int i = 0; i < 4; i++) {
        ivec2 tap = ivec2(i & 1, i >> 1);
        ivec2 texel = ivec2(corner) + tap;
        if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(frame.extent)))) {
            continue;
        }
        float depth = imageLoad(known_depth, texel).x;
        vec4 value = imageLoad(known, texel);
        vec2 share = mix(1.0 - part, part, equal(tap, ivec2(1)));
        bool fits = depth > nearest * (1.0 - TOLERANCE) && depth < farthest * (1.0 + TOLERANCE) && value.w > 0.0;
        float weight = fits ? share.x * share.y : 0.0;
        sum += weight * value;
        weights += weight;
    }
    return weights > 0.0 ? sum / weights : vec4(0.0);
}

/// The same of the point that a pixel sees, `moved` being its motion, where depths around it now are from `nearest` to `farthest`.
vec4 history_of(ivec2 pixel, vec4 moved, float nearest, float farthest) {
    if (!(moved.w > 0.0)) {
        return vec4(0.0);
    }
    vec2 step = dot(moved.xy, moved.xy) > STILL * STILL ? moved.xy : vec2(0.0);
    return history_at(vec2(pixel) + step, nearest + moved.z, farthest + moved.z);
}

#endif
