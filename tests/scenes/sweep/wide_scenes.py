# SPDX-License-Identifier: BSD-3-Clause
"""Families of scenes beyond those of random_scenes.draw, which stay what they are for a seed."""
import dataclasses
import math

import gmsh  # noqa: F401  here, so that who lacks it learns so at once
import numpy as np

import random_scenes
from random_scenes import BodyMesh

FAMILIES = ("incompressible", "slender", "mortar", "quadratic", "mixed")
_QUADRATIC = ("TETRA10", "HEX20", "HEX27")
_NODES = 2500   # of a body, about


def draw(seed, index):
    """Scene number `index` of this seed; families take turns.

    incompressible: nu up to .4999 in one body at least.  slender: bodies and elements with aspects of 1 to 100.  mortar: bodies in linear
    meshes of unlike sizes and shapes, structured or free.  quadratic: matching meshes of quadratic elements.  mixed: all of it at once.
    """
    rng = np.random.default_rng([seed, index, 1])
    family = FAMILIES[index % len(FAMILIES)]
    scene = random_scenes.draw(seed, int(rng.integers(1 << 30)))      # bodies, law, supports
    scene = dataclasses.replace(scene, family=family)
    if family == "slender" or (family == "mixed" and rng.random() < 0.5):
        scene = _slender(scene, rng)
    scene.meshes = _meshes(scene, rng)
    if family == "incompressible" or (family == "mixed" and rng.random() < 0.5):
        scene.poisson = _incompressible(scene, rng)
    return random_scenes.loaded(scene, rng)


def _slender(scene, rng):
    """Plates, needles or towers of one aspect in elements of another, as far as _NODES allow; where they bend stiff enough not to be bent double."""
    aspect, stretch = 10 ** rng.uniform(0, 2, 2)
    kind = str(rng.choice(["plates", "needles", "towers"]))
    thin = {"plates": (0, 0, 1), "needles": (0, 1, 1), "towers": (1, 1, 0)}[kind]
    size = tuple(1 / aspect if is_thin else 1.0 for is_thin in thin)
    across = (_NODES / (aspect / stretch) ** (3 - sum(thin))) ** (1 / 3)     # elements; along: aspect / stretch times as many
    most = {"plates": 44 if rng.random() < 0.1 else 20, "needles": 60, "towers": 60}[kind]        # 2000 pairs now and then
    counts = tuple(int(min(20 if is_thin else most, max(2 - is_thin, round(across * (1 if is_thin else aspect / stretch))))) for is_thin in thin)
    stiffer = aspect ** 3 if kind != "towers" and scene.held != "contact" else 1.0
    return dataclasses.replace(scene, shape=kind, size=size, meshes=[BodyMesh(scene.meshes[0].shape, counts)] * scene.bodies,
                               young=[float(E * stiffer) for E in scene.young], gap=scene.gap * min(size))


def _meshes(scene, rng):
    counts = scene.meshes[0].elements
    if scene.family == "quadratic":
        return [_fitted(str(rng.choice(_QUADRATIC)), counts)] * scene.bodies
    if scene.family in ("incompressible", "slender"):
        shapes = ("HEX8", "HEX8", "HEX8", "HEX20", "TETRA10") if scene.family == "incompressible" else ("HEX8", "HEX8", "TETRA4")
        return [_fitted(str(rng.choice(shapes)), counts)] * scene.bodies
    shapes = ("HEX8", "HEX8", "TETRA4") if scene.family == "mortar" else ("HEX8", "TETRA4", *_QUADRATIC)
    meshes = []
    for _ in range(scene.bodies):
        shape, finer = str(rng.choice(shapes)), 10 ** rng.uniform(-0.4, 0.4)
        is_free = shape.startswith("TETRA") and rng.random() < 0.7
        meshes.append(_fitted(shape, tuple(max(1, round(n * finer)) for n in counts), is_free))
        if len(meshes) > 1 and meshes[-1].elements[:2] == meshes[-2].elements[:2]:
            a, b, c = meshes[-1].elements
            meshes[-1] = dataclasses.replace(meshes[-1], elements=(a + 1, b, c))
    return meshes


def _fitted(shape, counts, is_free=False):
    """The same in coarser elements where they would have more nodes than asked for."""
    nodes = {"HEX8": 1, "TETRA4": 1, "TETRA10": 8, "HEX20": 4, "HEX27": 8}[shape] * math.prod(counts)
    factor = min(1.0, (_NODES / nodes) ** (1 / 3))
    return BodyMesh(shape, tuple(max(1, round(n * factor)) for n in counts), is_free)


def _incompressible(scene, rng):
    """0.5 - nu from 1e-4 to 0.1; linear tetrahedra, which lock there, keep what they have."""
    return [nu if mesh.shape == "TETRA4" else float(0.5 - 10 ** rng.uniform(-4, -1)) for nu, mesh in zip(scene.poisson, scene.meshes)]
