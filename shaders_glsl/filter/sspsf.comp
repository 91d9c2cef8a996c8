// Screen-space path space filtering: the radiance behind the filter vertex, averaged over a window of pixels whose vertices are similar.
// Meijer, section 4.1: 9x9 pixels; similar by world position, normal and the flag that there is a filter vertex. Albedo is not part of
// what is averaged, so that texture keeps its detail, and a channel of albedo 0 loses nothing.
//
// Deviations and why: the thesis leaves the weights open. Here they fall linearly with the angle between the normals, to 0 at
// sspsf.angle, and with the squared distance in the world, to 0 where half a window would reach seen from the vertex: pixels that see one
// surface from the front all count, those behind an edge do not, and no weight needs an exponential.
#include "filter/footprint.glsl"
#include "filter/similar.glsl"
#include "lib/packing.glsl"
#include "lib/storage.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, COLOR_FORMAT) readonly uniform image2D diffuse_direct;
layout(set = 1, binding = 1, COLOR_FORMAT) readonly uniform image2D diffuse_indirect;
/// w: view-plane distance; 0 where there is no filter vertex.
layout(set = 1, binding = 2, rgba32f) readonly uniform image2D filter_position;
layout(set = 1, binding = 3, r32ui) readonly uniform uimage2D filter_normal;
layout(set = 1, binding = 4, COLOR_FORMAT) writeonly uniform image2D diffuse;

vec3 normal_at(ivec2 pixel) {
    return unpack_normal(imageLoad(filter_normal, pixel).x);
}

/// rgb: radiance; w: 0 where the sample is not a number.
vec4 sample_at(ivec2 pixel) {
    vec4 direct = imageLoad(diffuse_direct, pixel);
    vec4 indirect = imageLoad(diffuse_indirect, pixel);
    return vec4(direct.rgb + indirect.rgb, direct.w * indirect.w);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 extent = ivec2(frame.extent);
    if (any(greaterThanEqual(pixel, extent))) {
        return;
    }
    vec4 centre = imageLoad(filter_position, pixel);
    if (!(centre.w > 0.0)) {
        imageStore(diffuse, pixel, vec4(0.0));
        return;
    }
    vec3 normal = normal_at(pixel);
    int half_window = int(parameters.sspsf_window) / 2;
    float reach = parameters.sspsf_reach * (float(half_window) + 0.5) * pixel_footprint(centre.w);
    float least_cosine = cos(radians(parameters.sspsf_angle));
    vec4 sum = vec4(0.0);
    ivec2 low = max(pixel - half_window, 0);
    ivec2 high = min(pixel + half_window, extent - 1);
    for (int y = low.y; y <= high.y; y++) {
        for (int x = low.x; x <= high.x; x++) {
            ivec2 other = ivec2(x, y);
            vec4 position = imageLoad(filter_position, other);
            vec3 offset = (position.xyz - centre.xyz) / reach;
            float near = 1.0 - dot(offset, offset);
            float aligned = alignment(normal_at(other), normal, least_cosine);
            vec4 value = sample_at(other);
            float weight = position.w > 0.0 ? max(near, 0.0) * aligned * value.w : 0.0;
            sum += weight * vec4(value.rgb, 1.0);
        }
    }
    imageStore(diffuse, pixel, storable(vec4(sum.w > 0.0 ? sum.rgb / sum.w : vec3(0.0), sum.w)));
}
