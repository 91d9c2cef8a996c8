// As megakernel_terms.comp; and traces some of the last frame's paths once more, with the same numbers, in the scene as it is now. What has
// not moved gives the same radiance, bit for bit; what is different is a change of the light, without the noise of other numbers
// (Binder, section 3.4.1; Schied et al. 2018).
//
// Retraced paths are more places for the same kernel, in workgroups of their own behind the picture's: the one traversal call site serves
// them, no launch waits for them, and both traces of a path are the same instructions, without which bits would differ.
//
// A retraced path begins at the last frame's camera, not at its filter vertex: that costs one more ray, and nothing has to be kept but
// 32 bytes, where a vertex would take its hit, view direction, footprint, throughput and attenuation; mirrors and glass in front of it are
// looked through again. The camera may move: what has changed is a property of the place, whoever sees it.
#define SEPARATE_TERMS
#define SHARED_JITTER
#define RETRACES
#include "lib/colour.glsl"
#include "paths/megakernel.glsl"

layout(local_size_x = 32) in;

layout(set = 1, binding = 0, COLOR_FORMAT) writeonly uniform image2D before;
layout(set = 1, binding = 1, COLOR_FORMAT) writeonly uniform image2D attenuation;
layout(set = 1, binding = 2, COLOR_FORMAT) writeonly uniform image2D diffuse_direct;
layout(set = 1, binding = 3, COLOR_FORMAT) writeonly uniform image2D diffuse_indirect;
layout(set = 1, binding = 4, COLOR_FORMAT) writeonly uniform image2D specular_direct;
layout(set = 1, binding = 5, COLOR_FORMAT) writeonly uniform image2D specular_indirect;
layout(set = 1, binding = 6, r32ui) writeonly uniform uimage2D ray_count;
/// Position relative to the frame's origin, metres; w: view-plane distance of the path up to it, 0 where there is no filter vertex.
layout(set = 1, binding = 7, rgba32f) writeonly uniform image2D filter_position;
/// Shading normal and the way the path arrives (lib/packing.glsl).
layout(set = 1, binding = 8, r32ui) writeonly uniform uimage2D filter_normal;
layout(set = 1, binding = 9, r32ui) writeonly uniform uimage2D filter_incident;
/// Where the specular terms may be filtered (lib/layer.glsl); else 0.
layout(set = 1, binding = 13, r32ui) writeonly uniform uimage2D filter_layer;
layout(set = 1, binding = 10, scalar) writeonly buffer KeptPaths { Kept at[]; } kept;
layout(set = 1, binding = 11, scalar) writeonly buffer RetracedPaths { Retraced at[]; } retraced;
/// As ray_count, of the retraced paths: their pixels are those of a smaller picture.
layout(set = 1, binding = 12, r32ui) writeonly uniform uimage2D retraced_ray_count;

#include "paths/write_terms.glsl"

Kept kept_path(Terms terms, Ray from_camera, Camera camera) {
    // Filters see what an image of the frame's precision gives back.
    vec3 diffuse = stored(received(terms.diffuse_direct, terms.attenuation)) + stored(received(terms.diffuse_indirect, terms.attenuation));
    vec3 specular = terms.vertex.layer == 0u ? vec3(0.0) : stored(terms.specular_direct) + stored(terms.specular_indirect);
    float distance = view_plane_distance(from_camera, camera, terms.vertex.travelled);
    vec3 past_cells = terms.before + (terms.vertex.layer == 0u ? terms.specular_direct + terms.specular_indirect : vec3(0.0));
    uint unfiltered = pcg3d(floatBitsToUint(past_cells)).x;
    return all_finite(diffuse + specular) ? Kept(diffuse, distance, specular, unfiltered) : Kept(vec3(0.0), 0.0, vec3(0.0), 0u);
}

void write_retraced(uvec2 square, Terms terms, uvec2 counts) {
    uvec2 pixel = retraced_pixel(square, frame.first_sample - 1u);
    Ray from_camera = camera_ray(frame.previous_camera, pixel, frame.previous_jitter);
    Kept now = kept_path(terms, from_camera, frame.previous_camera);
    FilterVertex vertex = terms.vertex;
    uvec2 directions = now.distance > 0.0 ? uvec2(pack_normal(vertex.normal), pack_normal(vertex.incident)) : uvec2(0u);
    retraced.at[retraced_index(square)] = Retraced(now, vertex.position, directions.x, directions.y, vertex.layer);
    imageStore(retraced_ray_count, ivec2(square), uvec4(pack_counts(counts)));
}

void write_pixel(uvec2 at, Terms terms, uint samples, uvec2 counts) {
    if (field_of(gl_WorkGroupID.x).retraced) {
        write_retraced(at, terms, counts);
        return;
    }
    write_terms(at, terms);
    imageStore(ray_count, ivec2(at), uvec4(pack_counts(counts)));
    uvec2 square = at / parameters.hpsf_retrace;
    if (at == retraced_pixel(square, frame.first_sample)) {
        kept.at[retraced_index(square)] = kept_path(terms, primary_ray(at, frame.jitter), frame.camera);
    }
}

void main() {
    trace_pixels(gl_WorkGroupID.x, gl_LocalInvocationIndex);
}
