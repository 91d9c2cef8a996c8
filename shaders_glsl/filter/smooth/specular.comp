// filter/smooth/specular.glsl for frames that stand alone.
#include "filter/smooth/specular.glsl"

float frames_seen(ivec2 pixel) {
    return 1.0;
}
