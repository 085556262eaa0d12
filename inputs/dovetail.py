#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Mesh of a blade's dovetail root in its disc slot: writes dovetail.exo beside this script.

    python3 -m venv venv && venv/bin/pip install gmsh netCDF4 numpy && venv/bin/python inputs/dovetail.py

gmsh's Python package needs on Debian: apt-get install libglu1-mesa libgl1 libxrender1 libxcursor1 libxft2 libxinerama1 libgomp1

Units: mm.  x tangential, y radial (the engine's axis is the line x = 0, y = -300), z axial.
The section is drawn in x-y and swept along z; the slot, and with it the root, is broached at
SKEW degrees to the axis.  Root and slot meet on two flanks; past both edges of a flank each of
the two continues as a fillet of its own, tangent to the flank, so that contact ends on an arc:

    neck fillet of the root  R 3.5   against the lobe's nose    R 1.5     (upper edge, A)
    bulb of the root         R 2.2   against the slot's fillet  R 3.0     (lower edge, B)

The flanks' nodes are shared in gmsh's mesh and doubled on writing: node-to-node contact.
"""
import math
import pathlib
import sys

import gmsh
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "drivers"))
from haptos_exodus import write_exodus  # noqa: E402
from haptos_from_gmsh import from_gmsh  # noqa: E402

FLANK_ANGLE = 40.0      # of the flank to the radial direction, degrees
FLANK_LENGTH = 6.0
FLANK_CENTRE = (8.5, 0.0)
FLANK_ELEMENTS = 12
STRIP, STRIP_LAYERS = 2.0, 4   # squares along the flanks, in both bodies: depth and layers
LENGTH = 30.0           # of the slot, along z
LAYERS = 11
SKEW = 8.0              # of the slot to the axis, degrees
HALF_PITCH = 19.6
DISC_BOTTOM, RIM = -24.0, 8.0
PLATFORM = (12.0, 15.0)
PLATFORM_HALF_WIDTH = 15.0
BLADE_TOP, BLADE_HALF_WIDTH = 28.0, 2.5
FINE, COARSE, SIZE = 0.65, 3.2, 1.0   # lengths of edges at the flanks and far from them; factor on all sizes


class Section:
    """Points and curves of the right half; every one has a mirror image on the left."""

    def __init__(self):
        self._points = {}

    def point(self, x, y, size):
        key = (round(x, 9), round(y, 9))
        if key not in self._points:
            self._points[key] = gmsh.model.geo.addPoint(x, y, -LENGTH / 2, size)
        return self._points[key]

    def chain(self, steps, mirror):
        """Curves through the steps (x, y, size[, centre of the arc that leads there])."""
        sign = -1 if mirror else 1
        curves, last, before = [], None, None
        for x, y, size, *centre in steps:
            here = self.point(sign * x, y, size)
            if last is not None and centre:
                middle = self.point(sign * centre[0][0], centre[0][1], size)
                curves.append(gmsh.model.geo.addCircleArc(last, middle, here))
            elif last is not None:
                curves.append(gmsh.model.geo.addLine(last, here))
            if last is not None:
                divide(curves[-1], arc_length(before, (x, y), *centre), before[2], size)
            last, before = here, (x, y, size)
        return curves


def arc_length(start, end, middle=None):
    chord = math.dist(start[:2], end)
    return chord if middle is None else 2 * math.dist(end, middle) * math.asin(chord / (2 * math.dist(end, middle)))


def divide(curve, length, first, last):
    """An even number of graded elements: only then does the boundary carry a mesh of quadrangles alone."""
    count = 2 * max(1, round(length / (SIZE * (first + last))))
    ratio = (last / first) ** (1 / (count - 1))
    gmsh.model.geo.mesh.setTransfiniteCurve(curve, count + 1, "Progression", ratio)


def flank_ends():
    """A (upper, inner), B (lower, outer) and the root's outward normal on the right flank."""
    s, c = math.sin(math.radians(FLANK_ANGLE)), math.cos(math.radians(FLANK_ANGLE))
    x, y = FLANK_CENTRE
    h = FLANK_LENGTH / 2
    return (x - h * s, y + h * c), (x + h * s, y - h * c), (c, s)


def centre(point, normal, radius):
    """Centre of the arc tangent to the flank at this point; a negative radius puts it below the flank."""
    return point[0] + radius * normal[0], point[1] + radius * normal[1]


def root_steps():
    """Right half of the root, from the stub's top to A, and from B to the middle of the bottom."""
    a, b, n = flank_ends()
    neck, bulb = centre(a, n, 3.5), centre(b, n, -2.2)
    low, high, r = *PLATFORM, 2.0
    wall = neck[0] - 3.5
    above = [(0, BLADE_TOP, 1.6), (BLADE_HALF_WIDTH, BLADE_TOP, 1.6), (BLADE_HALF_WIDTH, high + r, 0.8),
             (BLADE_HALF_WIDTH + r, high, 0.8, (BLADE_HALF_WIDTH + r, high + r)),
             (PLATFORM_HALF_WIDTH, high, 1.8), (PLATFORM_HALF_WIDTH, low, 1.8),
             (wall + r, low, 0.8), (wall, low - r, 0.8, (wall + r, low - r)),
             (wall, neck[1], FINE), (*a, FINE, neck)]
    below = [(*b, FINE), (bulb[0] + 2.2, bulb[1], FINE, bulb), (bulb[0], bulb[1] - 2.2, 0.9, bulb), (0, bulb[1] - 2.2, 1.8)]
    return above, below


def disc_steps():
    """Right half of the slot, from the middle of its bottom to B, from A over the lobe and round the sector."""
    a, b, n = flank_ends()
    nose, slot = centre(a, n, 1.5), centre(b, n, -3.0)
    wall, r = nose[0] - 1.5, 1.2
    below = [(0, slot[1] - 3, 1.8), (slot[0], slot[1] - 3, 0.9), (slot[0] + 3, slot[1], FINE, slot), (*b, FINE, slot)]
    above = [(*a, FINE), (wall, nose[1], FINE, nose), (wall, RIM - r, 0.9), (wall + r, RIM, 0.9, (wall + r, RIM - r)),
             (HALF_PITCH, RIM, 2.4), (HALF_PITCH, DISC_BOTTOM, COARSE), (0, DISC_BOTTOM, COARSE)]
    return below, above


def strip_steps(depth):
    """Depth of the strip of squares along the flank: A to A' to B' to B; negative depth is in the root."""
    a, b, n = flank_ends()
    return [(*a, FINE), (*centre(a, n, depth), FINE), (*centre(b, n, depth), FINE), (*b, FINE)]


def plane_surface(curves):
    return gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(curves, reorient=True)])


def draw():
    """The sections {body: surfaces}; the two bodies share the flanks."""
    section = Section()
    a, b, _ = flank_ends()
    sections = {"root": [], "disc": []}
    loops = {"root": [], "disc": []}
    for mirror in (False, True):
        flank = section.chain([(*a, FINE), (*b, FINE)], mirror)
        for body, steps, depth in (("root", root_steps(), -STRIP), ("disc", disc_steps(), STRIP)):
            strip = section.chain(strip_steps(depth), mirror)
            for curve, count in zip(flank + strip, (FLANK_ELEMENTS, STRIP_LAYERS, FLANK_ELEMENTS, STRIP_LAYERS)):
                gmsh.model.geo.mesh.setTransfiniteCurve(curve, count + 1)
            sections[body].append(plane_surface(flank + strip))
            gmsh.model.geo.mesh.setTransfiniteSurface(sections[body][-1])
            loops[body] += [*section.chain(steps[0], mirror), *section.chain(steps[1], mirror), *strip]
    for body, loop in loops.items():
        sections[body].append(plane_surface(loop))
    return sections


def layer_heights():
    """Relative heights of the layers, thinner towards both faces of the slot."""
    t = np.linspace(-1, 1, LAYERS + 1)
    return ((t + 0.12 * np.sin(math.pi * t) + 1) / 2)[1:]


def name_surfaces(volumes):
    """Physical surfaces; the swept ones are told by where they lie."""
    owned = {body: {tag for _, tag in gmsh.model.getBoundary([(3, v) for v in tags], oriented=False)} for body, tags in volumes.items()}
    named = {}
    for body, tags in owned.items():
        for tag in sorted(tags):
            name = surface_name(body, gmsh.model.getBoundingBox(2, tag))
            if tag in owned["root"] and tag in owned["disc"]:
                name = "flank_right" if gmsh.model.getBoundingBox(2, tag)[0] > 0 else "flank_left"
            if name:
                named.setdefault(name, set()).add(tag)
    for name in sorted(named):
        gmsh.model.addPhysicalGroup(2, sorted(named[name]), name=name)


def surface_name(body, box):
    low, high = np.array(box[:3]), np.array(box[3:])
    flat = high - low < 1e-3
    planes = {"root": {"front": (2, LENGTH / 2), "back": (2, -LENGTH / 2), "top": (1, BLADE_TOP)},
              "disc": {"front": (2, LENGTH / 2), "back": (2, -LENGTH / 2), "inner": (1, DISC_BOTTOM),
                       "cut_left": (0, -HALF_PITCH), "cut_right": (0, HALF_PITCH)}}
    for name, (axis, position) in planes[body].items():
        if flat[axis] and abs(low[axis] - position) < 1e-3:
            return f"{body}_{name}"
    return None


def build():
    gmsh.model.add("dovetail root in its disc slot")
    sections = draw()
    volumes = {"root": [], "disc": []}
    for body, surfaces in sections.items():
        swept = gmsh.model.geo.extrude([(2, s) for s in surfaces], 0, 0, LENGTH, [1] * LAYERS, list(layer_heights()), recombine=True)
        volumes[body] = [tag for dim, tag in swept if dim == 3]
    gmsh.model.geo.synchronize()
    for body, tags in volumes.items():
        gmsh.model.addPhysicalGroup(3, tags, name=body)
        for surface in sections[body]:
            gmsh.model.mesh.setRecombine(2, surface)
    name_surfaces(volumes)
    gmsh.option.setNumber("Mesh.Algorithm", 8)                # frontal, for quadrangles
    gmsh.option.setNumber("Mesh.RecombinationAlgorithm", 2)   # quadrangles only
    gmsh.option.setNumber("Mesh.Smoothing", 10)
    gmsh.model.mesh.generate(3)


def skew(mesh):
    """Shears x along z: the whole root and the slot by SKEW degrees, fading out to the sector's cut faces."""
    x = mesh.coordinates
    fade = np.clip((HALF_PITCH - np.abs(x[:, 0])) / (HALF_PITCH - 12.0), 0, 1)
    fade[mesh.blocks[0].connectivity.ravel()] = 1.0
    x[:, 0] += math.tan(math.radians(SKEW)) * x[:, 2] * fade * 1.0


def main():
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    build()
    mesh = from_gmsh(split=("flank_left", "flank_right"))
    gmsh.finalize()
    skew(mesh)
    mesh.node_numbers = None              # 1..n, rather than gmsh's tags
    for block in mesh.blocks:
        block.element_numbers = None
    write_exodus(HERE / "dovetail.exo", mesh)
    print(f"dovetail.exo: {len(mesh.coordinates)} nodes, {sum(len(b.connectivity) for b in mesh.blocks)} elements")


if __name__ == "__main__":
    main()
