// Set 0: what every shader may read. A pass's own images and buffers are in set 1.
#ifndef SHARED_BINDINGS_GLSL
#define SHARED_BINDINGS_GLSL

#include "shared/scene.glsl"
#include "shared/parameters.glsl"
#include "shared/effects.glsl"

layout(set = 0, binding = 0, scalar) uniform FrameBlock { FrameData frame; Parameters parameters; };
layout(set = 0, binding = 1) uniform sampler2D textures[];
#ifdef ACCEL_RAY_QUERY
layout(set = 0, binding = 2) uniform accelerationStructureEXT top_level;
#endif

layout(buffer_reference, scalar) readonly buffer MeshBuffer { Mesh at[]; };
layout(buffer_reference, scalar) readonly buffer InstanceBuffer { Instance at[]; };
layout(buffer_reference, scalar) readonly buffer MaterialBuffer { Material at[]; };
layout(buffer_reference, scalar) readonly buffer LightBuffer { Light at[]; };
layout(buffer_reference, scalar) readonly buffer PunctualLightBuffer { PunctualLight at[]; };
layout(buffer_reference, scalar) readonly buffer AliasBuffer { AliasEntry at[]; };
layout(buffer_reference, scalar) readonly buffer VertexAttributesBuffer { VertexAttributes at[]; };
layout(buffer_reference, scalar) readonly buffer FloatBuffer { float at[]; };
layout(buffer_reference, scalar) readonly buffer UintBuffer { uint at[]; };
layout(buffer_reference, scalar) readonly buffer Vec2Buffer { vec2 at[]; };
layout(buffer_reference, scalar) readonly buffer Vec3Buffer { vec3 at[]; };
layout(buffer_reference, scalar) readonly buffer Vec4Buffer { vec4 at[]; };
layout(buffer_reference, scalar) readonly buffer Uvec2Buffer { uvec2 at[]; };
layout(buffer_reference, scalar) readonly buffer Uvec4Buffer { uvec4 at[]; };
layout(buffer_reference, scalar) readonly buffer Uvec3Buffer { uvec3 at[]; };

#endif
