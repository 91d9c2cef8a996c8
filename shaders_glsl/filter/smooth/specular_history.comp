// filter/smooth/specular.glsl for pictures that are means over frames.
#include "display/history.glsl"
#include "filter/smooth/specular.glsl"

float frames_seen(ivec2 pixel) {
    float depth = depth_at(pixel);
    return 1.0 + history_of(pixel, imageLoad(motion, pixel), depth, depth).w;
}
