# SPDX-License-Identifier: BSD-3-Clause
"""Haptos from Python: bodies in contact with friction, for programs that assemble by themselves.

    minimise 1/2 u^T K u - f^T u   with contact and friction on pairs of nodes, u = prescribed where it is

    import haptos
    system = haptos.ContactSystem({"Solver": {"Relative Tolerance": 1e-8}})
    interface = system.add_interface("joint", "Coulomb", (0.3, 0.15))
    system.add_elements(body, nodes, coordinates, connectivity, Ke)   # or add_subdomain with a sparse matrix
    system.prescribe(nodes, [0, 1, 2], 0.0)
    system.add_pairs(interface, secondary, primary, normals)
    system.set_loads(nodes, forces)
    outcome = system.solve()
    u = system.displacements(nodes)

Needs numpy; several ranks need mpi4py.  The C library beside this file (../../../lib) is used, or the one that the environment
variable HAPTOS_LIBRARY names.  Node ids, units, signs and the law are those of haptos.h: ids >= 0 as the caller likes, of one body each,
[u] = u_secondary - sum of weight x u_primary, gap along the normal, which points outward from the secondary side.

Shapes: n nodes, e elements of k nodes, p pairs.  Everything is copied.  Methods say Collective where all ranks must call them; the others
are Local.  A Local one raises ValueError, on its rank, where shapes or kinds of values do not fit, and has taken nothing then.  What
else is wrong is raised on all ranks as InputError by the next Collective one; haptos.h tells what is to be given again after it.
"""
import ctypes
import numbers
import os
import pathlib
import sys
from ctypes import POINTER, byref, c_char, c_char_p, c_double, c_int, c_int64, c_void_p
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

import numpy as np

__all__ = ["ContactSystem", "Outcome", "Counters", "HaptosError", "InputError", "NoSolution", "InternalError"]

LAWS = {"Frictionless": 0, "Tresca": 1, "Coulomb": 2, "Tied": 3}


class HaptosError(Exception):
    """What Haptos says is wrong."""


class InputError(HaptosError):
    """What was given is wrong: what, and what would be right."""


class NoSolution(HaptosError):
    """A body that nothing holds under load, or data that contradict each other."""


class InternalError(HaptosError):
    """Haptos' own error, or the system's."""


_ERRORS = {1: InputError, 3: NoSolution}
_NOT_CONVERGED = 2


class _Friction(ctypes.Structure):
    _fields_ = [("law", c_int), ("coefficients", c_double * 2), ("slip_bound", c_double)]


class _Subdomain(ctypes.Structure):
    _fields_ = [("body", c_int), ("num_nodes", c_int), ("nodes", c_void_p), ("coordinates", c_void_p), ("row_starts", c_void_p),
                ("columns", c_void_p), ("values", c_void_p), ("kernel_columns", c_int), ("kernel", c_void_p)]


class _Pairs(ctypes.Structure):
    _fields_ = [("interface", c_int), ("count", c_int), ("secondary", c_void_p), ("primary_starts", c_void_p), ("primary", c_void_p),
                ("weights", c_void_p), ("normals", c_void_p), ("axes", c_void_p), ("gaps", c_void_p), ("areas", c_void_p)]


class _Outcome(ctypes.Structure):
    _fields_ = [("solved", c_int), ("multiplications", c_int64), ("residual", c_double), ("method", c_char * 64), ("reason", c_char * 512)]


class _Counters(ctypes.Structure):
    _fields_ = [("factorizations", c_int64), ("multiplications", c_int64), ("rows", c_int64)]


@dataclass(frozen=True)
class Outcome:
    """How a solve ended."""
    solved: bool          #: residual <= Relative Tolerance
    multiplications: int  #: by the dual operator F = B K^+ B^T, for this solve
    residual: float       #: [-] largest relative error of equilibrium, continuity and contact laws
    method: str
    reason: str           #: why it is not solved


@dataclass(frozen=True)
class Counters:
    """Work since the system was made, over all ranks."""
    factorizations: int   #: of subdomain matrices; congruent ones share theirs
    multiplications: int  #: by F
    rows: int             #: times that constraint rows were made


_SIGNATURES = {
    "create_fortran": [c_int, c_char_p, POINTER(c_void_p)],
    "create_serial": [c_char_p, POINTER(c_void_p)],
    "destroy": [POINTER(c_void_p)],
    "add_interface": [c_void_p, c_char_p, POINTER(_Friction), POINTER(c_int)],
    "add_subdomain": [c_void_p, POINTER(_Subdomain), POINTER(c_int)],
    "add_nodes": [c_void_p, c_int64, c_void_p, c_void_p],
    "add_elements": [c_void_p, c_int, c_int64, c_int, c_void_p, c_void_p],
    "prescribe": [c_void_p, c_int64, c_void_p, c_void_p, c_void_p],
    "clear_prescribed": [c_void_p],
    "add_pairs": [c_void_p, POINTER(_Pairs)],
    "clear_pairs": [c_void_p],
    "set_loads": [c_void_p, c_int64, c_void_p, c_void_p],
    "set_gaps": [c_void_p, c_int, c_void_p, c_void_p],
    "set_friction": [c_void_p, c_int, POINTER(_Friction)],
    "set_stiffness": [c_void_p, c_int, c_void_p],
    "set_elements": [c_void_p, c_int64, c_int64, c_void_p],
    "set_up": [c_void_p],
    "solve": [c_void_p, POINTER(_Outcome)],
    "displacements": [c_void_p, c_int64, c_void_p, c_void_p],
    "contact_forces": [c_void_p, c_void_p],
    "multipliers": [c_void_p, POINTER(c_int64), c_void_p],
    "count": [c_void_p, POINTER(_Counters)],
}


def _load():
    name = "libhaptos_c.dylib" if sys.platform == "darwin" else "libhaptos_c.so"
    beside = pathlib.Path(__file__).resolve().parents[3] / "lib" / name if len(pathlib.Path(__file__).resolve().parents) > 3 else name
    # MPI libraries load parts of their own that look for symbols among the global ones.
    library = ctypes.CDLL(os.environ.get("HAPTOS_LIBRARY", str(beside)), mode=ctypes.RTLD_GLOBAL)
    for function, arguments in _SIGNATURES.items():
        getattr(library, "haptos_" + function).argtypes = arguments
    library.haptos_message.argtypes = [c_void_p]
    library.haptos_message.restype = c_char_p
    return library


_library = _load()


def _integers(values, dtype, what):
    """Whole numbers only: what would be cut off, as 1.7, or does not fit, is a mistake of the caller."""
    array = np.asarray(values)
    if array.dtype == dtype or array.size == 0:
        return array.astype(dtype, copy=False)
    whole = array.dtype.kind in "iu" or array.dtype.kind == "f" and np.isfinite(array).all() and (array == np.floor(array)).all()
    limits = np.iinfo(dtype)
    if not whole or int(array.min()) < limits.min or int(array.max()) > limits.max:
        raise ValueError(f"{what} must be whole numbers from {limits.min} to {limits.max}; they are {np.array2string(array, threshold=6)}")
    return array.astype(dtype)


def _integer(value, what):
    """One of them, as int."""
    return _array(value, np.intc, (), what).item()


def _array(values, dtype, shape, what):
    """A contiguous array of that shape (-1: any extent); scalars and rows are repeated."""
    array = np.asarray(values, dtype=float) if dtype is float else _integers(values, dtype, what)
    if -1 not in shape and array.ndim <= len(shape):
        try:
            array = np.broadcast_to(array, shape)
        except ValueError:
            pass
    if array.ndim != len(shape) or any(want not in (-1, have) for want, have in zip(shape, array.shape)):
        raise ValueError(f"{what} has the shape {array.shape}; it must be {tuple('any' if n == -1 else n for n in shape)}")
    return np.ascontiguousarray(array)


def _pointer(array):
    return None if array is None else array.ctypes.data_as(c_void_p)


def _typed(key, value):
    """Type and text of a parameter's value; numpy's scalars count as Python's."""
    if isinstance(value, (bool, np.bool_)):
        return "bool", str(value).lower()
    if isinstance(value, numbers.Integral):
        return "int", str(int(value))
    if isinstance(value, numbers.Real):
        return "double", repr(float(value))
    if isinstance(value, str):
        return "string", str(value)
    raise TypeError(f"parameter '{key}' is a {type(value).__name__}; it must be a bool, int, float or str")


def _xml(parameters):
    """Nested dicts, or XML as it is, to the XML of the program's input."""
    if parameters is None or isinstance(parameters, str):
        return parameters

    def lines(name, entries):
        yield f"<ParameterList name={quoteattr(name)}>"
        for key, value in entries.items():
            if isinstance(value, dict):
                yield from lines(key, value)
            else:
                kind, text = _typed(key, value)
                yield f"<Parameter name={quoteattr(key)} type=\"{kind}\" value={quoteattr(text)}/>"
        yield "</ParameterList>"

    return "\n".join(lines("Haptos", parameters))


class ContactSystem:
    """Matrices and pairs in, displacements and contact forces out, solved again and again.

    What is given after a solve changes the next one, and only what it touches is done again.

    parameters: nested dict or XML text with any of the lists Solver, Local Solver, Preconditioner, Coarse Problem and
        Decomposition of the program's input, e.g. {"Solver": {"Relative Tolerance": 1e-8}}.
    comm: communicator of mpi4py; without it this process alone.  Collective.
    """

    def __init__(self, parameters=None, comm=None):
        self._system = c_void_p()
        # As C counts: pairs; rows of each element's matrix; entries of each subdomain's, by its number.
        self._pairs, self._rows, self._entries = 0, [], {}
        self._placed, self._is_set_up = [], False
        self._alone = comm is None or comm.size == 1
        xml = _xml(parameters)
        text = None if xml is None else xml.encode()
        if comm is None:
            status = _library.haptos_create_serial(text, byref(self._system))
        else:
            status = _library.haptos_create_fortran(comm.py2f(), text, byref(self._system))
        self._check(status)

    def close(self):
        """Frees the system; before MPI ends.  Collective."""
        if self._system:
            _library.haptos_destroy(byref(self._system))

    def __enter__(self):
        return self

    def __exit__(self, *unused):
        self.close()

    def __del__(self):
        if getattr(self, "_alone", False):
            self.close()

    def add_interface(self, name, law="Coulomb", coefficients=(0.0, 0.0), slip_bound=0.0):
        """A joint of pairs with one law: Frictionless, Tresca, Coulomb or Tied.  All ranks alike.  Returns its number.

        coefficients: F1, F2 [-] along the principal axes; slip_bound: Tresca's traction [force/area].
        """
        number = c_int()
        self._call("add_interface", name.encode(), byref(self._friction(law, coefficients, slip_bound)), byref(number))
        return number.value

    def add_subdomain(self, body, nodes, coordinates, matrix, kernel=None):
        """A part of a body with the stiffness that it has by itself: nothing held, nothing merged.  Before set_up.

        Returns its number on this rank, -1 where it is refused: then it is not there, and the next Collective method tells why.

        nodes: ids [n]; coordinates [n, 3]; matrix: scipy.sparse or a triple (row_starts [3 n + 1], columns, values) in CSR, all entries,
        rows 3 x node + component [force/length]; kernel [3 n, c]: all that the matrix does not feel, where that is more than rigid motions.
        """
        nodes = _array(nodes, np.int64, (-1,), "nodes")
        coordinates = _array(coordinates, float, (len(nodes), 3), "coordinates")
        if hasattr(matrix, "tocsr"):
            csr = matrix.tocsr()
            matrix = csr.indptr, csr.indices, csr.data
        starts = _array(matrix[0], np.int64, (3 * len(nodes) + 1,), "row_starts")
        columns = _array(matrix[1], np.intc, (starts[-1],), "columns")
        values = _array(matrix[2], float, (starts[-1],), "values")
        if kernel is not None:
            kernel = _array(np.asarray(kernel, float).T, float, (-1, 3 * len(nodes)), "the transposed kernel")
        given = _Subdomain(_integer(body, "body"), len(nodes), _pointer(nodes), _pointer(coordinates), _pointer(starts), _pointer(columns),
                           _pointer(values), 0 if kernel is None else len(kernel), _pointer(kernel))
        number = c_int()
        self._call("add_subdomain", byref(given), byref(number))
        if number.value >= 0:
            self._entries[number.value] = len(values)
        return number.value

    def add_elements(self, body, nodes, coordinates, connectivity, Ke):
        """Elements of this rank instead of subdomains: the system cuts them.  Before set_up.  Returns the number of the first on this rank.

        nodes: ids [n], with those of former calls all that the elements need; coordinates [n, 3]; connectivity: ids [e, k];
        Ke [e, 3 k, 3 k] or [3 k, 3 k] for all [force/length].  All elements are taken, or none and ValueError tells why.
        """
        body, nodes = _integer(body, "body"), _array(nodes, np.int64, (-1,), "nodes")
        coordinates = _array(coordinates, float, (len(nodes), 3), "coordinates")
        connectivity = _array(connectivity, np.int64, (-1, -1), "connectivity")
        count, k = connectivity.shape
        Ke = _array(Ke, float, (count, 3 * k, 3 * k), "Ke")
        self._require_elements(body, nodes, coordinates, connectivity)
        self._call("add_nodes", len(nodes), _pointer(nodes), _pointer(coordinates))
        self._placed.append(nodes)
        self._call("add_elements", body, count, k, _pointer(connectivity), _pointer(Ke))
        self._rows += count * [3 * k]
        return len(self._rows) - count

    def _require_elements(self, body, nodes, coordinates, connectivity):
        """All that C would refuse one by one: it cannot tell which, and numbers would be others than here."""
        if self._is_set_up:
            raise ValueError("elements are added after set_up; other elements are another system")
        if body < 0 or connectivity.shape[1] == 0:
            raise ValueError(f"elements have body {body} and {connectivity.shape[1]} nodes; bodies count from 0, and nodes must be > 0")
        if connectivity.min(initial=0) < 0:
            raise ValueError(f"connectivity names node {connectivity.min()}; ids must be >= 0")
        if not np.isfinite(coordinates).all():
            raise ValueError("coordinates must be finite")
        missing = connectivity[~np.isin(connectivity, nodes)]
        for former in self._placed:
            if missing.size:
                missing = missing[~np.isin(missing, former)]
        if missing.size:
            raise ValueError(f"connectivity names node {missing[0]}, which is not among the nodes that were given on this rank")

    def prescribe(self, nodes, components, values=0.0):
        """u_component(node) = value; once more after a solve: another value.

        nodes: ids [n]; components: of {0, 1, 2} [c], the same for every node; values [n, c] or what fits it [length].
        """
        nodes = _array(nodes, np.int64, (-1,), "nodes")
        components = _array(np.atleast_1d(components), np.intc, (-1,), "components")
        values = _array(values, float, (len(nodes), len(components)), "values")
        ids, each = np.repeat(nodes, len(components)), np.tile(components, len(nodes))
        self._call("prescribe", values.size, _pointer(ids), _pointer(each), _pointer(values))

    def clear_prescribed(self):
        """Forgets all that this rank prescribed."""
        self._call("clear_prescribed")

    def add_pairs(self, interface, secondary, primary, normals, axes=(1.0, 0.0, 0.0), gaps=0.0, areas=1.0, weights=None):
        """Nodes of a secondary side and what they may touch.  Returns their numbers on this rank [p].

        secondary: ids [p]; primary: ids [p] or [p, k], or None for a rigid obstacle; weights [p, k] that add up to 1 (None: equal);
        normals [p, 3]: outward from the secondary side; axes [p, 3]: first principal axis of friction, projected on the tangent plane;
        gaps [p] along the normal [length]; areas [p] of the nodes, for Tresca's law [area].  One value or row stands for all.
        Better the softer side than one that is far stiffer, and not one whose nodes are held and more than those opposite.
        """
        secondary = _array(secondary, np.int64, (-1,), "secondary")
        p = len(secondary)
        starts = None
        if primary is None and weights is not None:
            raise ValueError("weights are given without primary nodes; a rigid obstacle has none")
        if primary is not None:
            primary = _integers(primary, np.int64, "primary")
            primary = _array(primary[:, None] if primary.ndim == 1 else primary, np.int64, (p, -1), "primary")
            if primary.shape[1] == 0:
                raise ValueError(f"primary has the shape {primary.shape}; a pair has a primary node, or primary is None")
            starts = np.arange(p + 1, dtype=np.int64) * primary.shape[1]
            if weights is not None:
                weights = _array(weights, float, primary.shape, "weights")
        normals, axes = _array(normals, float, (p, 3), "normals"), _array(axes, float, (p, 3), "axes")
        gaps, areas = _array(gaps, float, (p,), "gaps"), _array(areas, float, (p,), "areas")
        given = _Pairs(_integer(interface, "interface"), p, _pointer(secondary), _pointer(starts), _pointer(primary), _pointer(weights),
                       _pointer(normals), _pointer(axes), _pointer(gaps), _pointer(areas))
        self._pairs += p  # before they are: the array of contact_forces is never shorter than what C writes
        self._call("add_pairs", byref(given))
        return np.arange(self._pairs - p, self._pairs)

    def clear_pairs(self):
        """Forgets the pairs of this rank."""
        self._call("clear_pairs")
        self._pairs = 0

    def set_loads(self, nodes, forces):
        """Forces [n, 3] on nodes [n], instead of what this rank gave before; those of all ranks on a node add up [force]."""
        nodes = _array(nodes, np.int64, (-1,), "nodes")
        forces = _array(forces, float, (len(nodes), 3), "forces")
        self._call("set_loads", len(nodes), _pointer(nodes), _pointer(forces))

    def set_gaps(self, pairs, gaps):
        """Other gaps [p] for pairs [p] of this rank, by their numbers [length]."""
        pairs = _array(pairs, np.intc, (-1,), "pairs")
        gaps = _array(gaps, float, (len(pairs),), "gaps")
        self._call("set_gaps", len(pairs), _pointer(pairs), _pointer(gaps))

    def set_friction(self, interface, law="Coulomb", coefficients=(0.0, 0.0), slip_bound=0.0):
        """Another law for an interface, see add_interface.  All ranks alike."""
        self._call("set_friction", _integer(interface, "interface"), byref(self._friction(law, coefficients, slip_bound)))

    def set_stiffness(self, subdomain, values):
        """Other entries for a subdomain of this rank, in the order of its CSR columns, or a scipy.sparse matrix of the same pattern."""
        subdomain = _integer(subdomain, "subdomain")
        values = values.tocsr().data if hasattr(values, "tocsr") else values
        # Of a number that is nowhere C reads nothing, and refuses it.
        values = _array(values, float, (self._entries.get(subdomain, -1),), "values")
        self._call("set_stiffness", subdomain, _pointer(values))

    def set_elements(self, first, Ke):
        """Other matrices Ke [e, 3 k, 3 k] for elements first, first + 1, ... of this rank, all of k nodes [force/length]."""
        first, Ke = _integer(first, "first"), _array(Ke, float, (-1, -1, -1), "Ke")
        # Of numbers that are nowhere C reads nothing, and refuses them.
        if 0 <= first <= len(self._rows) - len(Ke):
            for rows in set(self._rows[first:first + len(Ke)]):
                if Ke.shape[1:] != (rows, rows):
                    raise ValueError(f"Ke of elements from {first} on has the shape {Ke.shape}; it must be {(len(Ke), rows, rows)}")
        self._call("set_elements", first, len(Ke), _pointer(Ke))

    def set_up(self):
        """Cuts, checks and numbers what was given; solve does it where it was not done.  Collective."""
        self._call("set_up")
        self._is_set_up = True

    def solve(self):
        """Goes on from the solve before.  Returns an Outcome, also where it is not solved.  Collective."""
        found = _Outcome()
        self.set_up()  # by itself, so that it is known to be done also where the loads are refused
        self._call("solve", byref(found))
        reason = _library.haptos_message(self._system).decode(errors="replace")
        return Outcome(bool(found.solved), found.multiplications, found.residual, found.method.decode(), reason)

    def displacements(self, nodes):
        """u [n, 3] of any nodes, ids [n] [length].  Collective; ranks may ask for different nodes."""
        nodes = _array(nodes, np.int64, (-1,), "nodes")
        u = np.empty((len(nodes), 3))
        self._call("displacements", len(nodes), _pointer(nodes), _pointer(u))
        return u

    def contact_forces(self):
        """(N, T1, T2) [p, 3] of the pairs of this rank [force]; N >= 0 presses.  Of the last solve, since which no pair, support or
        kind of law has changed.  Collective."""
        forces = np.zeros((self._pairs, 3))
        self._call("contact_forces", _pointer(forces))
        return forces

    def multipliers(self):
        """All multipliers of this rank by row: contact forces, gluing forces, reactions."""
        count = c_int64()
        self._call("multipliers", byref(count), None)
        values = np.empty(count.value)
        self._call("multipliers", byref(count), _pointer(values))
        return values

    def counters(self):
        """Work since the system was made.  Collective."""
        found = _Counters()
        self._call("count", byref(found))
        return Counters(found.factorizations, found.multiplications, found.rows)

    @staticmethod
    def _friction(law, coefficients, slip_bound):
        if law not in LAWS:
            raise ValueError(f"law '{law}' is unknown; there are {', '.join(LAWS)}")
        return _Friction(LAWS[law], (c_double * 2)(*_array(coefficients, float, (2,), "coefficients")), float(slip_bound))

    def _call(self, function, *arguments):
        if not self._system:
            raise InputError("The system is closed.")
        self._check(getattr(_library, "haptos_" + function)(self._system, *arguments))

    def _check(self, status):
        if status not in (0, _NOT_CONVERGED):
            raise _ERRORS.get(status, InternalError)(_library.haptos_message(self._system or None).decode(errors="replace"))
