// Orthonormal bases around a normal.
//
// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017, listing 3: no singularity at -z.
#ifndef LIB_FRAME_GLSL
#define LIB_FRAME_GLSL

struct Basis {
    vec3 tangent;
    vec3 bitangent;
    vec3 normal;
};

/// `normal` is unit; so are the others, perpendicular to it and each other.
Basis basis_around(vec3 normal) {
    float side = normal.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (side + normal.z);
    float b = normal.x * normal.y * a;
    return Basis(vec3(1.0 + side * normal.x * normal.x * a, side * b, -side * normal.x), vec3(b, side + normal.y * normal.y * a, -normal.y), normal);
}

vec3 to_local(Basis basis, vec3 v) {
    return vec3(dot(basis.tangent, v), dot(basis.bitangent, v), dot(basis.normal, v));
}

vec3 to_world(Basis basis, vec3 v) {
    return basis.tangent * v.x + basis.bitangent * v.y + basis.normal * v.z;
}

/// A shading normal that `wo` can see. Interpolated and mapped normals may turn away from a viewer whom the surface faces, where a
/// BSDF is undefined and would be black: such a normal is bent just far enough that its cosine with `wo` is `least`. Without it paths at
/// grazing angles lose light: 2.6 % in the vault of the hall against the triangles' own normals, and none with it (+- 0.2 %;
/// ci/references/README.md).
vec3 visible_normal(vec3 normal, vec3 wo) {
    const float least = 0.01;
    float cosine = dot(normal, wo);
    if (cosine >= least) {
        return normal;
    }
    vec3 across = normal - cosine * wo;
    float sine = length(across);
    if (sine < 1e-6) {
        across = basis_around(wo).tangent;
        sine = 1.0;
    }
    return least * wo + sqrt(1.0 - least * least) / sine * across;
}

#endif
