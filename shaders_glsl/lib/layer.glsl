// Layers of a material that are filtered apart: Binder, section 3.1.2. The diffuse lobe is layer 0, all other lobes of a material together are
// another: its low 8 bits are left to the direction that a path arrives from, 4 hold a class of roughness, one tells metals, the rest the
// material. Unlike the diffuse lobe's, their colour cannot be taken out of their radiance, so that no two materials share a cell.
#ifndef LIB_LAYER_GLSL
#define LIB_LAYER_GLSL

const float ROUGHNESS_CLASSES = 8.0;

const uint NO_DIFFUSE_LOBE = 1u << 31;

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
