"""Reads what this project's .glb files hold: one buffer, accessors without sparse parts, embedded images."""

import io
import json
import struct

import numpy as np
from PIL import Image

COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Glb:
    def __init__(self, path):
        data = open(path, "rb").read()
        length = struct.unpack_from("<I", data, 12)[0]
        self.json = json.loads(data[20 : 20 + length])
        self.binary = data[20 + length + 8 :]

    def accessor(self, index):
        """Array of (count, width)."""
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        width = WIDTHS[accessor["type"]]
        values = np.frombuffer(self.binary, COMPONENTS[accessor["componentType"]], accessor["count"] * width, start)
        return values.reshape(-1, width)

    def image(self, texture):
        """RGBA in 0 to 1 as stored, rows from the top."""
        view = self.json["bufferViews"][self.json["images"][self.json["textures"][texture]["source"]]["bufferView"]]
        start = view.get("byteOffset", 0)
        picture = Image.open(io.BytesIO(self.binary[start : start + view["byteLength"]]))
        return np.asarray(picture.convert("RGBA"), np.float32) / 255

    def placed_nodes(self):
        """(node, object-to-world matrix) of every node of the scene, as it stands at time 0."""
        waiting = [(root, np.eye(4)) for root in self.json["scenes"][self.json.get("scene", 0)]["nodes"]]
        while waiting:
            index, parent = waiting.pop()
            node = self.json["nodes"][index]
            world = parent @ local_matrix(node)
            waiting += [(child, world) for child in node.get("children", [])]
            yield node, world


def local_matrix(node):
    if "matrix" in node:
        return np.array(node["matrix"]).reshape(4, 4).T
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = rotation * np.array(node.get("scale", [1, 1, 1]))
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return matrix
