// The primary hit of each pixel: what screen-space filters and reprojection need. All samples of a frame share its jitter.
//
// Motion: where the point that a pixel sees was in the previous frame's image, with both cameras and both instance transforms.
#include "accel/trace.glsl"
#include "lib/rng.glsl"
#include "lib/storage.glsl"
#include "paths/hit.glsl"
#include "paths/primary.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

/// World position relative to the frame's origin, metres; w: distance along the ray, negative where nothing was hit.
layout(set = 1, binding = 0, rgba32f) writeonly uniform image2D position;
/// Shading normal, towards the viewer; w: cosine between geometric and shading normal.
layout(set = 1, binding = 1, COLOR_FORMAT) writeonly uniform image2D normal;
/// Diffuse albedo; w: roughness.
layout(set = 1, binding = 2, COLOR_FORMAT) writeonly uniform image2D albedo;
/// Pixels, from here to where it was; z: change of the distance to the camera, metres; w: 1 where it was in front of the camera.
layout(set = 1, binding = 3, rgba32f) writeonly uniform image2D motion;
/// Instance, primitive, material, metalness as a float's bits; all ones where nothing was hit.
layout(set = 1, binding = 4, rgba32ui) writeonly uniform uimage2D identity;

/// Pixel coordinates of a point for the previous camera; z: its depth.
vec3 previous_pixel(vec3 point) {
    Camera camera = frame.previous_camera;
    vec3 offset = point - camera.position;
    float depth = dot(offset, camera.forward);
    float scale = camera.projection == 0u ? 1.0 : 1.0 / (abs(depth) > 1e-20 ? depth : 1e-20);
    vec2 ndc = vec2(dot(offset, camera.right) / dot(camera.right, camera.right), -dot(offset, camera.up) / dot(camera.up, camera.up)) * scale;
    return vec3((ndc * 0.5 + 0.5) * vec2(frame.extent) - 0.5, depth);
}

vec3 previous_position(Hit hit) {
    Instance instance = InstanceBuffer(frame.instances).at[hit.instance];
    Mesh mesh = MeshBuffer(frame.meshes).at[instance.mesh];
    uvec3 corners = Uvec3Buffer(mesh.triangles).at[hit.primitive];
    Vec3Buffer positions = Vec3Buffer(mesh.positions);
    vec3 a = positions.at[corners.x];
    vec3 object = a + hit.barycentrics.x * (positions.at[corners.y] - a) + hit.barycentrics.y * (positions.at[corners.z] - a);
    vec4 rows[3] = instance.previous_object_to_world;
    return transform_vector(rows, object) + vec3(rows[0].w, rows[1].w, rows[2].w);
}

vec4 motion_of(ivec2 pixel, vec3 now, vec3 before) {
    vec3 was = previous_pixel(before);
    float depth_now = dot(now - frame.camera.position, frame.camera.forward);
    return vec4(was.xy - (vec2(pixel) + frame.jitter), was.z - depth_now, was.z > 0.0 || frame.previous_camera.projection == 0u ? 1.0 : 0.0);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), frame.extent))) {
        return;
    }
    Ray ray = primary_ray(uvec2(pixel), frame.jitter);
    Hit hit;
    if (!trace_closest(ray, pcg3d(uvec3(pixel, frame.first_sample ^ frame.seed)).x, hit)) {
        vec3 far = ray.origin + ray.direction * 1e6;
        imageStore(position, pixel, vec4(ray.direction, -1.0));
        imageStore(normal, pixel, vec4(0.0));
        imageStore(albedo, pixel, vec4(0.0));
        imageStore(motion, pixel, motion_of(pixel, far, far));
        imageStore(identity, pixel, uvec4(~0u));
        return;
    }
    HitPoint point = hit_point(hit, ray.direction, cone_advance(camera_cone(frame.camera), hit.t));
    Surface surface = point.surface;
    imageStore(position, pixel, vec4(point.origin.position, hit.t));
    imageStore(normal, pixel, vec4(surface.normal_ws, dot(surface.normal_ws, surface.geometric_normal_ws)));
    imageStore(albedo, pixel, vec4(diffuse_albedo(surface), sqrt(surface.alpha)));
    imageStore(motion, pixel, motion_of(pixel, point.origin.position, previous_position(hit)));
    imageStore(identity, pixel, uvec4(hit.instance, hit.primitive, point.material, floatBitsToUint(surface.metallic)));
}
