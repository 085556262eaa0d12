# SPDX-License-Identifier: BSD-3-Clause
"""What the regression tests share: runs of the program, and the small scene that they change.

Every test script takes the programs on its command line and hands the rest to unittest:

    NAME_test.py --haptos PROGRAM [--counting PROGRAM] [--meshes PROGRAM] [--mpirun "COMMAND"] [unittest's arguments]
"""
import argparse
import copy
import dataclasses
import json
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile
import unittest
from xml.sax.saxutils import quoteattr

INPUTS = pathlib.Path(__file__).resolve().parents[2] / "inputs"
programs = argparse.Namespace()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--haptos", required=True)
    parser.add_argument("--counting", help="haptos with counters of MPI calls")
    parser.add_argument("--meshes")
    parser.add_argument("--server", help="haptos_fuzz_server")
    parser.add_argument("--mpirun", default="mpirun --oversubscribe")
    _, rest = parser.parse_known_args(namespace=programs)
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)


@dataclasses.dataclass
class Outcome:
    status: int
    out: str
    err: str

    @property
    def messages(self):
        """Lines of stderr that are the program's; mpirun's notes stand between lines of dashes."""
        lines, inside = [], False
        for line in self.err.splitlines():
            if line.startswith("-----"):
                inside = not inside
            elif line.strip() and not inside and not line.startswith("[warn] Epoll"):  # libevent in mpirun, on a busy machine
                lines.append(line)
        return lines


def start_of(program, arguments, ranks, folder):
    """Arguments of subprocess for a run."""
    command = [program, *map(str, arguments)]
    if ranks > 1:
        command = [*shlex.split(programs.mpirun), "-n", str(ranks), *command]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1",
                   "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                   "OMPI_MCA_mpi_yield_when_idle": "1"}
    return {"args": command, "cwd": folder, "env": environment}


def run_haptos(arguments, ranks=1, folder=None, timeout=3000, counting=False):
    program = programs.counting if counting else programs.haptos
    done = subprocess.run(**start_of(program, arguments, ranks, folder), capture_output=True, timeout=timeout)
    return Outcome(done.returncode, done.stdout.decode(), done.stderr.decode())


def printed_on_terminal(arguments, ranks=1, folder=None):
    """What a run writes to its stdout, or mpirun's, where that is a terminal."""
    ours, theirs = os.openpty()
    with subprocess.Popen(**start_of(programs.haptos, arguments, ranks, folder), stdout=theirs, stderr=subprocess.DEVNULL,
                          stdin=subprocess.DEVNULL):
        os.close(theirs)
        text = b""
        try:
            while part := os.read(ours, 4096):
                text += part
        except OSError:  # how Linux says that the other end is closed
            pass
    os.close(ours)
    return text.decode()


def _parameter(name, value):
    kind = {bool: "bool", int: "int", float: "double", str: "string"}
    if isinstance(value, list):
        return name, f"Array({kind[type(value[0])]})", "{" + ", ".join(map(str, value)) + "}"
    return name, kind[type(value)], str(value)


def xml_of(entries, name="Haptos", indent=""):
    """A Teuchos parameter list of nested dictionaries."""
    lines = [f"{indent}<ParameterList name={quoteattr(name)}>"]
    for key, value in entries.items():
        if isinstance(value, dict):
            lines.append(xml_of(value, key, indent + "  "))
        else:
            key, kind, text = _parameter(key, value)
            lines.append(f'{indent}  <Parameter name={quoteattr(key)} type="{kind}" value={quoteattr(text)}/>')
    return "\n".join([*lines, f"{indent}</ParameterList>"])


def displacement(sets, value=(0.0, 0.0, 0.0), components="xyz"):
    return {"Type": "Displacement", "Sets": list(sets), "Components": components, "Value": list(value)}


def material(blocks):
    return {"Element Blocks": list(blocks), "Young's Modulus": 1000.0, "Poisson's Ratio": 0.3}


STACK = {
    "Mesh": {"File": "stack.exo"},
    "Decomposition": {"Method": "METIS", "Subdomains": 4},
    "Materials": {"soft": material(["lower", "upper"])},
    "Boundary Conditions": {
        "floor": displacement(["lower_bottom"]),
        "side": displacement(["upper_west"]),
        "press": {"Type": "Pressure", "Sets": ["upper_top"], "Value": 1.0},
    },
    "Contact": {"joint": {
        "Secondary Side Set": "upper_bottom",
        "Primary Side Set": "lower_top",
        "Friction": {"Law": "Coulomb", "Coefficients": [0.3, 0.3]},
    }},
    "Output": {"File": "result.exo", "Summary": "summary.json"},
}


def stack(**changes):
    """Two cubes, one on the other.  `changes`: path with __ for -> and _ for a blank; None takes away."""
    scene = copy.deepcopy(STACK)
    for path, value in changes.items():
        *parents, last = [part.replace("_", " ") for part in path.split("__")]
        target = scene
        for parent in parents:
            target = target.setdefault(parent, {})
        if value is None:
            del target[last]
        else:
            target[last] = value
    return scene


class SceneTest(unittest.TestCase):
    """A folder of its own for every test, with the meshes in it."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="haptos_")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        if programs.meshes:
            subprocess.run([programs.meshes, str(self.folder)], check=True)

    def run_scene(self, scene, *arguments, ranks=1, counting=False):
        text = scene if isinstance(scene, str) else xml_of(scene)
        (self.folder / "scene.xml").write_text(text)
        return run_haptos(["scene.xml", *arguments], ranks, self.folder, counting=counting)

    def summary(self):
        return json.loads((self.folder / "summary.json").read_text())

    def assert_one_message(self, outcome, status, *parts):
        """One line on stderr, the status, all `parts` in the line, and nothing of the libraries' own."""
        self.assertEqual(outcome.status, status, outcome)
        self.assertEqual(len(outcome.messages), 1, outcome)
        message = outcome.messages[0]
        self.assertTrue(message.startswith("haptos: "), message)
        for part in parts:
            self.assertIn(part, message)
        for foreign in ("Throw number", "Throw test", ".cpp", "Teuchos", "terminate called"):
            self.assertNotIn(foreign, message)
