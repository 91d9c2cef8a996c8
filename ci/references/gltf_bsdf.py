"""The metallic-roughness BRDF of the glTF 2.0 specification, appendix B, for Mitsuba 3 (any vectorised variant).

f = mix(dielectric, metal, metallic)                                                      B.2
dielectric = (1 - w F_d) base / pi + w F_d D V,  F_d = f0 + (1 - f0) (1 - |v.h|)^5        B.2.3, KHR_materials_ior and _specular
metal = (base + (1 - base) (1 - |v.h|)^5) D V                                             B.2.2
D is GGX with alpha = roughness^2; V = G / (4 n.l n.v), where G is Smith's separable masking-shadowing, G1(n.l) G1(n.v)   B.3.2
Single scattering: no energy is returned to rough metals. Below DELTA_ALPHA the specular lobe is a delta.
"""

import drjit as dr
import mitsuba as mi

# The line that the renderer draws too: src/scene/effects.rs.
DELTA_ALPHA = 1e-3


class GltfBSDF(mi.BSDF):
    """Properties: base_color (colour or texture), metallic (float or texture), roughness (float or texture), f0 (float), specular (float, w above).
    A roughness texture must stay above the delta limit."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.base_color = props["base_color"]
        self.metallic = props["metallic"]
        self.roughness = props["roughness"]
        self.f0 = props["f0"]
        self.specular = props["specular"]
        self.smooth = isinstance(self.roughness, float) and self.roughness**2 < DELTA_ALPHA
        lobe = mi.BSDFFlags.DeltaReflection if self.smooth else mi.BSDFFlags.GlossyReflection
        self.specular_type = int(lobe)
        self.m_components = [mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.FrontSide, lobe | mi.BSDFFlags.FrontSide]
        self.m_flags = self.m_components[0] | self.m_components[1]

    def parameters(self, si, active):
        """Base colour, metalness, alpha at the hit."""
        scalar = lambda value: value.eval_1(si, active) if isinstance(value, mi.Texture) else mi.Float(value)
        is_texture = isinstance(self.base_color, mi.Texture)
        base = self.base_color.eval(si, active) if is_texture else mi.Color3f(self.base_color)
        roughness = scalar(self.roughness)
        return base, scalar(self.metallic), dr.maximum(roughness * roughness, DELTA_ALPHA)

    def fresnel(self, cos_vh, base, metallic):
        """Reflected fraction of the dielectric interface, and tint of the whole specular lobe."""
        grazing = dr.power(1 - dr.minimum(dr.abs(cos_vh), 1), 5)
        dielectric = self.specular * (self.f0 + (1 - self.f0) * grazing)
        return dielectric, (1 - metallic) * dielectric + metallic * (base + (1 - base) * grazing)

    def value(self, si, wo, base, metallic, alpha):
        """f times the cosine, without the delta lobe."""
        half = dr.normalize(si.wi + wo)
        dielectric, tint = self.fresnel(dr.dot(si.wi, half), base, metallic)
        cos_i, cos_o = mi.Frame3f.cos_theta(si.wi), mi.Frame3f.cos_theta(wo)
        diffuse = (1 - metallic) * (1 - dielectric) * base * dr.inv_pi
        if self.smooth:
            return diffuse * cos_o
        alpha2 = alpha * alpha
        cos_h = mi.Frame3f.cos_theta(half)
        distribution = alpha2 * dr.inv_pi / dr.square(cos_h * cos_h * (alpha2 - 1) + 1)
        # 2 cos / masking is G1.
        masking = lambda cosine: cosine + dr.sqrt(alpha2 + (1 - alpha2) * cosine * cosine)
        visibility = 1 / (masking(cos_i) * masking(cos_o))
        return (diffuse + tint * distribution * visibility) * cos_o

    def specular_probability(self, metallic):
        return dr.select(metallic > 0.999, 1.0, 0.5)

    def density(self, si, wo, metallic, alpha):
        """Of `sample`, without the delta lobe."""
        choice = self.specular_probability(metallic)
        cosine = (1 - choice) * mi.warp.square_to_cosine_hemisphere_pdf(wo)
        if self.smooth:
            return cosine
        half = dr.normalize(si.wi + wo)
        glossy = self.normals(alpha).pdf(si.wi, half) / (4 * dr.maximum(dr.dot(wo, half), 1e-9))
        return choice * glossy + cosine

    def normals(self, alpha):
        return mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha, alpha, True)

    def is_above(self, si, wo, active):
        return active & (mi.Frame3f.cos_theta(si.wi) > 0) & (mi.Frame3f.cos_theta(wo) > 0)

    def sample(self, ctx, si, sample1, sample2, active=True):
        base, metallic, alpha = self.parameters(si, active)
        choice = self.specular_probability(metallic)
        is_specular = sample1 < choice
        half = mi.Normal3f(0, 0, 1) if self.smooth else self.normals(alpha).sample(si.wi, sample2)[0]
        wo = dr.select(is_specular, mi.reflect(si.wi, half), mi.warp.square_to_cosine_hemisphere(sample2))

        bs = dr.zeros(mi.BSDFSample3f)
        bs.wo, bs.eta = wo, 1.0
        bs.sampled_component = dr.select(is_specular, mi.UInt32(1), mi.UInt32(0))
        bs.sampled_type = dr.select(is_specular, mi.UInt32(self.specular_type), mi.UInt32(int(mi.BSDFFlags.DiffuseReflection)))
        bs.pdf = self.density(si, wo, metallic, alpha)
        weight = self.value(si, wo, base, metallic, alpha) / bs.pdf
        if self.smooth:
            _, tint = self.fresnel(mi.Frame3f.cos_theta(si.wi), base, metallic)
            bs.pdf = dr.select(is_specular, choice, bs.pdf)
            weight = dr.select(is_specular, tint / choice, weight)
        valid = self.is_above(si, wo, active) & (bs.pdf > 0)
        bs.pdf = dr.select(valid, bs.pdf, 0)
        return bs, dr.select(valid, weight, 0)

    def eval(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[1]

    def eval_pdf(self, ctx, si, wo, active=True):
        base, metallic, alpha = self.parameters(si, active)
        valid = self.is_above(si, wo, active)
        value = dr.select(valid, self.value(si, wo, base, metallic, alpha), 0)
        return value, dr.select(valid, self.density(si, wo, metallic, alpha), 0)

    def traverse(self, callback):
        pass

    def to_string(self):
        return f"GltfBSDF[f0={self.f0}, specular={self.specular}, smooth={self.smooth}]"


mi.register_bsdf("gltf_appendix_b", GltfBSDF)
