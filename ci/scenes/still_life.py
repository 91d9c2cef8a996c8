#!/usr/bin/env python3
"""Makes assets/scenes/still_life.glb: a table by a window in the evening, with a lamp, a plant, glass, copper, fruit and a spinning top.

Usage: still_life.py OUT.glb   (needs numpy and pillow)
"""

import math
import pathlib
import sys

import numpy as np

from gltf_writer import Document, box, lathe, look, merge, quad, turn

LAMBERT = {"specularFactor": 0.0}


def noise(shape, cells, seed, octaves=4):
    """Smooth noise in -1 to 1 that repeats, (height, width)."""
    generator = np.random.default_rng(seed)
    total = np.zeros(shape)
    for octave in range(octaves):
        grid = generator.uniform(-1, 1, (cells[0] << octave, cells[1] << octave))
        total += 0.5**octave * interpolate(interpolate(grid, shape[0]).T, shape[1]).T
    return total * 0.6


def interpolate(grid, count):
    at = (np.arange(count) + 0.5) / count * len(grid)
    below = np.floor(at).astype(int)
    t = (at - below)[:, None]
    t = t * t * (3 - 2 * t)
    return grid[below % len(grid)] * (1 - t) + grid[(below + 1) % len(grid)] * t


def mix(a, b, t):
    return np.array(a) * (1 - t[..., None]) + np.array(b) * t[..., None]


def wood():
    v, u = np.mgrid[0:256, 0:512] / np.array([256, 512]).reshape(2, 1, 1)
    grain = 0.5 + 0.5 * np.sin(2 * math.pi * (6 * v + 0.9 * noise((256, 512), (3, 2), 1) + 0.08 * np.sin(2 * math.pi * u)))
    fibre = noise((256, 512), (64, 4), 2, 2)
    return mix([0.52, 0.33, 0.2], [0.36, 0.2, 0.11], np.clip(grain + 0.25 * fibre, 0, 1))


def plaster():
    return np.array([0.74, 0.72, 0.68]) * (1 + 0.05 * noise((256, 256), (6, 6), 3, 5))[..., None]


def peel():
    return mix([0.93, 0.5, 0.08], [0.82, 0.34, 0.03], np.clip(0.5 + 0.6 * noise((128, 128), (16, 16), 4, 2), 0, 1))


def stripes():
    v = np.mgrid[0:64, 0:64][0] / 64
    return mix([0.75, 0.08, 0.07], [0.93, 0.88, 0.75], (v % 0.25 > 0.125).astype(float))


def hammered():
    """Roughness in green, metalness in blue."""
    roughness = 0.32 + 0.12 * noise((128, 128), (12, 12), 5, 3)
    return np.stack([np.zeros_like(roughness), roughness, np.ones_like(roughness)], 2)


def leaf():
    """Green with lighter veins; alpha is the leaf's shape, tip up."""
    v, u = (np.mgrid[0:256, 0:128] + 0.5) / np.array([256, 128]).reshape(2, 1, 1)
    along, across = 1 - v, np.abs(u - 0.5)
    width = 0.46 * np.sin(math.pi * np.clip(along, 0, 1) ** 0.8) ** 0.75 * (1 - 0.1 * np.abs(np.sin(14 * math.pi * along)))
    vein = np.maximum(1 - across * 60, 1 - np.abs(np.sin(8 * math.pi * (along - 0.7 * across))) * 9)
    color = mix([0.13, 0.33, 0.1], [0.36, 0.55, 0.22], np.clip(vein, 0, 1))
    return np.dstack([color, np.clip(0.5 + (width - across) * 128, 0, 1)])


def smooth(points, steps=12):
    """Catmull-Rom through the points of a profile."""
    p = np.array([points[0], *points, points[-1]], float)
    t = np.linspace(0, 1, steps, endpoint=False)[:, None]
    pieces = [
        0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)
        for a, b, c, d in zip(p, p[1:], p[2:], p[3:])
    ]
    return np.concatenate([*pieces, p[-2:-1]]).clip([0, -1], None)


def ball(radius, rings=32):
    angles = np.linspace(-math.pi / 2, math.pi / 2, rings + 1)
    return lathe(np.stack([np.cos(angles).clip(0) * radius, np.sin(angles) * radius], 1))


def leaf_card(length, width, droop, rows=8):
    """A strip that bends over; its stem at the origin."""
    angle = np.linspace(0, droop, rows + 1)
    step = length / rows
    y = np.concatenate([[0], np.cumsum(np.cos(angle[:-1]) * step)])
    z = np.concatenate([[0], np.cumsum(np.sin(angle[:-1]) * step)])
    positions = np.stack([np.stack([side * np.ones_like(y), y, z], 1) for side in (-width / 2, width / 2)], 1).reshape(-1, 3)
    normals = np.repeat(np.stack([np.zeros_like(y), -np.sin(angle), np.cos(angle)], 1), 2, 0)
    v = np.repeat(np.linspace(1, 0, rows + 1), 2)
    uvs = np.stack([np.tile([0, 1], rows + 1), v], 1)
    a = np.arange(rows) * 2
    return positions, normals, uvs, np.concatenate([np.stack([a, a + 1, a + 3], 1), np.stack([a, a + 3, a + 2], 1)])


def add_room(document):
    plank = {"scale": [1.0, 3.0], "rotation": 0.06, "offset": [0.1, 0.2]}
    table = document.add_material("wood", texture=document.add_texture("wood", wood(), "image/jpeg"), transform=plank, roughness=0.35)
    wall = document.add_material(
        "plaster", texture=document.add_texture("plaster", plaster(), "image/jpeg"), transform={"scale": [3, 2]}, specular=LAMBERT
    )
    top = quad((-0.8, 0, 0.45), (0.8, 0, 0.45), (0.8, 0, -0.4), (-0.8, 0, -0.4))
    edge = quad((-0.8, -0.04, 0.45), (0.8, -0.04, 0.45), (0.8, 0, 0.45), (-0.8, 0, 0.45))
    document.add_node("table", mesh=document.add_mesh("table", (merge(top, edge), table)))
    back = quad((-2, -0.8, -0.42), (2, -0.8, -0.42), (2, 1.5, -0.42), (-2, 1.5, -0.42))
    document.add_node("wall", mesh=document.add_mesh("wall", (back, wall)))
    sky = document.add_material(
        "window", (0, 0, 0), emissiveFactor=[0.55, 0.75, 1.0], emissive_strength={"emissiveStrength": 7.0}, specular=LAMBERT
    )
    window = quad((-1.5, 0.1, -0.3), (-1.1, 0.1, 0.7), (-1.1, 1.1, 0.7), (-1.5, 1.1, -0.3))[:3] + (np.array([[0, 2, 1], [0, 3, 2]]),)
    window = (window[0], -window[1], window[2], window[3])
    document.add_node("window", mesh=document.add_mesh("window", (window, sky)))


def add_lamp(document):
    brass = document.add_material("brass", (0.85, 0.65, 0.35), 1.0, 0.35)
    shade = document.add_material("shade", (0.75, 0.7, 0.6), roughness=0.5)
    stand = lathe([(0, 0.012), (0.075, 0.012), (0.078, 0.0)][::-1], 48, smooth=False)
    stem = lathe([(0.006, 0.012), (0.006, 0.36)], 16)
    cone = lathe([(0.128, 0.3), (0.13, 0.3), (0.05, 0.42), (0.048, 0.42), (0.128, 0.3)], 160, smooth=False)
    mesh = document.add_mesh("lamp", (merge(stand, stem), brass), (cone, shade))
    lamp = document.add_node("lamp", mesh=mesh, translation=[0.37, 0, -0.2])
    light = document.add_light(type="point", name="bulb", color=[1.0, 0.62, 0.3], intensity=0.6, extras={"radius": 0.06})
    document.add_node("bulb", lamp, translation=[0, 0.325, 0.055], extensions=light)


def add_plant(document):
    clay = document.add_material("clay", (0.55, 0.25, 0.15), specular=LAMBERT)
    soil = document.add_material("soil", (0.06, 0.045, 0.035), specular=LAMBERT)
    pot = lathe([(0, 0), (0.05, 0), (0.065, 0.1), (0.075, 0.1), (0.075, 0.115), (0.064, 0.115), (0.062, 0.1)], 48, smooth=False)
    earth = lathe([(0.062, 0.101), (0, 0.101)], 48)
    plant = document.add_node("plant", mesh=document.add_mesh("pot", (pot, clay), (earth, soil)), translation=[-0.06, 0, -0.24])
    green = document.add_material(
        "leaf", texture=document.add_texture("leaf", leaf()), specular=LAMBERT, alphaMode="MASK", alphaCutoff=0.5, doubleSided=True
    )
    mesh = document.add_mesh("leaf", (leaf_card(0.2, 0.07, 1.5), green))
    generator = np.random.default_rng(6)
    for i in range(22):
        size = float(generator.uniform(0.7, 1.15))
        lean = np.array(turn([1, 0, 0], generator.uniform(0, 45)))
        heading = np.array(turn([0, 1, 0], i * 137.5))
        # Every second leaf is mirrored.
        scale = [size * (-1) ** i, size, size]
        document.add_node(f"leaf {i}", plant, mesh=mesh, translation=[0, 0.095, 0], rotation=multiply(heading, lean), scale=scale)


def multiply(a, b):
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    product = [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
    return [float(x) for x in product]


def add_glass(document):
    glass = document.add_material(
        "glass", roughness=0.0, transmission={"transmissionFactor": 1.0}, volume={"thicknessFactor": 0.01}, ior={"ior": 1.5}
    )
    outside = smooth([(0, 0), (0.045, 0.001), (0.052, 0.02), (0.04, 0.08), (0.05, 0.17), (0.06, 0.215), (0.0575, 0.22)])
    inside = smooth([(0.0575, 0.22), (0.054, 0.213), (0.044, 0.17), (0.034, 0.08), (0.04, 0.03), (0, 0.022)])
    vase = lathe(np.concatenate([outside, inside[1:]]), 96)
    document.add_node("vase", mesh=document.add_mesh("vase", (vase, glass)), translation=[-0.3, 0.0625, -0.1])
    marble = document.add_mesh("marble", (ball(0.018, 24), glass))
    for i, (x, z) in enumerate([(0.2, 0.19), (0.255, 0.15), (0.25, 0.22)]):
        document.add_node(f"marble {i}", mesh=marble, translation=[x, 0.018, z])


def add_metal(document):
    copper = document.add_material("copper", (0.95, 0.62, 0.48), roughness_texture=document.add_texture("hammered", hammered()), metallic=1.0)
    bowl = smooth([(0, 0.004), (0.03, 0.004), (0.035, 0.0), (0.045, 0.006), (0.085, 0.035), (0.105, 0.075), (0.107, 0.078)])
    inside = smooth([(0.107, 0.078), (0.102, 0.074), (0.08, 0.036), (0.04, 0.012), (0, 0.009)])
    mesh = document.add_mesh("bowl", (lathe(np.concatenate([bowl, inside[1:]]), 96), copper))
    document.add_node("bowl", mesh=mesh, translation=[0.12, 0, -0.02])
    chrome = document.add_material("chrome", (0.93, 0.94, 0.95), 1.0, 0.0)
    document.add_node("chrome ball", mesh=document.add_mesh("chrome ball", (ball(0.035, 48), chrome)), translation=[-0.12, 0.035, 0.16])


def add_fruit_and_books(document):
    orange = document.add_material("peel", texture=document.add_texture("peel", peel(), "image/jpeg"), roughness=0.45)
    mesh = document.add_mesh("orange", (ball(0.038), orange))
    for i, (x, y, z) in enumerate([(0.09, 0.052, -0.05), (0.15, 0.052, -0.06), (0.13, 0.055, 0.015), (0.36, 0.038, 0.1)]):
        document.add_node(f"orange {i}", mesh=mesh, translation=[x, y, z], rotation=turn([1, 0.3, 0.5], 70 * i))
    book = box((-0.5, 0, -0.5), (0.5, 1, 0.5))
    for name, color, height, degrees, y in [("red book", (0.35, 0.05, 0.05), 0.034, 12, 0.0), ("blue book", (0.05, 0.12, 0.25), 0.028, -7, 0.034)]:
        cover = document.add_material(name, color, roughness=0.6)
        mesh = document.add_mesh(name, (book, cover))
        document.add_node(name, mesh=mesh, translation=[-0.3, y, -0.1], rotation=turn([0, 1, 0], degrees), scale=[0.2, height, 0.15])


def add_spinning_top(document):
    """Stands at time 0 as the file says, then turns and precesses, once in 4 seconds."""
    bands = {"scale": [1.0, 1.0], "offset": [0.0, 0.06]}
    paint = document.add_material("paint", texture=document.add_texture("stripes", stripes(), filters=(9728, 9728)), transform=bands, roughness=0.2)
    profile = smooth([(0, 0), (0.006, 0.004), (0.03, 0.03), (0.045, 0.045), (0.03, 0.056), (0.006, 0.062), (0.005, 0.085), (0, 0.087)])
    times = [i * 0.25 for i in range(17)]
    turns = [multiply(multiply(turn([0, 1, 0], 90 * t), turn([0, 0, 1], -12)), turn([0, 1, 0], 450 * t)) for t in times]
    node = document.add_node("spinning top", mesh=document.add_mesh("spinning top", (lathe(profile), paint)), translation=[0.04, 0.0, 0.22], rotation=turns[0])
    document.animate(node, "rotation", times, turns)


def main(path):
    document = Document("still life")
    for add in (add_room, add_lamp, add_plant, add_glass, add_metal, add_fruit_and_books, add_spinning_top):
        add(document)
    eye, target = (0.07, 0.36, 1.03), (0.03, 0.137, -0.08)
    camera = document.add("cameras", {"type": "perspective", "perspective": {"yfov": 0.48, "znear": 0.01}})
    document.add_node("camera", camera=camera, translation=list(eye), rotation=look(eye, target))
    document.write(path)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
