"""A glTF 2.0 document with one buffer and embedded images, written as .glb; and surfaces to put into it."""

import io
import json
import math
import struct

import numpy as np
from PIL import Image


class Document:
    """`add_*` returns the index of what was added."""

    def __init__(self, name):
        self.json = {"asset": {"version": "2.0", "generator": "pathspace"}, "scene": 0, "scenes": [{"name": name, "nodes": []}]}
        self.binary = bytearray()

    def add(self, array, item):
        self.json.setdefault(array, []).append(item)
        return len(self.json[array]) - 1

    def add_view(self, data, **more):
        self.binary += b"\0" * (-len(self.binary) % 4)
        self.binary += data
        return self.add("bufferViews", {"buffer": 0, "byteOffset": len(self.binary) - len(data), "byteLength": len(data), **more})

    def add_accessor(self, values, kind, component, bounds=False, **more):
        accessor = {"bufferView": self.add_view(values.tobytes(), **more), "componentType": component, "count": len(values), "type": kind}
        if bounds:
            accessor |= {"min": values.min(0).tolist(), "max": values.max(0).tolist()}
        return self.add("accessors", accessor)

    def add_mesh(self, name, *primitives):
        """Each primitive is (surface, material)."""
        described = []
        for (positions, normals, uvs, triangles), material in primitives:
            assert len(positions) < 65536
            attributes = {
                "POSITION": self.add_accessor(positions.astype("<f4"), "VEC3", 5126, bounds=True, target=34962),
                "NORMAL": self.add_accessor(normals.astype("<f4"), "VEC3", 5126, target=34962),
                "TEXCOORD_0": self.add_accessor(uvs.astype("<f4"), "VEC2", 5126, target=34962),
            }
            indices = self.add_accessor(triangles.astype("<u2").ravel(), "SCALAR", 5123, target=34963)
            described.append({"attributes": attributes, "indices": indices, "material": material})
        return self.add("meshes", {"name": name, "primitives": described})

    def add_node(self, name, parent=None, **more):
        index = self.add("nodes", {"name": name, **more})
        if parent is None:
            self.json["scenes"][0]["nodes"].append(index)
        else:
            self.json["nodes"][parent].setdefault("children", []).append(index)
        return index

    def add_light(self, **light):
        lights = self.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append(light)
        return {"KHR_lights_punctual": {"light": len(lights) - 1}}

    def add_texture(self, name, pixels, mime="image/png", filters=(9729, 9987)):
        """`pixels`: array of (height, width, 3 or 4) in 0 to 1, as stored."""
        stored = io.BytesIO()
        picture = Image.fromarray((np.clip(pixels, 0, 1) * 255 + 0.5).astype(np.uint8))
        picture.save(stored, mime.removeprefix("image/"), **({"quality": 88} if mime == "image/jpeg" else {"optimize": True}))
        source = self.add("images", {"name": name, "mimeType": mime, "bufferView": self.add_view(stored.getvalue())})
        sampler = {"magFilter": filters[0], "minFilter": filters[1], "wrapS": 10497, "wrapT": 10497}
        samplers = self.json.setdefault("samplers", [])
        if sampler not in samplers:
            samplers.append(sampler)
        return self.add("textures", {"name": name, "source": source, "sampler": samplers.index(sampler)})

    def add_material(self, name, color=(1, 1, 1), metallic=0.0, roughness=1.0, texture=None, transform=None, **more):
        """`transform` is KHR_texture_transform of `texture`; `more` goes into the material, extensions by their short names."""
        pbr = {"baseColorFactor": [*color, 1], "metallicFactor": metallic, "roughnessFactor": roughness}
        if texture is not None:
            pbr["baseColorTexture"] = {"index": texture}
            if transform:
                pbr["baseColorTexture"]["extensions"] = {"KHR_texture_transform": transform}
        if "roughness_texture" in more:
            pbr["metallicRoughnessTexture"] = {"index": more.pop("roughness_texture")}
        extensions = {"KHR_materials_" + key: more.pop(key) for key in list(more) if isinstance(more[key], dict)}
        return self.add("materials", {"name": name, "pbrMetallicRoughness": pbr, **({"extensions": extensions} if extensions else {}), **more})

    def animate(self, node, path, times, values):
        times, values = np.array(times, "<f4")[:, None], np.array(values, "<f4")
        sampler = {
            "input": self.add_accessor(times, "SCALAR", 5126, bounds=True),
            "output": self.add_accessor(values, "VEC4" if path == "rotation" else "VEC3", 5126),
        }
        animation = self.json.setdefault("animations", [{"samplers": [], "channels": []}])[0]
        animation["samplers"].append(sampler)
        animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": {"node": node, "path": path}})

    def write(self, path):
        used = set(extension_names(self.json))
        self.json |= {"extensionsUsed": sorted(used), "buffers": [{"byteLength": len(self.binary)}]}
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        self.binary += b"\0" * (-len(self.binary) % 4)
        header = struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(self.binary))
        chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(self.binary), b"BIN\0") + self.binary
        path.write_bytes(header + chunks)


def extension_names(value):
    if isinstance(value, dict):
        yield from value.get("extensions", {})
    for item in value.values() if isinstance(value, dict) else value if isinstance(value, list) else []:
        yield from extension_names(item)


def lathe(profile, segments=64, smooth=True):
    """Surface around y of a profile of (radius, height), bottom up on the outside. Where not smooth, each section has normals of its own."""
    profile = np.array(profile, float)
    if not smooth:
        return merge(*(lathe(profile[i : i + 2], segments) for i in range(len(profile) - 1)))
    along = np.gradient(profile, axis=0)
    normals = np.stack([along[:, 1], -along[:, 0]], 1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    angle = np.linspace(0, 2 * math.pi, segments + 1)
    around = lambda pairs: np.stack(
        [pairs[:, :1] * np.sin(angle), np.repeat(pairs[:, 1:], segments + 1, 1), pairs[:, :1] * np.cos(angle)], 2
    ).reshape(-1, 3)
    v, u = np.meshgrid(np.linspace(1, 0, len(profile)), np.linspace(0, 1, segments + 1), indexing="ij")
    row, column = np.meshgrid(np.arange(len(profile) - 1), np.arange(segments), indexing="ij")
    a = (row * (segments + 1) + column).ravel()
    b = a + segments + 1
    triangles = np.concatenate([np.stack([a, a + 1, b + 1], 1), np.stack([a, b + 1, b], 1)])
    positions = around(profile)
    return positions, around(normals), np.stack([u.ravel(), v.ravel()], 1), without_degenerate(positions, triangles)


def without_degenerate(positions, triangles):
    a, b, c = (positions[triangles[:, i]] for i in range(3))
    return triangles[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-12]


def quad(*corners):
    """Counter-clockwise from the lower left."""
    corners = np.array(corners, float)
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normals = np.tile(normal / np.linalg.norm(normal), (4, 1))
    return corners, normals, np.array([[0, 1], [1, 1], [1, 0], [0, 0]], float), np.array([[0, 1, 2], [0, 2, 3]])


def box(low, high):
    corner = lambda i: [(low, high)[i >> axis & 1][axis] for axis in range(3)]
    faces = [(0, 4, 6, 2), (5, 1, 3, 7), (0, 1, 5, 4), (6, 7, 3, 2), (1, 0, 2, 3), (4, 5, 7, 6)]
    return merge(*(quad(*map(corner, face)) for face in faces))


def merge(*surfaces):
    offsets = np.cumsum([0] + [len(surface[0]) for surface in surfaces])
    arrays = [np.concatenate([surface[i] for surface in surfaces]) for i in range(3)]
    return *arrays, np.concatenate([surface[3] + offset for surface, offset in zip(surfaces, offsets)])


def turn(axis, degrees):
    """Quaternion x, y, z, w."""
    half = math.radians(degrees) / 2
    axis = np.array(axis, float) / np.linalg.norm(axis)
    return [*(axis * math.sin(half)).tolist(), math.cos(half)]


def look(eye, target):
    """Quaternion that turns -z from `eye` to `target`, +y up."""
    z = np.array(eye, float) - np.array(target, float)
    z /= np.linalg.norm(z)
    x = np.cross([0, 1, 0], z)
    x /= np.linalg.norm(x)
    m = np.stack([x, np.cross(z, x), z], 1)
    w = math.sqrt(max(0, 1 + np.trace(m))) / 2
    return [*(np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]]) / (4 * w)).tolist(), w]
