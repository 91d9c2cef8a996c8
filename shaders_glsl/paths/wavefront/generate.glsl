// Wavefront path tracing, first stage: each pixel's path at the camera, and its terms at zero.
#include "lib/elements.glsl"
#include "paths/wavefront/append.glsl"
#include "paths/wavefront/state.glsl"

layout(local_size_x = QUEUE_GROUP) in;

layout(set = 1, binding = 1, scalar) readonly buffer SampleNumber { uint number; } sample_number;
layout(set = 1, binding = 2, scalar) writeonly buffer Queue { uint at[]; } queue;
layout(set = 1, binding = 3, scalar) writeonly buffer Rays { StoredRay at[]; } rays;
layout(set = 1, binding = 4, scalar) writeonly buffer Weights { StoredWeights at[]; } weights;
layout(set = 1, binding = 5, scalar) writeonly buffer Footprints { StoredFootprint at[]; } footprints;
layout(set = 1, binding = 6, scalar) writeonly buffer Front { StoredFront at[]; } front;
layout(set = 1, binding = 7, r32ui) writeonly uniform uimage2D ray_count;
#ifdef SEPARATE_TERMS
layout(set = 1, binding = 8, scalar) writeonly buffer Direct { StoredLobes at[]; } direct;
layout(set = 1, binding = 9, scalar) writeonly buffer Indirect { StoredLobes at[]; } indirect;
layout(set = 1, binding = 10, scalar) writeonly buffer Vertices { StoredVertex at[]; } vertices;
#endif
#ifdef VERTEX_LIST
layout(set = 1, binding = 22, COLOR_FORMAT) writeonly uniform image2D specular_attenuation;
layout(set = 1, binding = 23, r32ui) writeonly uniform uimage2D path_vertices;
#endif

void clear_pixel(uint slot, ivec2 pixel) {
    imageStore(ray_count, pixel, uvec4(0u));
    front.at[slot] = StoredFront(vec3(0.0), vec3(0.0));
#ifdef SEPARATE_TERMS
    direct.at[slot] = StoredLobes(vec3(0.0), vec3(0.0));
    indirect.at[slot] = StoredLobes(vec3(0.0), vec3(0.0));
    vertices.at[slot] = StoredVertex(vec3(0.0), 0.0, vec3(0.0), vec3(0.0), 0u);
#endif
#ifdef VERTEX_LIST
    imageStore(specular_attenuation, pixel, finite_or_black(vec3(0.0)));
    imageStore(path_vertices, pixel, uvec4(0u));
#endif
}

void main() {
    uint slot = element_index();
    uvec2 pixel = pixel_of_slot(slot);
    bool begins = all(lessThan(pixel, frame.extent)) && sample_number.number < samples_of(pixel);
    if (begins) {
        Path path = path_begin(pixel, frame.first_sample + sample_number.number);
        rays.at[slot] = stored_ray(path);
        weights.at[slot] = stored_weights(path);
        footprints.at[slot] = stored_footprint(path);
        if (sample_number.number == 0u) {
            clear_pixel(slot, ivec2(pixel));
        } else {
            front.at[slot].attenuation = vec3(0.0);
        }
    }
    uint place = append(paths_of(0u), begins);
    if (begins) {
        queue.at[place] = slot;
    }
}
