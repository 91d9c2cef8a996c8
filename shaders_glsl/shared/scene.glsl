// The scene as shaders see it. Scalar layout everywhere; the host's structs are generated from this file when built.
// Addresses are buffer device addresses, 0 where there is nothing, as two words: SwiftShader has no 64-bit integers. The host sees u64.

#ifndef SHARED_SCENE_GLSL
#define SHARED_SCENE_GLSL

#define Address uvec2
/// Whether an address points at anything.
#define HAS(address) any(notEqual(address, uvec2(0)))

/// One mesh: one bottom-level structure.
struct Mesh {
    /// vec3 per vertex, mesh space, metres.
    Address positions;
    /// VertexAttributes per vertex.
    Address attributes;
    /// vec2 per vertex, or 0.
    Address uv1;
    /// u16x4 (RGBA, unorm) per vertex, linear, or 0.
    Address colors;
    /// uvec3 per triangle.
    Address triangles;
    /// uint per triangle: index into materials.
    Address triangle_materials;
    /// uint per triangle: its rank among the mesh's emissive triangles, ~0u where it emits nothing; 0 if none emits.
    Address triangle_emitters;
};

/// 16 bytes.
struct VertexAttributes {
    /// Octahedral, snorm 16x2 (lib/packing.glsl).
    uint normal;
    /// Octahedral, snorm 16 + 15 bits, handedness in bit 31; 0 where the mesh has no tangents.
    uint tangent;
    vec2 uv0;
};

/// A mesh placed in the world. Matrices are affine, three rows of four, relative to the frame's origin.
struct Instance {
    vec4 object_to_world[3];
    vec4 world_to_object[3];
    /// The last frame's, in this frame's origin.
    vec4 previous_object_to_world[3];
    uint mesh;
    /// Index of the light of the instance's first emissive triangle; ~0u if none emits.
    uint first_light;
    /// INSTANCE_* bits.
    uint flags;
    uint padding;
};

/// The instance's transform mirrors: its front faces are clockwise.
const uint INSTANCE_MIRRORED = 1u;
/// Some triangle needs its alpha looked up.
const uint INSTANCE_ALPHA = 2u;

/// A texture as a material uses it: 32 bytes.
struct TextureSlot {
    /// Index into the texture array, ~0u: none. Bit 31: second UV set.
    uint texture;
    /// log2 of the texture's edge in texels, half of log2(width * height): for ray-cone level of detail.
    float log2_size;
    /// uv' = transform[0..2] . (u, v, 1), transform[3..5] . (u, v, 1).
    float transform[6];
};

struct Material {
    vec4 base_color;
    /// Radiance.
    vec3 emission;
    float metallic;
    float roughness;
    float normal_scale;
    float ior;
    float specular;
    vec3 specular_color;
    float transmission;
    /// 1 / metres of -ln(attenuation colour); zero: no absorption.
    vec3 absorption;
    /// 0: thin-walled.
    float thickness;
    float clearcoat;
    float clearcoat_roughness;
    float alpha_cutoff;
    /// MATERIAL_* bits.
    uint flags;
    TextureSlot base_color_texture;
    TextureSlot metallic_roughness_texture;
    TextureSlot normal_texture;
    TextureSlot emission_texture;
    TextureSlot specular_texture;
    TextureSlot specular_color_texture;
    TextureSlot transmission_texture;
    TextureSlot clearcoat_texture;
    TextureSlot clearcoat_roughness_texture;
    TextureSlot clearcoat_normal_texture;
};

const uint MATERIAL_ALPHA_MASK = 1u;
const uint MATERIAL_ALPHA_BLEND = 2u;
const uint MATERIAL_DOUBLE_SIDED = 4u;
const uint MATERIAL_UNLIT = 8u;
const uint MATERIAL_EMISSIVE = 16u;

/// One light to choose from: 16 bytes, for there may be as many as triangles.
struct Light {
    /// LIGHT_* kind.
    uint kind;
    /// Probability of being chosen.
    float probability;
    /// Emissive triangle: instance and its primitive.
    uint instance;
    uint primitive;
};

/// What else there is to a light that is neither a triangle nor the environment. Such come first, so that both have one index.
struct PunctualLight {
    /// Radiance (sphere), W/sr (point, spot), W/m^2 (directional).
    vec3 emission;
    /// Metres; 0: a point.
    float radius;
    /// World, relative to the frame's origin.
    vec3 position;
    /// 1 / metres; 0: unlimited (KHR_lights_punctual's range window).
    float inverse_range;
    /// The way the light shines, unit.
    vec3 direction;
    /// Spot: attenuation = clamp(cos * cone_scale + cone_offset, 0, 1)^2.
    float cone_scale;
    float cone_offset;
};

const uint LIGHT_TRIANGLE = 0u;
const uint LIGHT_POINT = 1u;
const uint LIGHT_SPHERE = 2u;
const uint LIGHT_SPOT = 3u;
const uint LIGHT_DIRECTIONAL = 4u;
const uint LIGHT_ENVIRONMENT = 5u;

/// One bucket of Walker's alias method: keep the bucket's own index where u < threshold, else take alias.
struct AliasEntry {
    float threshold;
    uint alias;
};

struct Camera {
    /// Relative to the frame's origin.
    vec3 position;
    /// 0: orthographic, 1: perspective.
    uint projection;
    /// Half the image's width along x, at distance 1 (perspective) or in metres (orthographic).
    vec3 right;
    /// Angle that a pixel spans vertically, radians; 0: orthographic.
    float pixel_spread;
    /// Half the image's height along +y.
    vec3 up;
    /// Width that a pixel spans at the camera, metres; 0: perspective.
    float pixel_width;
    /// Unit, the way the camera looks.
    vec3 forward;
    uint padding;
};

/// What every shader may read: one uniform buffer per frame in flight, set 0 binding 0.
struct FrameData {
    Address meshes;
    Address instances;
    Address materials;
    Address lights;
    Address punctual_lights;
    Address light_alias;
    /// AliasEntry per texel of the environment map, or 0.
    Address environment_alias;
    /// vec4 per texel of the environment map: radiance, probability density over the unit square; or 0.
    Address environment_texels;
    /// The acceleration structure's own root: what its GLSL file says.
    Address accel;
    /// EnergyTables of lib/energy.glsl (float[]), or 0.
    Address energy_tables;
    /// Entries of the alias table.
    uint light_count;
    /// Index of the environment in lights, ~0u if it does not shine.
    uint environment_light;
    /// Index of the only light without a size, ~0u if there is none or there are several, and the probability of choosing it: the alias table is
    /// of the others. 1 where nothing else shines.
    uint sole_light;
    float sole_probability;
    uvec2 environment_size;
    /// Constant environment's radiance.
    vec3 environment_radiance;
    /// Number of this frame, from 0.
    uint frame;
    Camera camera;
    /// In this frame's origin.
    Camera previous_camera;
    /// Pixels.
    uvec2 extent;
    uint seed;
    /// Sample index of this frame's first sample, for sequences that go on over frames.
    uint first_sample;
    /// Metres; bounds of the scene from the frame's origin, for directional lights' power and debug views.
    float scene_radius;
    /// sub-pixel offset of this frame's primary rays in -1/2..1/2, pixels, where all samples share one.
    vec2 jitter;
    /// The last frame's.
    vec2 previous_jitter;
    /// Samples per pixel of this frame, at least 1; and the share of the pixels that take one more, 0..1.
    uint samples;
    float more_samples;
    /// Of these, what earlier submissions of the frame have taken, and what all have after this one.
    uint share_begin;
    uint share_end;
    /// The frame's origin is at this multiple of 2^log2_origin_step metres from the world's; modulo 2^32.
    int log2_origin_step;
    ivec3 origin_steps;
    /// Of this frame's rounds, the number of this one, from 0.
    uint round;
    /// rays.first_shadow_rays of the round before.
    uint previous_first_rays;
    uint padding;
};

#endif
