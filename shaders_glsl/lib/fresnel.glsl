// Fresnel reflectance as a rise from f0, at normal incidence, to f90, at grazing: F = mix(f0, f90, rise).
//
// Opaque and thin-walled surfaces rise as Schlick's (1 - cos)^5 ("An Inexpensive BRDF Model for Physically-based Rendering", 1994),
// which is what glTF 2.0 appendix B and KHR_materials_specular state. A surface that refracts rises as the exact, unpolarised
// dielectric formula: Schlick's knows no total internal reflection and is up to 0.03 off at 60 degrees.
#ifndef LIB_FRESNEL_GLSL
#define LIB_FRESNEL_GLSL

/// A relative index of refraction nearer to 1 than this does not bend light: the Jacobian of refraction diverges there.
const float LEAST_REFRACTION = 1e-3;

/// Index of refraction of the far side over that of the near side, for a material of index `ior` (0: infinite) in air.
float relative_ior(float ior, bool entering) {
    float n = ior > 0.0 ? clamp(ior, 1e-3, 1e3) : 1e3;
    return entering ? n : 1.0 / n;
}

/// Reflectance at normal incidence: ((1 - ior) / (1 + ior))^2. ior 0 stands for infinity.
float f0_from_ior(float ior) {
    float r = (1.0 - ior) / (1.0 + ior);
    return r * r;
}

float schlick_rise(float cosine) {
    float m = clamp(1.0 - cosine, 0.0, 1.0);
    float m2 = m * m;
    return m2 * m2 * m;
}

/// Cosine of the refracted direction, or 0 where everything is reflected. `eta`: index of the far side over the near side's.
float refracted_cosine(float cosine, float eta) {
    float sin2 = (1.0 - cosine * cosine) / (eta * eta);
    return sqrt(max(0.0, 1.0 - sin2));
}

/// Exact, unpolarised reflectance in [0, 1] of a dielectric boundary for a cosine >= 0.
float fresnel_dielectric(float cosine, float eta) {
    float transmitted = refracted_cosine(cosine, eta);
    if (transmitted == 0.0) {
        return 1.0;
    }
    float perpendicular = (cosine - eta * transmitted) / (cosine + eta * transmitted);
    float parallel = (eta * cosine - transmitted) / (eta * cosine + transmitted);
    return 0.5 * (perpendicular * perpendicular + parallel * parallel);
}

/// The exact curve's rise from f0, 1 in total internal reflection.
float dielectric_rise(float cosine, float eta) {
    float f0 = f0_from_ior(eta);
    return (fresnel_dielectric(cosine, eta) - f0) / max(1.0 - f0, 1e-6);
}

#endif
