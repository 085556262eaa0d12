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

# Values of the wrong shape or kind are refused at once, on the rank that gives them, and take nothing.
for other in (np.ones((1, 1, 1)), np.ones((1, 3, 3)), np.ones((1, 30, 30)), np.ones((1, 24, 23))):
    if rank < 2:  # there are two beams, so that others have no elements
        refused(ValueError, "Ke of elements from 0 on", lambda: system.set_elements(0, other))
refused(ValueError, "nodes must be whole", lambda: system.prescribe([1.7], [0], 1.0))
refused(ValueError, "components must be whole", lambda: system.prescribe([1], [0.9], 1.0))
refused(ValueError, "components must be whole", lambda: system.prescribe([1], [2**40], 1.0))
refused(ValueError, "nodes must be whole", lambda: system.set_loads([np.nan], np.zeros((1, 3))))
refused(ValueError, "interface must be whole", lambda: system.add_pairs(0.5, [1], None, (0, 0, -1)))
refused(ValueError, "weights", lambda: system.add_pairs(0, [1], None, (0, 0, -1), weights=[1.0]))
refused(ValueError, "primary", lambda: system.add_pairs(0, [1, 2], np.zeros((2, 0), int), (0, 0, -1)))
refused(ValueError, "set_up", lambda: system.add_elements(0, lower.ids, lower.coordinates, lower.connectivity, lower.K))
refused(TypeError, "NoneType", lambda: haptos.ContactSystem({"Solver": {"Relative Tolerance": None}}))
assert system.solve().solved and same(system.displacements([float(n) for n in ids]), slippery)
assert system.contact_forces().shape == (len(contact), 3)

# Numbers are those of what was taken; numpy's scalars are parameters, too.
with haptos.ContactSystem({"Solver": {"Relative Tolerance": np.float64(1e-8), "Maximum Hessian Multiplications": np.int64(500)},
                           "Decomposition": {"Subdomains": np.int32(2)}}) as counted_alone:
    starts, columns, values = merged(lower)
    nowhere = columns.copy()
    nowhere[5] = 10**6
    assert counted_alone.add_subdomain(0, lower.ids, lower.coordinates, (starts, nowhere, values)) == -1
    refused(haptos.InputError, "column 1000000", counted_alone.set_up)
    assert counted_alone.add_subdomain(0, lower.ids[[0] + list(range(len(lower.ids) - 1))], lower.coordinates, (starts, columns, values)) == -1
    refused(haptos.InputError, "twice", counted_alone.set_up)
    assert counted_alone.add_subdomain(np.int64(0), lower.ids, lower.coordinates, (starts, columns, values)) == 0
    counted_alone.set_up()
    refused(ValueError, "values", lambda: counted_alone.set_stiffness(0, values[:-1]))
    counted_alone.set_stiffness(1, values)
    refused(haptos.InputError, "this rank added 1,", counted_alone.set_up)
    counted_alone.set_stiffness(0, values)
    counted_alone.set_up()
with haptos.ContactSystem() as cut:
    few, k = lower.connectivity[:2], lower.K
    refused(ValueError, "among the nodes", lambda: cut.add_elements(0, lower.ids[:1], lower.coordinates[:1], few, k))
    refused(ValueError, "bodies", lambda: cut.add_elements(-1, lower.ids, lower.coordinates, few, k))
    refused(ValueError, "finite", lambda: cut.add_elements(0, lower.ids, lower.coordinates * np.nan, few, k))
    assert cut.add_elements(0, lower.ids, lower.coordinates, few, k) == 0
    assert cut.add_elements(0, [], np.zeros((0, 3)), lower.connectivity[2:], k) == 2  # places of before
    cut.set_elements(1, np.tile(k, (2, 1, 1)))
    cut.set_up()
    cut.set_elements(len(lower.connectivity) - 1, np.tile(k, (2, 1, 1)))
    refused(haptos.InputError, f"this rank added {len(lower.connectivity)},", cut.set_up)

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
