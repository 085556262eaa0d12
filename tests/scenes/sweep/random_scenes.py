# SPDX-License-Identifier: BSD-3-Clause
"""Random scenes of contact from a seed: bodies one on the other, in meshes of any shape of element; `draw` has those of matching linear ones."""
import dataclasses
import math
import pathlib
import sys
from xml.sax.saxutils import quoteattr

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "drivers"))
from haptos_exodus import CORNERS, SIDES, Block, ExodusMesh, SideSet, nodes_in_middles, write_exodus  # noqa: E402

SHAPES = {"cubes": (1, 1, 1), "beams": (2, 1, 1), "plates": (2, 2, 0.4), "needles": (6, 0.75, 0.75), "towers": (1, 1, 2.5)}
# Six tetrahedra of a hexahedron around the diagonal 0-6: the same diagonals on opposite faces, so that bodies match.
_TETS = np.array([(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)])
_HEX = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])


@dataclasses.dataclass(frozen=True)
class BodyMesh:
    shape: str             # of elements, Exodus' name
    elements: tuple        # along x, y, z; of hexahedra that are cut in six for tetrahedra
    is_free: bool = False  # tetrahedra by gmsh, about as large

    def __str__(self):
        return f"{self.shape} {'~' if self.is_free else ''}{'x'.join(map(str, self.elements))}"


class Written:
    """A scene that has a `mesh`, and an `input` by the name of its files."""

    def write(self, folder, name):
        """Mesh and input; returns the input's path."""
        folder = pathlib.Path(folder)
        write_exodus(folder / f"{name}.exo", self.mesh())
        path = folder / f"{name}.xml"
        path.write_text(self.input(name))
        return path


@dataclasses.dataclass
class Scene(Written):
    shape: str
    size: tuple            # of each body
    meshes: list           # of each body, from below
    young: list
    poisson: list
    law: str
    friction: tuple
    angle: float           # of the principal direction to x, degrees
    slip_bound: float
    gap: float
    plane: bool            # the lowest body lies on a rigid plane, held by nothing else
    held: str              # "all bodies", "lowest body": of x = 0; else contact and friction hold
    pull: tuple            # traction on the highest top
    part: float            # of what friction or weight against tipping carries
    subdomains: int
    seed: int
    tolerance: float = 1e-6
    family: str = "basic"

    @property
    def bodies(self):
        return len(self.young)

    def is_mortar(self, body):
        """Whether the interface under a body has the rows of dual mortar: quadratic faces have, a plane or not."""
        both = [mesh for mesh in self.meshes[max(0, body - 1):body + 1]]
        return any(len(nodes_in_middles(mesh.shape)) > CORNERS[mesh.shape] for mesh in both) or (body > 0 and both[0] != both[1])

    def mesh(self):
        return mesh_of(self)

    def input(self, name):
        return _input(self, name)

    def describe(self):
        nu = f"nu {max(self.poisson):.5g}, " if max(self.poisson) > 0.45 else ""
        size = f" {':'.join(f'{s:.3g}' for s in self.size)}" if self.family != "basic" else ""
        hard = f"contrast {max(self.young) / min(self.young):.0e}, " if max(self.young) > 10 * min(self.young) else ""
        return (f"{self.bodies} {self.shape}{size}, {' on '.join(map(str, dict.fromkeys(reversed(self.meshes))))}, {hard}{nu}"
                f"{self.law} ({self.friction[0]:.2g}, {self.friction[1]:.2g}) at {self.angle:.0f}, held: {self.held}"
                f"{', on a plane' if self.plane else ''}{', gap' if self.gap else ''}, load {self.part:.2f}")


def draw(seed, index):
    """Scene number `index` of this seed."""
    rng = np.random.default_rng([seed, index])
    shape = str(rng.choice(list(SHAPES)))
    size = SHAPES[shape]
    density = rng.integers(3, 7) / min(1.0, 4 * min(size))
    elements = tuple(int(min(24, max(2, round(s * density / stretch)))) for s, stretch in zip(size, (1, 1, rng.choice([1, 1, 2, 4]))))
    plane, bodies = rng.random() < 0.15, int(rng.choice([2, 2, 2, 3]))
    bodies -= int(plane)
    held = "contact" if plane else str(rng.choice(["all bodies", "lowest body"]))
    coefficient, ratio = 10 ** rng.uniform(math.log10(0.05), math.log10(2)), 10 ** rng.uniform(0, 4)
    friction = [coefficient, coefficient / ratio] if rng.random() < 0.9 else [coefficient, 0.0]
    rng.shuffle(friction)
    mesh = BodyMesh("TETRA4" if rng.random() < 0.2 else "HEX8", elements)
    scene = Scene(shape, size, [mesh] * bodies, [float(10 ** rng.uniform(-2.5, 2.5) * 1e5) for _ in range(bodies)],
                  [float(rng.uniform(0, 0.45)) for _ in range(bodies)], "Tresca" if rng.random() < 0.1 and held == "all bodies" else "Coulomb",
                  tuple(map(float, friction)), float(rng.uniform(0, 180)), float(rng.uniform(0.2, 2)),
                  float(rng.choice([0, 0, 0, 1e-4, 1e-3])) if held == "all bodies" else 0.0, plane, held, (0, 0, 0), 0.0,
                  int(rng.integers(4, 41)), int(rng.integers(1, 1000)))
    return loaded(scene, rng)


# Pressure 1 on the top; the pull in any direction is part of what friction carries, or of what tips a body over.
def loaded(scene, rng):
    direction, part = rng.uniform(0, 2 * math.pi), float(rng.uniform(0.01, 0.99))
    along = direction - math.radians(scene.angle)
    with np.errstate(divide="ignore"):
        slides = 1 / math.hypot(*(np.divide(c, f) if abs(c) > 1e-12 else 0.0
                                  for c, f in zip((math.cos(along), math.sin(along)), scene.friction)))
    bodies = scene.bodies - (0 if scene.plane else 1)
    tips = 0.25 * min(scene.size[:2]) / (scene.size[2] * bodies)
    carries = 0.3 if scene.held == "all bodies" else min(slides, tips)
    pull = part * carries * np.array([math.cos(direction), math.sin(direction), 0])
    return dataclasses.replace(scene, pull=tuple(float(x) for x in pull), part=part)


def mesh_of(scene):
    """Bodies body0, body1, ... from below, with side sets bottomN, topN, clampN (x = 0)."""
    points, blocks, sides, first = [], [], [], 0
    for body, mesh in enumerate(scene.meshes):
        x, connectivity = _body(mesh, scene.size)
        x[:, 2] += body * (scene.size[2] + scene.gap)
        blocks.append(Block(body + 1, f"body{body}", mesh.shape, connectivity + sum(len(p) for p in points)))
        for name, axis, value in (("bottom", 2, x[:, 2].min()), ("top", 2, x[:, 2].max()), ("clamp", 0, 0.0)):
            elements, numbers = _sides_at(x, connectivity, mesh.shape, axis, value)
            sides.append(SideSet(len(sides) + 1, f"{name}{body}", elements + first, numbers))
        points.append(x)
        first += len(connectivity)
    return ExodusMesh(np.concatenate(points), blocks, sides)


def _body(mesh, size):
    x, cells = _free_tetrahedra(mesh.elements) if mesh.is_free else _box(mesh.elements)
    if CORNERS[mesh.shape] == 4 and not mesh.is_free:
        cells = cells[:, _TETS].reshape(-1, 4)
    x = np.where(x == mesh.elements, size, x * (np.array(size) / mesh.elements))     # ends exactly there
    return _with_middles(x, cells, mesh.shape)


def _box(n):
    """Unit cubes, nodes on a grid."""
    x = np.stack(np.meshgrid(*[np.arange(m + 1.0) for m in n], indexing="ij"), -1).reshape(-1, 3)
    number = np.arange(len(x)).reshape([m + 1 for m in n])
    cells = np.stack([number[i:i + n[0], j:j + n[1], k:k + n[2]].ravel() for i, j, k in _HEX], -1)
    return x, cells


def _free_tetrahedra(n):
    """gmsh's tetrahedra of size 1 in a box of these lengths."""
    import gmsh  # of wide_scenes alone

    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.occ.addBox(0, 0, 0, *n)
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.setSize(gmsh.model.getEntities(0), 1.0)
    gmsh.model.mesh.generate(3)
    tags, x, _ = gmsh.model.mesh.getNodes()
    _, nodes = gmsh.model.mesh.getElementsByType(4)
    gmsh.finalize()
    order = np.argsort(tags)
    return np.round(x.reshape(-1, 3), 12), order[np.searchsorted(tags, nodes, sorter=order)].reshape(-1, 4).astype(int)


def _with_middles(x, cells, shape):
    """Nodes between corners, in Exodus' order."""
    around = nodes_in_middles(shape)[CORNERS[shape]:]
    if not around:
        return x, cells
    corners = np.full((len(cells), len(around), 8), -1)
    for k, group in enumerate(around):
        corners[:, k, :len(group)] = np.sort(cells[:, group], 1)
    unique, place = np.unique(corners.reshape(-1, 8), axis=0, return_inverse=True)
    middles = np.where(unique[..., None] >= 0, x[unique], 0).sum(1) / (unique >= 0).sum(1)[:, None]
    return np.concatenate([x, middles]), np.concatenate([cells, len(x) + place.reshape(len(cells), -1)], 1)


def _sides_at(x, connectivity, shape, axis, value):
    elements, numbers = [], []
    for side, nodes in enumerate(SIDES[shape], start=1):
        on = np.flatnonzero((abs(x[connectivity[:, nodes], axis] - value) < 1e-9).all(1))
        elements.append(on)
        numbers.append(np.full(len(on), side))
    return np.concatenate(elements), np.concatenate(numbers)


def _parameter(name, kind, value):
    return f"<Parameter name={quoteattr(name)} type={quoteattr(kind)} value={quoteattr(str(value))}/>"


def _list(name, *content):
    return f"<ParameterList name={quoteattr(name)}>\n" + "\n".join(content) + "\n</ParameterList>"


def _array(values):
    return "{" + ", ".join(v if isinstance(v, str) else repr(float(v)) for v in values) + "}"


def _input(scene, name):
    materials = [_list(f"material{b}", _parameter("Element Blocks", "Array(string)", f"{{body{b}}}"),
                       _parameter("Young's Modulus", "double", repr(scene.young[b])),
                       _parameter("Poisson's Ratio", "double", repr(scene.poisson[b]))) for b in range(scene.bodies)]
    subdomains = min(max(scene.subdomains, scene.bodies), sum(math.prod(mesh.elements) for mesh in scene.meshes))
    return _list("Haptos", _list("Mesh", _parameter("File", "string", f"{name}.exo")),
                 _list("Decomposition", _parameter("Subdomains", "int", subdomains), _parameter("Seed", "int", scene.seed)),
                 _list("Materials", *materials), _list("Boundary Conditions", *_conditions(scene)), _list("Contact", *_interfaces(scene)),
                 _list("Solver", _parameter("Relative Tolerance", "double", scene.tolerance),
                       _parameter("Maximum Hessian Multiplications", "int", 1000)))


def _conditions(scene):
    top = f"{{top{scene.bodies - 1}}}"
    held = {"all bodies": range(scene.bodies), "lowest body": [0], "contact": []}[scene.held]
    clamp = [_list("clamp", _parameter("Type", "string", "Displacement"),
                   _parameter("Sets", "Array(string)", _array(f"clamp{b}" for b in held)),
                   _parameter("Components", "string", "xyz"), _parameter("Value", "Array(double)", "{0.0, 0.0, 0.0}"))]
    return [*(clamp if held else []),
            _list("press", _parameter("Type", "string", "Pressure"), _parameter("Sets", "Array(string)", top), _parameter("Value", "double", 1.0)),
            _list("pull", _parameter("Type", "string", "Traction"), _parameter("Sets", "Array(string)", top),
                  _parameter("Value", "Array(double)", _array(scene.pull)))]


def _interfaces(scene):
    angle = math.radians(scene.angle)
    friction = [_parameter("Law", "string", scene.law)]
    if scene.law != "Tied":
        friction += [_parameter("Coefficients", "Array(double)", _array(scene.friction)),
                     _parameter("Principal Direction", "Array(double)", _array((math.cos(angle), math.sin(angle), 0)))]
    if scene.law == "Tresca":
        friction.append(_parameter("Slip Bound", "double", scene.slip_bound))
    lists = [_list(f"between{b}", _parameter("Secondary Side Set", "string", f"bottom{b}"), _parameter("Primary Side Set", "string", f"top{b - 1}"),
                   _list("Friction", *friction)) for b in range(1, scene.bodies)]
    if scene.plane:
        lists.append(_list("ground", _parameter("Secondary Side Set", "string", "bottom0"),
                           _list("Rigid Plane", _parameter("Point", "Array(double)", "{0.0, 0.0, 0.0}"),
                                 _parameter("Normal", "Array(double)", "{0.0, 0.0, 1.0}")), _list("Friction", *friction)))
    return lists
