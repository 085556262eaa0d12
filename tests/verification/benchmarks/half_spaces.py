# SPDX-License-Identifier: BSD-3-Clause
"""Two elastic half spaces of one material, the upper one slightly curved: scene of Hertz, Cattaneo and Mindlin.

Cubes of SIZE contact radii stand for the half spaces; their outer faces move as the half spaces would there under the
resultant force of the theory (Boussinesq, Cerruti, Flamant), the upper one also by the rigid approach and shift.  So what the
size cuts off is of the order (a / SIZE)^3, and the forces that the contact gives remain to be checked.
Contact radius a = 1, radius of curvature CURVATURE.  A line contact lies along y, one element thick, in plane strain; its
displacements are those relative to points at the distance 1.
"""
import dataclasses

import numpy as np

from runs import contact, displacement, material, solve
from haptos_grids import brick, graded

SIZE, CURVATURE, REACH, DEPTH = 6.0, 1000.0, 1.25, 1.0   # REACH, DEPTH: of the even part of the mesh
THICKNESS = 0.3                                          # of a line contact; thinner elements cost multiplications


@dataclasses.dataclass
class Load:
    """Approach; normal force, tangential force and shift along x and y of the theory; material."""
    young: float
    poisson: float
    friction: tuple = None
    tangential: tuple = (0.0, 0.0)
    shift: tuple = (0.0, 0.0)
    line: bool = False

    @property
    def shear(self):
        return self.young / (2 * (1 + self.poisson))

    @property
    def modulus(self):
        """E* of two bodies of this material."""
        return self.young / (2 * (1 - self.poisson ** 2))

    @property
    def approach(self):
        return 2 * (1 - self.poisson) * self.normal / (np.pi * self.shear) * (0.5 + np.log(2)) if self.line else 1 / CURVATURE

    @property
    def normal(self):
        """Of a line contact per length."""
        return (np.pi / 4 if self.line else 4 / 3) * self.modulus / CURVATURE

    @property
    def peak(self):
        return (0.5 if self.line else 2 / np.pi) * self.modulus / CURVATURE


def far_field(load, upper):
    """Displacement of the outer faces, expressions of x, y, z."""
    depth, rho, k = ("z" if upper else "(0-z)"), "sqrt(x*x+y*y+z*z)", 1 - 2 * load.poisson
    if load.line:
        return line_field(load, upper, depth)
    per = 1 / (4 * np.pi * load.shear)
    P, Q = load.normal * per, [(-1 if upper else 1) * q * per for q in load.tangential]
    inwards = f"{depth}/{rho}^3 - {k}/({rho}*({rho}+{depth}))"           # u_r / r of Boussinesq
    across = f"(1/{rho}^3 - {k}/({rho}*({rho}+{depth})^2))"              # Cerruti: u_x = Q (1/rho + k/(rho+z) + x^2 across)
    along = f"(1/{rho} + {k}/({rho}+{depth}))"
    down = f"({depth}/{rho}^3 + {k}/({rho}*({rho}+{depth})))"
    sums = [f"{P}*x*({inwards}) + {Q[0]}*({along} + x*x*{across}) + {Q[1]}*x*y*{across}",
            f"{P}*y*({inwards}) + {Q[1]}*({along} + y*y*{across}) + {Q[0]}*x*y*{across}",
            f"{P}*({2 * (1 - load.poisson)}/{rho} + {depth}^2/{rho}^3) + ({Q[0]}*x + {Q[1]}*y)*{down}"]
    if not upper:
        return [sums[0], sums[1], f"0-({sums[2]})"]
    return [f"{load.shift[0]} + {sums[0]}", f"{load.shift[1]} + {sums[1]}", f"({sums[2]}) - {load.approach}"]


def line_field(load, upper, depth):
    """Flamant: u_x = P' (x z / rho^2 - (1 - 2 nu) atan(x / z)), u_z = P' (z^2 / rho^2 - 2 (1 - nu) ln rho), P' = P / (2 pi G)."""
    P, rho2 = load.normal / (2 * np.pi * load.shear), "(x*x+z*z)"
    across = f"{P}*(x*{depth}/{rho2} - {1 - 2 * load.poisson}*atan2(x, {depth}))"
    down = f"{P}*(z*z/{rho2} - {1 - load.poisson}*log({rho2}))"
    return [across, "0", f"{down} - {load.approach}" if upper else f"0-({down})"]


def block(shape, n, upper, mirrored, thickness=None):
    """n: elements a contact radius.  :param mirrored: axes along which both halves are modelled
    :param thickness: of a line contact"""
    line = thickness is not None
    half = graded(max(2, round(REACH * n)), REACH, SIZE)
    axes = [np.concatenate([-half[:0:-1], half]) if axis in mirrored else half for axis in "xy"]
    if line:
        axes[1] = np.array([0, thickness])
    depth = graded(max(1, round(0.75 * DEPTH * n)), DEPTH, SIZE)
    names = {f"{axis}-": "outer" if axis in mirrored else f"on_{axis}" for axis in "xy"}
    names |= {"x+": "outer", "y+": "on_y" if line else "outer"}
    side = "upper" if upper else "lower"
    names = {k: f"{side}_{v}" if v == "outer" else v for k, v in names.items()}

    def curved(p):
        return p + np.outer((p[:, 0] ** 2 + (0 if line else p[:, 1] ** 2)) / (2 * CURVATURE) * (1 - p[:, 2] / SIZE), [0, 0, 1])
    if upper:
        return brick(shape, [*axes, depth], {**names, "z-": "upper_contact", "z+": "upper_outer"}, curved)
    return brick(shape, [*axes, -depth[::-1]], {**names, "z+": "lower_contact", "z-": "lower_outer"})


def press(folder, shape, n, load, mirrored="", ratio=0.75, tolerance=1e-7, thickness=THICKNESS, **more):
    """Solves; n elements a contact radius above, n ratio below.  Axes that are not mirrored are planes of symmetry.

    :param more: of the contact
    """
    depth = thickness if load.line else None
    bodies = {"upper": block(shape, n, True, mirrored, depth), "lower": block(shape, n * ratio, False, mirrored, depth)}
    conditions = {f"far {b}": {"Type": "Displacement", "Sets": [f"{b}_outer"], "Components": "xyz", "Value": far_field(load, b == "upper")}
                  for b in bodies}
    conditions |= {f"symmetry {axis}": displacement([f"on_{axis}"], (0.0,), axis) for axis in "xy" if axis not in mirrored}
    return solve(folder, bodies, {"one": material(bodies, load.young, load.poisson)}, conditions,
                 {"joint": contact("upper_contact", "lower_contact", load.friction, Sides="As Given", **more)}, tolerance)


@dataclasses.dataclass
class Pressed:
    """Fit p^2 = p0^2 (1 - r^2 / a^2) over p > 0.3 p0, the forces, and the pressures it was made of."""
    peak: float
    radius: float
    forces: np.ndarray
    r: np.ndarray
    p: np.ndarray


def fitted(result, mirrored="", line=False):
    at = result.pressures(body=0)
    r2, p = (result.x[at, :1 if line else 2] ** 2).sum(axis=1), result.fields["contact_pressure"][at]
    inside = p > 0.3 * p.max()
    slope, peak2 = np.polyfit(r2[inside], p[inside] ** 2, 1)
    forces = result.contact_force(0) * (2 / THICKNESS if line else 4 / 2 ** len(mirrored))
    return Pressed(np.sqrt(peak2), np.sqrt(-peak2 / slope), forces, np.sqrt(r2), p)
