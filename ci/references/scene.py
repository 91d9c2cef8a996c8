"""A .glb of this project as a Mitsuba scene. What Mitsuba cannot say exactly is refused, not approximated."""

import math

import mitsuba as mi
import numpy as np

from glb import Glb
from gltf_bsdf import DELTA_ALPHA

KNOWN = {
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_texture_transform",
}
# Masks are thresholded after filtering, so the reference has them at this many times the resolution.
MASK_UPSAMPLING = 8


def load(path, size, bounces):
    """The scene, seen by the file's camera, for a picture of `size`; `bounces` scattering events after the primary hit.

    Triangles, spheres, points and spots are chosen by their power (`sampling_weight`), which changes the noise and not the mean."""
    glb = Glb(path)
    unknown = set(glb.json.get("extensionsUsed", [])) - KNOWN
    assert not unknown, f"{path}: {unknown} is not modelled here"
    scene = {"type": "scene", "integrator": {"type": "path", "max_depth": bounces + 2}}
    materials = Materials(glb)
    for node, world in glb.placed_nodes():
        if "mesh" in node:
            for primitive in glb.json["meshes"][node["mesh"]]["primitives"]:
                scene[f"shape {len(scene)}"] = shape(glb, primitive, world, materials)
        if "camera" in node:
            scene["sensor"] = sensor(glb.json["cameras"][node["camera"]], world, size)
        if "KHR_lights_punctual" in node.get("extensions", {}):
            light = glb.json["extensions"]["KHR_lights_punctual"]["lights"][node["extensions"]["KHR_lights_punctual"]["light"]]
            scene[f"light {len(scene)}"] = punctual_light(light, world)
    environment = glb.json["scenes"][0].get("extras", {}).get("environment")
    if environment:
        scene["environment"] = {"type": "constant", "radiance": rgb(environment)}
    return mi.load_dict(scene)


def rgb(value):
    return {"type": "rgb", "value": [float(x) for x in value[:3]]}


def sensor(camera, world, size):
    assert camera["type"] == "perspective"
    return {
        "type": "perspective",
        "fov_axis": "y",
        "fov": math.degrees(camera["perspective"]["yfov"]),
        "near_clip": 1e-3,
        "far_clip": 1e4,
        # Mitsuba's camera looks along +z, with +x to the left.
        "to_world": mi.ScalarTransform4f(world @ np.diag([-1.0, 1, -1, 1])),
        "film": {
            "type": "hdrfilm",
            "width": size[0],
            "height": size[1],
            "rfilter": {"type": "box"},
            "pixel_format": "rgb",
            "component_format": "float32",
        },
        "sampler": {"type": "independent"},
    }


def shape(glb, primitive, world, materials):
    assert primitive.get("mode", 4) == 4 and "COLOR_0" not in primitive["attributes"]
    attribute = lambda name: glb.accessor(primitive["attributes"][name]).astype(np.float64)
    positions = attribute("POSITION") @ world[:3, :3].T + world[:3, 3]
    triangles = glb.accessor(primitive["indices"]).reshape(-1, 3)
    if np.linalg.det(world[:3, :3]) < 0:
        triangles = triangles[:, [0, 2, 1]]
    properties = mi.Properties()
    properties["bsdf"] = materials.bsdf(primitive["material"])
    emission = materials.emission(primitive["material"])
    shines = any(emission)
    if shines:
        # Mitsuba's emitters would take side and foreshortening from interpolated normals, which loses light where those and the triangle disagree.
        assert materials.is_black(primitive["material"]), "without its normals a shape cannot reflect as it should"
        corners = positions[triangles]
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
        emitter = {"type": "area", "radiance": rgb(emission), "sampling_weight": math.pi * area * emission.mean()}
        properties["emitter"] = mi.load_dict(emitter)
    has_uv = "TEXCOORD_0" in primitive["attributes"]
    mesh = mi.Mesh("mesh", len(positions), len(triangles), properties, has_vertex_normals=not shines, has_vertex_texcoords=has_uv)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = positions.astype(np.float32).ravel()
    if not shines:
        normals = attribute("NORMAL") @ np.linalg.inv(world[:3, :3])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        parameters["vertex_normals"] = normals.astype(np.float32).ravel()
    parameters["faces"] = triangles.astype(np.uint32).ravel()
    if has_uv:
        parameters["vertex_texcoords"] = attribute("TEXCOORD_0").astype(np.float32).ravel()
    parameters.update()
    return mesh


def punctual_light(light, world):
    position = world[:3, 3]
    color = np.array(light.get("color", [1, 1, 1])) * light.get("intensity", 1)
    radius = light.get("extras", {}).get("radius", 0)
    power = 4 * math.pi * color.mean()
    assert "range" not in light
    if light["type"] == "point" and radius > 0:
        emitter = {"type": "area", "radiance": rgb(color / (math.pi * radius**2)), "sampling_weight": power}
        return {"type": "sphere", "center": position.tolist(), "radius": radius, "emitter": emitter, "bsdf": {"type": "diffuse", "reflectance": 0.0}}
    if light["type"] == "point":
        return {"type": "point", "position": position.tolist(), "intensity": rgb(color), "sampling_weight": power}
    direction = -world[:3, 2] / np.linalg.norm(world[:3, 2])
    if light["type"] == "directional":
        return {"type": "directional", "direction": direction.tolist(), "irradiance": rgb(color)}
    return spot_light(light["spot"], color, position, direction)


def spot_light(cone, color, position, direction):
    """Mitsuba's falloff is not glTF's, so it is turned off, and glTF's projected as a picture."""
    inner, outer = math.cos(cone.get("innerConeAngle", 0)), math.cos(cone.get("outerConeAngle", math.pi / 4))
    side = 1024
    offset = (np.arange(side) + 0.5) / side * 2 - 1
    x, y = np.meshgrid(offset, offset)
    cosine = 1 / np.sqrt(1 + (x**2 + y**2) * math.tan(math.acos(outer)) ** 2)
    falloff = np.clip((cosine - outer) / max(inner - outer, 1e-4), 0, 1) ** 2
    picture = mi.Bitmap((falloff[..., None] * np.ones(3)).astype(np.float32))
    up = [0, 1, 0] if abs(direction[1]) < 0.99 else [1, 0, 0]
    return {
        "type": "spot",
        "to_world": mi.ScalarTransform4f().look_at(origin=position.tolist(), target=(position + direction).tolist(), up=up),
        "intensity": rgb(color),
        # Several times its power: what it is there to light may be glossy.
        "sampling_weight": 8 * math.pi * (1 - outer) * color.mean(),
        "cutoff_angle": math.degrees(math.acos(outer)),
        "beam_width": math.degrees(math.acos(outer)),
        "texture": {"type": "bitmap", "bitmap": picture, "raw": True, "wrap_mode": "clamp"},
    }


class Materials:
    def __init__(self, glb):
        self.glb = glb
        self.made = {}

    def emission(self, index):
        material = self.glb.json["materials"][index]
        assert "emissiveTexture" not in material
        strength = extension(material, "emissive_strength").get("emissiveStrength", 1)
        return np.array(material.get("emissiveFactor", [0, 0, 0])) * strength

    def is_black(self, index):
        material = self.glb.json["materials"][index]
        color = material.get("pbrMetallicRoughness", {}).get("baseColorFactor", [1, 1, 1, 1])
        return not any(color[:3]) and extension(material, "specular").get("specularFactor", 1) == 0

    def bsdf(self, index):
        if index not in self.made:
            self.made[index] = mi.load_dict(self.describe(self.glb.json["materials"][index]))
        return self.made[index]

    def describe(self, material):
        assert "normalTexture" not in material, "renderers differ in how they bend light at a bent normal"
        pbr = material.get("pbrMetallicRoughness", {})
        ior = extension(material, "ior").get("ior", 1.5)
        if extension(material, "transmission").get("transmissionFactor", 0) > 0:
            return glass(material, pbr, ior)
        base = self.base_color(pbr)
        metallic, roughness = pbr.get("metallicFactor", 1), pbr.get("roughnessFactor", 1)
        assert "metallicRoughnessTexture" not in pbr or roughness > 0
        specular = extension(material, "specular").get("specularFactor", 1)
        if specular == 0 and metallic == 0:
            bsdf = {"type": "diffuse", "reflectance": base}
        else:
            bsdf = {
                "type": "gltf_appendix_b",
                "base_color": base,
                "metallic": self.scalar(pbr.get("metallicRoughnessTexture"), 2, metallic),
                "roughness": self.scalar(pbr.get("metallicRoughnessTexture"), 1, roughness),
                "f0": ((ior - 1) / (ior + 1)) ** 2,
                "specular": float(specular),
            }
        bsdf = {"type": "twosided", "bsdf": bsdf}
        if material.get("alphaMode", "OPAQUE") == "OPAQUE":
            return bsdf
        return {"type": "mask", "opacity": self.mask(material, pbr), "bsdf": bsdf}

    def base_color(self, pbr):
        factor = pbr.get("baseColorFactor", [1, 1, 1, 1])
        if "baseColorTexture" not in pbr:
            return rgb(factor)
        stored = self.glb.image(pbr["baseColorTexture"]["index"])[..., :3]
        linear = np.where(stored <= 0.04045, stored / 12.92, ((stored + 0.055) / 1.055) ** 2.4)
        return self.bitmap(pbr["baseColorTexture"], linear * factor[:3])

    def scalar(self, reference, channel, factor):
        if reference is None:
            return float(factor)
        return self.bitmap(reference, self.glb.image(reference["index"])[..., channel : channel + 1] * factor)

    def mask(self, material, pbr):
        assert material["alphaMode"] == "MASK"
        factor = pbr.get("baseColorFactor", [1, 1, 1, 1])[3]
        alpha = self.glb.image(pbr["baseColorTexture"]["index"])[..., 3] * factor
        if not self.is_nearest(pbr["baseColorTexture"]):
            alpha = upsample(upsample(alpha).T).T
        opacity = (alpha >= material.get("alphaCutoff", 0.5)).astype(np.float32)
        return self.bitmap(pbr["baseColorTexture"], opacity[..., None]) | {"filter_type": "nearest"}

    def sampler(self, reference):
        return self.glb.json["samplers"][self.glb.json["textures"][reference["index"]]["sampler"]]

    def is_nearest(self, reference):
        return self.sampler(reference).get("magFilter") == 9728

    def bitmap(self, reference, texels):
        sampler = self.sampler(reference)
        assert sampler.get("wrapS", 10497) == sampler.get("wrapT", 10497) == 10497 and reference.get("texCoord", 0) == 0
        transform = reference.get("extensions", {}).get("KHR_texture_transform", {})
        (u, v), (su, sv) = transform.get("offset", [0, 0]), transform.get("scale", [1, 1])
        sine, cosine = math.sin(transform.get("rotation", 0)), math.cos(transform.get("rotation", 0))
        return {
            "type": "bitmap",
            "bitmap": mi.Bitmap(np.ascontiguousarray(texels, np.float32)),
            "raw": True,
            "filter_type": "nearest" if self.is_nearest(reference) else "bilinear",
            "to_uv": mi.ScalarTransform3f(np.array([[cosine * su, sine * sv, u], [-sine * su, cosine * sv, v], [0, 0, 1]])),
        }


def extension(material, name):
    return material.get("extensions", {}).get("KHR_materials_" + name, {})


def glass(material, pbr, ior):
    """A solid of Mitsuba's own dielectric; single-scattering GGX where it is rough."""
    volume = extension(material, "volume")
    assert volume.get("thicknessFactor", 0) > 0 and "attenuationColor" not in volume and "baseColorTexture" not in pbr
    assert extension(material, "transmission")["transmissionFactor"] == 1 and pbr.get("metallicFactor", 1) == 0
    alpha = pbr.get("roughnessFactor", 1) ** 2
    interface = {"int_ior": float(ior), "ext_ior": 1.0, "specular_transmittance": rgb(pbr.get("baseColorFactor", [1, 1, 1]))}
    if alpha < DELTA_ALPHA:
        return {"type": "dielectric"} | interface
    return {"type": "roughdielectric", "distribution": "ggx", "alpha": alpha} | interface


def upsample(rows):
    """MASK_UPSAMPLING times as many rows, linear between texel centres, repeating at the edges."""
    count = len(rows)
    at = (np.arange(count * MASK_UPSAMPLING) + 0.5) / MASK_UPSAMPLING - 0.5
    below = np.floor(at).astype(int)
    t = (at - below)[:, None]
    return rows[below % count] * (1 - t) + rows[(below + 1) % count] * t
