// What a scene calls for (src/scene/effects.rs decides, and says why): a specialization constant each, so that what is not called for
// costs nothing.
#ifndef SHARED_EFFECTS_GLSL
#define SHARED_EFFECTS_GLSL

layout(constant_id = 0) const bool EFFECT_GLOSSY = true;
layout(constant_id = 1) const bool EFFECT_MIRROR = true;
layout(constant_id = 2) const bool EFFECT_SMOOTH_TRANSMISSION = true;
layout(constant_id = 3) const bool EFFECT_ROUGH_TRANSMISSION = true;
layout(constant_id = 4) const bool EFFECT_CLEARCOAT = true;
layout(constant_id = 5) const bool EFFECT_TEXTURES = true;
layout(constant_id = 6) const bool EFFECT_NORMAL_MAPS = true;
layout(constant_id = 7) const bool EFFECT_ALPHA_MASK = true;
layout(constant_id = 8) const bool EFFECT_ALPHA_BLEND = true;
layout(constant_id = 9) const bool EFFECT_PUNCTUAL_LIGHT = true;
layout(constant_id = 10) const bool EFFECT_SPHERE_LIGHT = true;
layout(constant_id = 11) const bool EFFECT_EMISSIVE_LIGHT = true;
layout(constant_id = 12) const bool EFFECT_ENVIRONMENT_LIGHT = true;
layout(constant_id = 13) const bool EFFECT_CAMERA_ANIMATION = true;
layout(constant_id = 14) const bool EFFECT_OBJECT_ANIMATION = true;
layout(constant_id = 15) const bool EFFECT_UNLIT = true;
layout(constant_id = 16) const bool EFFECT_VERTEX_COLORS = true;
layout(constant_id = 17) const bool EFFECT_SOLE_LIGHT = true;

#endif
