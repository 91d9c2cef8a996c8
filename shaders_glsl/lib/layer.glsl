// Layers of a material that are filtered apart: Binder, section 3.1.2. The diffuse lobe is layer 0, all other lobes of a material together are
// another: its low 8 bits are left to the direction that a path arrives from, 4 hold a class of roughness, one tells metals, the rest the
// material. Unlike the diffuse lobe's, their colour cannot be taken out of their radiance, so that no two materials share a cell, nor do two
// colours of a texture, or of what mirrors and glass in front leave of one: square roots are quantised, to 7 bits.
#ifndef LIB_LAYER_GLSL
#define LIB_LAYER_GLSL

#include "lib/rng.glsl"

const float ROUGHNESS_CLASSES = 8.0;

const uint NO_DIFFUSE_LOBE = 1u << 31;

/// What tells a material whose radiance has the factor `colour`, 0..2, from others, where that is not white.
uint coloured(uint material, vec3 colour) {
    uvec3 q = uvec3(sqrt(clamp(colour, 0.0, 2.0) / 2.0) * 127.0 + 0.5);
    return colour == vec3(1.0) ? material : material ^ pcg_hash(q.r | q.g << 7 | q.b << 14);
}

/// `roughness`: glTF's, 0..1.
uint glossy_layer(uint material, float roughness, bool is_diffuse) {
    uint roughness_class = uint(min(roughness * ROUGHNESS_CLASSES, ROUGHNESS_CLASSES - 1.0)) + 1u;
    return (material << 12 | roughness_class << 8) & ~NO_DIFFUSE_LOBE | (is_diffuse ? 0u : NO_DIFFUSE_LOBE);
}

/// A vertex whose specular terms are filtered in this layer has diffuse ones, too.
bool has_diffuse_lobe(uint layer) {
    return (layer & NO_DIFFUSE_LOBE) == 0u;
}

/// The middle of a layer's class.
float roughness_of(uint layer) {
    return (float(layer >> 8 & 0xfu) - 0.5) / ROUGHNESS_CLASSES;
}

#endif
