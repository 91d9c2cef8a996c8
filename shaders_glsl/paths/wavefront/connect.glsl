// Wavefront path tracing: the shadow rays of a turn, and the light of those that arrive.
#include "accel/trace.glsl"
#include "paths/wavefront/queue.glsl"
#include "paths/wavefront/sums.glsl"

layout(local_size_x = QUEUE_GROUP) in;

layout(set = 1, binding = 0, scalar) readonly buffer Heads { QueueHead at[]; } heads;
layout(set = 1, binding = 1, scalar) readonly buffer ShadowRays { StoredShadowRay at[]; } shadow_rays;
layout(set = 1, binding = 2, scalar) readonly buffer Lights { StoredLight at[]; } lights;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= heads.at[shadow_rays_of(turn)].count) {
        return;
    }
    StoredShadowRay ray = shadow_rays.at[i];
    if (trace_any(Ray(ray.origin, 0.0, ray.direction, ray.t_max), ray.alpha_seed)) {
        return;
    }
    StoredLight light = lights.at[i];
    uint slot = target_slot(light.target);
    Terms found = no_terms();
#ifdef VERTEX_LIST
    found.vertices = target_vertices(light.target);
#endif
    found.attenuation = front.at[slot].attenuation;
    add_term(found, target_term(light.target), light.diffuse_weight, light.specular_weight, light.radiance);
    add_to_sums(slot, found);
}
