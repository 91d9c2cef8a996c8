// The lobes' values and densities; lib/bsdf.glsl states the model.
#ifndef LIB_BSDF_EVALUATE_GLSL
#define LIB_BSDF_EVALUATE_GLSL

/// Probability that bsdf_sample tries each technique; their sum is 1, or 0 where the surface is black.
struct Techniques {
    /// Cosine around the shading normal.
    float diffuse;
    /// Bounded visible normals: metal and opaque dielectric.
    float reflection;
    /// Visible normals, then Fresnel's choice between reflection and transmission.
    float glass;
    /// Cosine around the shading normal's opposite: the glass's lost energy.
    float far_diffuse;
    /// Bounded visible normals of the coat.
    float clearcoat;
};

/// By the albedo that each lobe has about `wo`: Schlick at the mean normal, less steep on rough surfaces (Lagarde 2011).
Techniques sampling_techniques(Surface s, vec3 wo) {
    if (s.part == PART_DIFFUSE) {
        return Techniques(1.0, 0.0, 0.0, 0.0, 0.0);
    }
    float cos_o = max(dot(s.normal_ws, wo), 0.0);
    float rise = schlick_rise(cos_o) * (1.0 - sqrt(s.alpha));
    vec3 dielectric = mix(s.dielectric_f0, vec3(s.dielectric_f90), rise);
    vec3 reflected = s.metallic * mix(s.base_color, vec3(1.0), rise) + opaque_part(s) * dielectric;
    Techniques p = Techniques(0.0, 0.0, 0.0, 0.0, 0.0);
    if (s.part == PART_WHOLE) {
        p.diffuse = max_component(diffuse_albedo(s)) * max(1.0 - max_component(dielectric), 0.1);
    }
    p.reflection = EFFECT_REFLECTION ? max_component(reflected) : 0.0;
    p.glass = glass_part(s) * mix(max_component(s.base_color), 1.0, 0.1);
    if (COMPENSATE_ENERGY && reflects(s)) {
        float lost = 1.0 - reflected_energy(cos_o, s.alpha).x;
        p.diffuse += lost * (p.reflection + p.glass);
        p.far_diffuse = lost * p.glass;
    }
    float coat = EFFECT_CLEARCOAT ? clearcoat_fresnel(s, dot(s.clearcoat_normal_ws, wo)) : 0.0;
    float sum = p.diffuse + p.reflection + p.glass + p.far_diffuse;
    float scale = sum > 0.0 ? (1.0 - coat) / sum : 0.0;
    p.clearcoat = sum > 0.0 || coat == 0.0 ? coat : 1.0;
    return Techniques(p.diffuse * scale, p.reflection * scale, p.glass * scale, p.far_diffuse * scale, p.clearcoat);
}

/// What the clearcoat leaves to the layers below.
float below_clearcoat(Surface s, vec3 wo) {
    if (!EFFECT_CLEARCOAT || s.clearcoat == 0.0) {
        return 1.0;
    }
    float cosine = max(dot(s.clearcoat_normal_ws, wo), 0.0);
    if (COMPENSATE_ENERGY && !clearcoat_is_delta(s)) {
        vec2 albedo = reflected_energy(cosine, s.clearcoat_alpha);
        return 1.0 - s.clearcoat * (0.04 * (albedo.x - albedo.y) + albedo.y);
    }
    return 1.0 - clearcoat_fresnel(s, cosine);
}

/// Lambert or Burley, 1/sr, before what the reflection above takes.
float diffuse_model(Surface s, float cos_o, float cos_i, float oh) {
    if (DIFFUSE_MODEL == 0u) {
        return INV_PI;
    }
    float roughness = sqrt(s.alpha);
    float bias = COMPENSATE_ENERGY ? 0.5 * roughness : 0.5;
    float scale = COMPENSATE_ENERGY ? mix(1.0, 1.0 / 1.51, roughness) : 1.0;
    float rise = bias + 2.0 * oh * oh * roughness - 1.0;
    return INV_PI * scale * (1.0 + rise * schlick_rise(cos_i)) * (1.0 + rise * schlick_rise(cos_o));
}

/// Diffuse base and what multiple scattering reflects: the lobes that are wide whatever the roughness.
void add_wide_reflection(Surface s, float cos_o, float cos_i, float oh, inout BsdfValue value) {
    float diffuse = opaque_part(s) > 0.0 ? diffuse_model(s, cos_o, cos_i, oh) * cos_i : 0.0;
    if (!reflects(s)) {
        value.diffuse = diffuse;
        return;
    }
    if (!COMPENSATE_ENERGY) {
        value.diffuse = diffuse * (1.0 - max_component(dielectric_fresnel(s, oh)));
        return;
    }
    GgxEnergy e = ggx_energy(s.alpha, cos_o, cos_i);
    value.diffuse = diffuse * base_coupling(e, max_component(s.dielectric_f0), s.dielectric_f90);
    float schlick_glass = s.thin ? glass_part(s) : 0.0;
    vec3 multiple = s.metallic * multiple_fresnel(s.base_color, 1.0, e.average.x)
        + (opaque_part(s) + schlick_glass) * multiple_fresnel(s.dielectric_f0, s.dielectric_f90, e.average.x);
    value.specular += multiple * lost_lobe(e) * cos_i;
    if (glass_part(s) > 0.0 && !s.thin && !glass_is_delta(s)) {
        value.specular += glass_part(s) * cos_i * lost_glass_lobes(s.alpha, s.eta, max_component(s.dielectric_f0), s.dielectric_f90, cos_o, cos_i).x;
    }
}

/// `wi` on the viewer's side of the geometric and the shading normal.
void add_reflection(Surface s, vec3 wo, vec3 wi, float cos_o, float cos_i, Techniques p, inout BsdfValue value) {
    vec3 h = normalize(wo + wi);
    float oh = clamp(dot(wo, h), 0.0, 1.0);
    add_wide_reflection(s, cos_o, cos_i, oh, value);
    value.pdf += p.diffuse * cosine_hemisphere_pdf(cos_i);
    bool opaque = reflects(s) && !reflection_is_delta(s);
    bool glass = EFFECT_TRANSMISSION && !glass_is_delta(s);
    if (!opaque && !glass) {
        return;
    }
    float distribution = ggx_distribution(s.alpha, s.normal_ws, h);
    vec3 fresnel = opaque ? opaque_fresnel(s, oh) : vec3(0.0);
    if (opaque) {
        value.pdf += p.reflection * reflection_pdf(distribution, s.alpha, reflection_bound(s.alpha, cos_o), cos_o);
    }
    if (glass) {
        vec3 of_glass = glass_fresnel(s, oh);
        fresnel += glass_part(s) * of_glass;
        value.pdf += p.glass * max_component(of_glass) * reflection_pdf(distribution, s.alpha, 1.0, cos_o);
    }
    value.specular += fresnel * (distribution * smith_visibility(s.alpha, cos_o, cos_i) * cos_i);
}

/// `wi` beyond both normals' horizons; cos_i is positive.
void add_transmission(Surface s, vec3 wo, vec3 wi, float cos_o, float cos_i, Techniques p, inout BsdfValue value) {
    vec3 h = s.thin ? normalize(wo + wi + 2.0 * cos_i * s.normal_ws) : refraction_half_vector(wo, wi, s.normal_ws, s.eta);
    float oh = dot(wo, h);
    float ih = dot(wi, h);
    float radiance_scale = s.thin ? 1.0 : 1.0 / (s.eta * s.eta);
    float transmitted = 0.0;
    if (oh > 0.0 && (s.thin || ih < 0.0)) {
        float distribution = ggx_distribution(s.alpha, s.normal_ws, h);
        float passed = 1.0 - max_component(glass_fresnel(s, oh));
        float pdf = s.thin ? reflection_pdf(distribution, s.alpha, 1.0, cos_o) : refraction_pdf(distribution, s.alpha, cos_o, oh, ih, s.eta);
        float masking = 2.0 * smith_visibility(s.alpha, cos_o, cos_i) * cos_i * (cos_o + stretched_length(s.alpha, cos_o));
        transmitted = passed * masking * pdf;
        value.pdf += p.glass * passed * pdf;
    }
    if (COMPENSATE_ENERGY) {
        float f0 = max_component(s.dielectric_f0);
        GgxEnergy e = ggx_energy(s.alpha, cos_o, cos_i);
        float lost = s.thin ? max(1.0 - multiple_fresnel(vec3(f0), s.dielectric_f90, e.average.x).x, 0.0) * lost_lobe(e)
            : lost_glass_lobes(s.alpha, s.eta, f0, s.dielectric_f90, cos_o, cos_i).y;
        transmitted += lost * cos_i;
        value.pdf += p.far_diffuse * cosine_hemisphere_pdf(cos_i);
    }
    value.specular += glass_part(s) * radiance_scale * transmitted * s.base_color;
}

void add_clearcoat(Surface s, vec3 wo, vec3 wi, Techniques p, inout BsdfValue value) {
    float cos_o = dot(s.clearcoat_normal_ws, wo);
    float cos_i = dot(s.clearcoat_normal_ws, wi);
    if (cos_o <= 0.0 || cos_i <= 0.0) {
        return;
    }
    vec3 h = normalize(wo + wi);
    float distribution = ggx_distribution(s.clearcoat_alpha, s.clearcoat_normal_ws, h);
    float fresnel = clearcoat_fresnel(s, COMPENSATE_ENERGY ? dot(wo, h) : cos_o);
    value.specular += fresnel * distribution * smith_visibility(s.clearcoat_alpha, cos_o, cos_i) * cos_i;
    value.pdf += p.clearcoat * reflection_pdf(distribution, s.clearcoat_alpha, reflection_bound(s.clearcoat_alpha, cos_o), cos_o);
}

BsdfValue evaluate_with(Surface s, vec3 wo, vec3 wi, Techniques p) {
    BsdfValue value = BsdfValue(0.0, vec3(0.0), 0.0);
    float cos_o = dot(s.normal_ws, wo);
    float cos_i = dot(s.normal_ws, wi);
    bool reflected = dot(s.geometric_normal_ws, wi) > 0.0;
    if (cos_o > 0.0 && reflected && cos_i > 0.0) {
        add_reflection(s, wo, wi, cos_o, cos_i, p, value);
    } else if (EFFECT_TRANSMISSION && cos_o > 0.0 && !reflected && cos_i < 0.0 && glass_part(s) > 0.0 && !glass_is_delta(s)) {
        add_transmission(s, wo, wi, cos_o, -cos_i, p, value);
    }
    if (EFFECT_CLEARCOAT && s.clearcoat > 0.0) {
        float below = below_clearcoat(s, wo);
        value.diffuse *= below;
        value.specular *= below;
        if (reflected && !clearcoat_is_delta(s)) {
            add_clearcoat(s, wo, wi, p, value);
        }
    }
    value.diffuse = s.part == PART_SPECULAR ? 0.0 : value.diffuse;
    value.specular = s.part == PART_DIFFUSE ? vec3(0.0) : value.specular;
    return value;
}

/// `wo` (towards the viewer) and `wi` (towards the light) are unit.
BsdfValue bsdf_evaluate(Surface s, vec3 wo, vec3 wi) {
    return evaluate_with(s, wo, wi, sampling_techniques(s, wo));
}

#endif
