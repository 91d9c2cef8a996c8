// Choice of a technique, then of a direction; lib/bsdf.glsl states the model. One sample of a mixture: the weight is f cos over the density
// of all techniques together, but for lobes of a single direction, which nothing else can find.
#ifndef LIB_BSDF_SAMPLE_GLSL
#define LIB_BSDF_SAMPLE_GLSL

/// Takes a choice of probability p from u in [0, 1): true with probability p; u is stretched to be used again.
bool choose(float p, inout float u) {
    bool chosen = u < p;
    u = chosen ? u / p : (u - p) / (1.0 - p);
    u = clamp(u, 0.0, 0.99999994);
    return chosen;
}

vec3 sample_reflection(vec3 normal_ws, float alpha, vec3 wo, vec2 u) {
    Basis basis = basis_around(normal_ws);
    vec3 wo_local = to_local(basis, wo);
    vec3 h = to_world(basis, sample_visible_normal(wo_local, alpha, reflection_bound(alpha, wo_local.z), u));
    return reflect(-wo, h);
}

/// A direction of the glass: by Fresnel's choice at a visible normal, reflected or transmitted. `chance`: the probability of that
/// choice, for a lobe of a single direction.
vec3 sample_glass(Surface s, vec3 wo, vec3 u, out bool reflected, out float chance) {
    vec3 h = s.normal_ws;
    if (!glass_is_delta(s)) {
        Basis basis = basis_around(h);
        h = to_world(basis, sample_visible_normal(to_local(basis, wo), s.alpha, 1.0, u.xy));
    }
    float oh = clamp(dot(wo, h), 0.0, 1.0);
    float fresnel = max_component(glass_fresnel(s, oh));
    reflected = choose(fresnel, u.z);
    chance = reflected ? fresnel : 1.0 - fresnel;
    vec3 mirrored = reflect(-wo, h);
    if (reflected) {
        return mirrored;
    }
    if (s.thin) {
        return reflect(mirrored, s.normal_ws);
    }
    return normalize((oh / s.eta - refracted_cosine(oh, s.eta)) * h - wo / s.eta);
}

/// The weight of a lobe of a single direction that was chosen with probability `p`. Returns false: there is nothing to evaluate.
bool finish_delta(vec3 value, float p, inout BsdfSample result) {
    result.delta = true;
    result.pdf = p;
    result.specular_weight = value / max(p, 1e-30);
    return false;
}

bool finish_glass_delta(Surface s, vec3 wo, float p, float chance, bool reflected, inout BsdfSample result) {
    vec3 fresnel = glass_fresnel(s, clamp(dot(s.normal_ws, wo), 0.0, 1.0));
    vec3 passed = s.base_color * (1.0 - max_component(fresnel)) / (result.eta * result.eta);
    vec3 value = glass_part(s) * below_clearcoat(s, wo) * (reflected ? fresnel : passed);
    return finish_delta(value, p * chance, result);
}

/// A direction by the technique that u.z chooses among those below the coat. Returns whether its value is still to be evaluated.
bool propose_below_clearcoat(Surface s, vec3 wo, vec3 u, Techniques p, inout BsdfSample result) {
    float cos_o = dot(s.normal_ws, wo);
    u.z *= p.diffuse + p.reflection + p.glass + p.far_diffuse;
    if (u.z < p.diffuse) {
        result.direction = to_world(basis_around(s.normal_ws), sample_cosine_hemisphere(u.xy));
    } else if (EFFECT_REFLECTION && u.z < p.diffuse + p.reflection) {
        result.lobe = LOBE_SPECULAR;
        if (reflection_is_delta(s)) {
            result.direction = reflect(-wo, s.normal_ws);
            return finish_delta(below_clearcoat(s, wo) * opaque_fresnel(s, cos_o), p.reflection, result);
        }
        result.direction = sample_reflection(s.normal_ws, s.alpha, wo, u.xy);
    } else if (EFFECT_TRANSMISSION && u.z < p.diffuse + p.reflection + p.glass) {
        bool reflected;
        float chance;
        u.z = clamp((u.z - p.diffuse - p.reflection) / p.glass, 0.0, 0.99999994);
        result.direction = sample_glass(s, wo, u, reflected, chance);
        result.lobe = reflected ? LOBE_SPECULAR : LOBE_TRANSMISSION;
        result.eta = reflected || s.thin ? 1.0 : s.eta;
        if (glass_is_delta(s)) {
            return finish_glass_delta(s, wo, p.glass, chance, reflected, result);
        }
    } else if (EFFECT_TRANSMISSION) {
        result.direction = to_world(basis_around(-s.normal_ws), sample_cosine_hemisphere(u.xy));
        result.lobe = LOBE_TRANSMISSION;
        result.eta = s.thin ? 1.0 : s.eta;
    }
    return true;
}

/// Proposes a direction by u in [0, 1)^3: u.z chooses the technique. Returns false where the path ends: the surface is black, or the
/// direction lies on the wrong side. `wo` is unit and on the geometric normal's side.
bool bsdf_sample(Surface s, vec3 wo, vec3 u, out BsdfSample result) {
    result = BsdfSample(s.normal_ws, 0.0, vec3(0.0), 0.0, LOBE_DIFFUSE, false, 1.0);
    Techniques p = sampling_techniques(s, wo);
    bool evaluate = true;
    vec3 normal = s.normal_ws;
    if (EFFECT_CLEARCOAT && choose(p.clearcoat, u.z)) {
        normal = s.clearcoat_normal_ws;
        result.lobe = LOBE_CLEARCOAT;
        if (clearcoat_is_delta(s)) {
            result.direction = reflect(-wo, normal);
            evaluate = finish_delta(vec3(clearcoat_fresnel(s, dot(normal, wo))), p.clearcoat, result);
        } else {
            result.direction = sample_reflection(normal, s.clearcoat_alpha, wo, u.xy);
        }
    } else if (dot(normal, wo) > 0.0 && p.clearcoat < 1.0) {
        evaluate = propose_below_clearcoat(s, wo, u, p, result);
    } else {
        return false;
    }
    // Directions that a microfacet sends across the horizon belong to no lobe.
    float side = result.lobe == LOBE_TRANSMISSION ? -1.0 : 1.0;
    if (!(side * dot(normal, result.direction) > 0.0 && side * dot(s.geometric_normal_ws, result.direction) > 0.0)) {
        return false;
    }
    if (evaluate) {
        BsdfValue value = evaluate_with(s, wo, result.direction, p);
        result.pdf = value.pdf;
        result.diffuse_weight = value.diffuse / max(value.pdf, 1e-30);
        result.specular_weight = value.specular / max(value.pdf, 1e-30);
    }
    return result.pdf > 0.0;
}

#endif
