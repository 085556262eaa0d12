#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Two beams on each other, assembled here with numpy: steel above aluminium, held at x = 0, pressed and pulled; friction that is
twice as strong along the beams as across.  Plots the contact pressure.

    python3 example_beams.py [--divisions 4] [--plot pressure.png] [--displacements u.txt]
    mpirun -n 2 python3 example_beams.py          with mpi4py: each rank brings the beams of its number
"""
import argparse
import itertools

import numpy as np

import haptos

STEEL, ALUMINIUM = (2.119e5, 0.277), (6.9e4, 0.333)  # Young's modulus [MPa], Poisson's ratio
COEFFICIENTS = (0.3, 0.15)                           # along x, along y
PRESSURE, PULL = 100.0, (20.0, 20.0, 0.0)            # on top; at the end, both [MPa]
SIGNS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]])


def brick_stiffness(sides, youngs_modulus, poissons_ratio):
    """K [24, 24] of a brick with eight nodes (in the order of SIGNS), 2 x 2 x 2 Gauss points."""
    lame = youngs_modulus * poissons_ratio / ((1 + poissons_ratio) * (1 - 2 * poissons_ratio))
    shear = youngs_modulus / (2 * (1 + poissons_ratio))
    C = np.diag([2 * shear] * 3 + [shear] * 3)
    C[:3, :3] += lame
    K = np.zeros((24, 24))
    for point in itertools.product((-1 / np.sqrt(3), 1 / np.sqrt(3)), repeat=3):
        factors = 1 + SIGNS * point
        gradient = np.stack([SIGNS[:, d] * factors[:, (d + 1) % 3] * factors[:, (d + 2) % 3] / 4 / sides[d] for d in range(3)], axis=1)
        B = np.zeros((6, 8, 3))  # strains xx, yy, zz, xy, yz, zx
        for row, (a, b) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]):
            B[row, :, a] += gradient[:, b]
            if a != b:
                B[row, :, b] += gradient[:, a]
        B = B.reshape(6, 24)
        K += np.prod(sides) / 8 * B.T @ C @ B
    return K


class Beam:
    """A grid of 2 m x m x m bricks on [0, 2] x [0, 1] x [bottom, bottom + 1]; ids begin with `first`."""

    def __init__(self, m, bottom, first, material):
        self.divisions = np.array([2 * m, m, m])
        self.sides = np.array([2.0, 1.0, 1.0]) / self.divisions
        k, j, i = np.meshgrid(*(np.arange(n + 1) for n in self.divisions[::-1]), indexing="ij")
        self.grid = np.stack([i.ravel(), j.ravel(), k.ravel()], axis=1)
        self.coordinates = self.grid * self.sides + [0, 0, bottom]
        self.ids = first + np.arange(len(self.grid))
        corners = np.array([g for g in self.grid if (g < self.divisions).all()])
        strides = np.array([1, self.divisions[0] + 1, (self.divisions[0] + 1) * (self.divisions[1] + 1)])
        self.connectivity = first + (corners[:, None, :] + (SIGNS + 1) // 2) @ strides
        self.K = brick_stiffness(self.sides, *material)

    def face(self, axis, end):
        """Ids of the nodes of a side, and the area that each of them has of it."""
        on = self.grid[:, axis] == (self.divisions[axis] if end else 0)
        others = [d for d in range(3) if d != axis]
        at_edge = (self.grid[:, others] == 0) | (self.grid[:, others] == self.divisions[others])
        return self.ids[on], np.prod(self.sides[others] * np.where(at_edge, 0.5, 1.0), axis=1)[on]


def pose(system, lower, upper, rank, size):
    """Gives the system its elements, supports, pairs and loads; returns the contact nodes of this rank and their areas."""
    interface = system.add_interface("joint", "Coulomb", COEFFICIENTS)
    for body, beam in enumerate((lower, upper)):
        if body % size == rank:
            system.add_elements(body, beam.ids, beam.coordinates, beam.connectivity, beam.K)
            system.prescribe(beam.face(0, False)[0], [0, 1, 2], 0.0)
    if 1 % size != rank:
        return np.empty(0, int), np.empty(0)
    (top, top_areas), (end, end_areas), (contact, areas) = upper.face(2, True), upper.face(0, True), upper.face(2, False)
    system.add_pairs(interface, contact, lower.face(2, True)[0], normals=(0, 0, -1), areas=areas)
    system.set_loads(np.concatenate([top, end]),
                     np.concatenate([top_areas[:, None] * (0, 0, -PRESSURE), end_areas[:, None] * PULL]))
    return contact, areas


def plot(file, coordinates, pressure):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
    filled = axes.tricontourf(coordinates[:, 0], coordinates[:, 1], pressure, levels=20)
    figure.colorbar(filled, label="contact pressure [MPa]")
    axes.set(xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
    figure.savefig(file, dpi=150)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--divisions", type=int, default=4, help="bricks along a beam's short sides")
    parser.add_argument("--tolerance", type=float, default=1e-8)
    parser.add_argument("--plot", help="image file for the contact pressure")
    parser.add_argument("--displacements", help="text file for x y z ux uy uz of all nodes")
    arguments = parser.parse_args()
    try:
        from mpi4py import MPI
        comm, rank, size = MPI.COMM_WORLD, MPI.COMM_WORLD.rank, MPI.COMM_WORLD.size
    except ImportError:
        comm, rank, size = None, 0, 1

    lower = Beam(arguments.divisions, -1.0, 0, ALUMINIUM)
    upper = Beam(arguments.divisions, 0.0, 100000, STEEL)
    with haptos.ContactSystem({"Solver": {"Relative Tolerance": arguments.tolerance}}, comm) as system:
        contact, areas = pose(system, lower, upper, rank, size)
        outcome = system.solve()
        forces = system.contact_forces()
        ids = np.concatenate([lower.ids, upper.ids]) if rank == 0 else []
        u = system.displacements(ids)
        if rank == 0:
            print(f"solved: {outcome.solved}, by {outcome.method} in {outcome.multiplications} multiplications, error {outcome.residual:.1e}; "
                  f"largest displacement {np.abs(u).max():.6e}")
            if arguments.displacements:
                np.savetxt(arguments.displacements, np.hstack([np.concatenate([lower.coordinates, upper.coordinates]), u]), fmt="%.17g")
        if len(contact):
            closed = forces[:, 0] > 1e-6 * forces[:, 0].max()
            slips = closed & (np.hypot(*(forces[:, 1:] / COEFFICIENTS).T) > (1 - 1e-6) * forces[:, 0])
            print(f"{len(contact)} pairs: {np.sum(~closed)} open, {np.sum(slips)} slip, {np.sum(closed & ~slips)} stick; "
                  f"normal force {forces[:, 0].sum():.6e}")
            if arguments.plot:
                plot(arguments.plot, upper.coordinates[np.searchsorted(upper.ids, contact)], forces[:, 0] / areas)
    return 0 if outcome.solved else 2


if __name__ == "__main__":
    raise SystemExit(main())
