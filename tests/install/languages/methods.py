# SPDX-License-Identifier: BSD-3-Clause
"""What the Python class does beside the example: subdomains, new data, mistakes, several systems; on any number of ranks."""
import numpy as np

import example_beams as beams
import haptos

try:
    from mpi4py import MPI
    world, rank, size = MPI.COMM_WORLD, MPI.COMM_WORLD.rank, MPI.COMM_WORLD.size
except ImportError:
    world, rank, size = None, 0, 1

TIGHT = {"Solver": {"Relative Tolerance": 1e-11}}
lower, upper = beams.Beam(3, -1.0, 0, beams.ALUMINIUM), beams.Beam(3, 0.0, 5000, beams.STEEL)
ids = np.concatenate([lower.ids, upper.ids])


def refused(kind, text, call):
    try:
        call()
    except kind as e:
        assert text in str(e), f"'{text}' is not in '{e}'"
        return
    raise AssertionError(f"nothing was said of '{text}'")


def same(a, b, digits=1e-8):
    return np.abs(a - b).max() <= digits * np.abs(b).max()


def merged(beam):
    """The whole beam's matrix as CSR of all entries, by numpy alone."""
    n = 3 * len(beam.ids)
    K = np.zeros((n, n))
    for element in beam.connectivity - beam.ids[0]:
        rows = (3 * element[:, None] + np.arange(3)).ravel()
        K[np.ix_(rows, rows)] += beam.K
    rows, columns = np.nonzero(K)
    return np.searchsorted(rows, np.arange(n + 1)), columns, K[rows, columns]


def rigid_motions(beam):
    """[3 n, 6]"""
    R = np.zeros((len(beam.ids), 3, 6))
    for d in range(3):
        R[:, d, d] = 1
        R[:, (d + 1) % 3, 3 + d] = -beam.coordinates[:, (d + 2) % 3]
        R[:, (d + 2) % 3, 3 + d] = beam.coordinates[:, (d + 1) % 3]
    return R.reshape(-1, 6)


def posed(parameters, comm, here, ranks):
    system = haptos.ContactSystem(parameters, comm)
    contact, _ = beams.pose(system, lower, upper, here, ranks)
    return system, contact


system, contact = posed(TIGHT, world, rank, size)
outcome = system.solve()
assert outcome.solved and outcome.residual <= 1e-11 and outcome.multiplications > 3 and outcome.reason == "", outcome
u = system.displacements(ids)
counted = system.counters()
forces = system.contact_forces()
assert forces.shape == (len(contact), 3) and (forces[:, 0] >= 0).all()
assert len(system.multipliers()) > 0

# The same from matrices of subdomains, alone on this process, while the other one lives.
with haptos.ContactSystem(TIGHT) as alone:
    joint = alone.add_interface("joint", "Coulomb", beams.COEFFICIENTS)
    for body, beam in enumerate((lower, upper)):
        alone.add_subdomain(body, beam.ids, beam.coordinates, merged(beam), rigid_motions(beam) if body == 0 else None)
        alone.prescribe(beam.face(0, False)[0], [0, 1, 2])
    upper_nodes, areas = upper.face(2, False)
    lower_nodes = lower.face(2, True)[0]
    pairs = alone.add_pairs(joint, upper_nodes, np.stack([lower_nodes, lower_nodes], axis=1), (0, 0, -1), weights=np.tile([0.25, 0.75], (len(areas), 1)))
    (top, top_areas), (end, end_areas) = upper.face(2, True), upper.face(0, True)
    alone.set_loads(np.concatenate([top, end]), np.concatenate([top_areas[:, None] * (0, 0, -beams.PRESSURE), end_areas[:, None] * beams.PULL]))
    assert alone.solve().solved and same(alone.displacements(ids), u)
    for body, beam in enumerate((lower, upper)):
        alone.set_stiffness(body, merged(beam)[2] * 2)
    assert alone.solve().solved and same(alone.displacements(ids), u / 2)
    assert alone.counters().factorizations == 4
    free = np.setdiff1d(pairs, pairs[np.isin(upper_nodes, upper.face(0, False)[0])])
    alone.set_gaps(free, np.full(len(free), 1e-3))
    assert alone.solve().solved and not same(alone.displacements(ids), u / 2, 1e-3)

# Other elements, loads and laws for the first.
for body, beam in enumerate((lower, upper)):
    if body % size == rank:
        system.set_elements(0 if size > 1 or body == 0 else len(lower.connectivity), np.tile(4 * beam.K, (len(beam.connectivity), 1, 1)))
assert system.solve().solved and same(system.displacements(ids), u / 4)
assert system.counters().factorizations == 2 * counted.factorizations and system.counters().rows == 2
system.set_friction(0, "Frictionless")
assert system.solve().solved
slippery = system.displacements(ids)
assert not same(slippery, u / 4, 1e-4)
assert np.abs(system.contact_forces()[:, 1:]).max(initial=0) == 0

# Mistakes, and the call after them.
refused(ValueError, "coordinates", lambda: system.add_subdomain(0, [1, 2], np.zeros((3, 3)), None))
with haptos.ContactSystem() as wrong:
    wrong.add_subdomain(0, lower.ids, lower.coordinates, merged(lower), rigid_motions(lower)[:, :5] + 1e-3 * lower.coordinates.reshape(-1, 1))
    refused(haptos.InputError, "kernel", wrong.set_up)
refused(ValueError, "'Colomb'", lambda: system.add_interface("x", "Colomb"))
refused(haptos.InputError, "Relative Tolerance", lambda: haptos.ContactSystem({"Solver": {"Relative Tolerence": 1e-3}}, world))
if rank == 0:
    system.prescribe([424242], [0])
refused(haptos.InputError, "424242", system.solve)
refused(haptos.InputError, "424242", system.solve)  # it is still there
system.clear_prescribed()
refused(haptos.NoSolution, "body", system.solve)    # nothing holds the beams
for body, beam in enumerate((lower, upper)):
    if body % size == rank:
        system.prescribe(beam.face(0, False)[0], [0, 1, 2])
assert system.solve().solved and same(system.displacements(ids), slippery)
system.close()
refused(haptos.InputError, "closed", system.solve)
if rank == 0:
    print(f"methods on {size} ranks: all as it should be")
