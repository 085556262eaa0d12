#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks, from the #include lines, that arrows between packages point one way and that the headers that are installed
are those which somebody outside this project starts from, and what these include.

    tests/style/arrows.py [--root FOLDER] [--print]

Exit status 1 and one line a finding where something is wrong.  --print writes the arrows that there are.
"""
import argparse
import pathlib
import re
import sys

# What a package may include beside its own headers.  Tests may look at anything below their own package, and at each other's scenes.
MAY_INCLUDE = {
    "base": "",
    "input": "base",
    "linalg": "base",
    "law": "base",
    "mesh": "base",
    "qp": "law base",
    "coarse": "linalg base",
    "elasticity": "mesh linalg base",
    "pairing": "mesh law base",
    "decomposition": "mesh law base",
    "newton": "law coarse base",
    "feti": "coarse linalg decomposition base",
    "system": "feti newton qp law coarse linalg decomposition base",
    "results": "system feti law decomposition elasticity mesh base",
    "bindings": "system law input base",
    "stratimikos": "system base",
    "simulation": "results system feti newton qp coarse linalg law pairing decomposition elasticity mesh input base",
}

# Headers that a stranger starts from, beside those that the programs and the examples of tests/install include.
STARTS = """
    BoundEllipseSet BoxMesh ContactLaw ContactPairs DualPreconditioner DualProblem ExodusReader ExodusWriter NodalLoads
    RigidBodyModes Simulation SmalseSolMgr StiffnessAssembler SubspaceNewtonSolMgr
""".split()

INCLUDE = re.compile(r'^\s*#\s*include\s*["<](Haptos_\w+\.hpp)[">]', re.MULTILINE)


def includes(path):
    return INCLUDE.findall(path.read_text())


def read_packages(root):
    """Header name -> package; package -> its source files."""
    owner, files = {}, {}
    for folder in sorted((root / "packages").iterdir()):
        files[folder.name] = sorted((folder / "src").glob("Haptos_*"))
        for path in files[folder.name]:
            if path.suffix == ".hpp":
                owner[path.name] = folder.name
    return owner, files


def find_arrows(owner, files):
    """(from, to) -> one example, 'file includes header'."""
    arrows = {}
    for package, paths in files.items():
        for path in paths:
            for header in includes(path):
                target = owner.get(header)
                if target is None:
                    arrows.setdefault((package, "nowhere"), f"{path.name} includes {header}")
                elif target != package:
                    arrows.setdefault((package, target), f"{path.name} includes {header}")
    return arrows


def check_arrows(arrows, files):
    findings = [f"package '{p}' has no line in {pathlib.Path(__file__).name}" for p in files if p not in MAY_INCLUDE]
    for (package, target), example in sorted(arrows.items()):
        if package in MAY_INCLUDE and target not in MAY_INCLUDE[package].split():
            findings.append(f"{package} must not include {target}: {example}")
    return findings


def needed_outside(root, owner):
    """Headers that somebody outside starts from, and what these include in turn."""
    outside = list((root / "drivers").rglob("*.[ch]pp")) + list((root / "tests" / "install").rglob("*.[ch]pp"))
    wanted = [f"Haptos_{name}.hpp" for name in STARTS] + [h for path in outside for h in includes(path)]
    needed = set()
    while wanted:
        header = wanted.pop()
        if header in owner and header not in needed:
            needed.add(header)
            wanted += includes(root / "packages" / owner[header] / "src" / header)
    return needed


def installed_headers(root, package):
    text = (root / "packages" / package / "CMakeLists.txt").read_text()
    call = re.search(r"haptos_add_package\((.*?)\)", text, re.DOTALL)
    public = call and re.search(r"\bHEADERS(.*?)(?:PRIVATE_HEADERS|SOURCES|DEPENDS|$)", call.group(1), re.DOTALL)
    return set(re.findall(r"src/(Haptos_\w+\.hpp)", public.group(1))) if public else set()


def check_headers(root, owner, files):
    needed = needed_outside(root, owner)
    findings = [f"Haptos_{name}.hpp is a start and not there" for name in STARTS if f"Haptos_{name}.hpp" not in owner]
    for package in files:
        installed = installed_headers(root, package)
        own = {name for name, p in owner.items() if p == package}
        findings += [f"{package}: {h} is installed and no stranger comes by it: PRIVATE_HEADERS" for h in sorted(installed - needed)]
        findings += [f"{package}: {h} is needed outside and not installed: HEADERS" for h in sorted((needed & own) - installed)]
    return findings


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parents[2])
    parser.add_argument("--print", action="store_true", help="write the arrows that there are")
    arguments = parser.parse_args()
    owner, files = read_packages(arguments.root)
    arrows = find_arrows(owner, files)
    if arguments.print:
        for package in MAY_INCLUDE:
            print(f"{package} -> {' '.join(sorted(t for p, t in arrows if p == package)) or '(nothing)'}")
    findings = check_arrows(arrows, files) + check_headers(arguments.root, owner, files)
    for finding in findings:
        print(finding, file=sys.stderr)
    if not findings:
        print(f"{len(files)} packages, {len(arrows)} arrows, {len(owner)} headers: all as they should be")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
