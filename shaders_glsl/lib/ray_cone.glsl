// Texture level of detail by ray cones: a path carries the width of its footprint and how fast that grows.
//
// Akenine-Moeller et al., "Texture Level of Detail Strategies for Real-Time Ray Tracing", Ray Tracing Gems, 2019, sections 20.3.4 and
// 20.6 (equation 34). Deviations and why: surface curvature does not spread the cone, and a scattered ray spreads by its
// solid-angle density, since path vertices are mostly diffuse: a cone of solid angle 1 / pdf has the spread sqrt(1 / pdf),
// damped by SCATTER_SPREAD so that level of detail costs noise before it costs sharpness.
#ifndef LIB_RAY_CONE_GLSL
#define LIB_RAY_CONE_GLSL

/// Share of the scattered lobe's width that the footprint grows by.
const float SCATTER_SPREAD = 0.1;

struct RayCone {
    /// Metres.
    float width;
    /// Radians.
    float spread;
};

RayCone cone_advance(RayCone cone, float distance) {
    return RayCone(cone.width + cone.spread * distance, cone.spread);
}

/// After scattering with a density of `pdf`, 1/sr; delta lobes keep the spread.
RayCone cone_scatter(RayCone cone, float pdf, bool delta) {
    return RayCone(cone.width, delta ? cone.spread : max(cone.spread, SCATTER_SPREAD * inversesqrt(max(pdf, 1e-4))));
}

/// Level of detail for a texture of edge 1 texel; add log2 of the texture's edge. `uv_per_area`: area of the triangle in texture space over
/// its area in the world.
float cone_level(RayCone cone, float uv_per_area, float cosine) {
    return log2(max(cone.width, 1e-20) / max(abs(cosine), 1e-3)) + 0.5 * log2(max(uv_per_area, 1e-30));
}

#endif
