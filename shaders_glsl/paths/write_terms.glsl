// Puts a pixel's terms out, to images that the kernel declares in front of it.
#ifndef PATHS_WRITE_TERMS_GLSL
#define PATHS_WRITE_TERMS_GLSL

#include "lib/layer.glsl"
#include "lib/packing.glsl"
#include "paths/primary.glsl"
#include "paths/terms.glsl"

void write_terms(uvec2 at, Terms terms) {
    ivec2 pixel = ivec2(at);
    imageStore(before, pixel, finite_or_black(terms.before));
    imageStore(attenuation, pixel, finite_or_black(terms.attenuation));
    vec4 direct = finite_or_black(received(terms.diffuse_direct, terms.attenuation));
    // A vertex without a diffuse lobe has no sample for the cells of others.
    imageStore(diffuse_direct, pixel, has_diffuse_lobe(terms.vertex.layer) ? direct : vec4(0.0));
    imageStore(diffuse_indirect, pixel, finite_or_black(received(terms.diffuse_indirect, terms.attenuation)));
    imageStore(specular_direct, pixel, finite_or_black(terms.specular_direct));
    imageStore(specular_indirect, pixel, finite_or_black(terms.specular_indirect));
    FilterVertex vertex = terms.vertex;
    imageStore(filter_position, pixel, vec4(vertex.position, view_plane_distance(primary_ray(at, frame.jitter), frame.camera, vertex.travelled)));
    imageStore(filter_normal, pixel, uvec4(vertex.travelled > 0.0 ? pack_normal(vertex.normal) : 0u));
    imageStore(filter_incident, pixel, uvec4(vertex.travelled > 0.0 ? pack_normal(vertex.incident) : 0u));
    imageStore(filter_layer, pixel, uvec4(vertex.layer));
}

#endif
