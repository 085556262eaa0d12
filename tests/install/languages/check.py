#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Installs a build, builds programs in C and Fortran on the installed copy, runs them and the Python example on one and two ranks, and
compares what all of them find with the program `haptos` of the copy on the same beams, whose model comes from XML.

    check.py --build FOLDER --cmake CMAKE --generator NAME --mpirun "mpirun --oversubscribe" [--flags="-fsanitize=address"]
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

try:
    import netCDF4
    import numpy as np
except ImportError as e:
    print(f"skipped: {e}")
    sys.exit(77)

SAME = 1e-9  # of the largest displacement
HERE = pathlib.Path(__file__).resolve().parent


def run(*command, status=0, **environment):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env={**os.environ, **environment})
    if done.returncode != status:
        sys.exit(f"{' '.join(map(str, command))}\nended with status {done.returncode} instead of {status}:\n{done.stdout}")
    return done.stdout


def sorted_rows(rows):
    """By place; the two beams touch, so the nodes of the joint come in pairs, told apart by the order in the file."""
    half = len(rows) // 2
    return np.concatenate([r[np.lexsort(np.round(r[:, :3].T, 6))] for r in (rows[:half], rows[half:])])


def read_exodus(file):
    with netCDF4.Dataset(file) as data:
        names = ["".join(c.decode() for c in row.compressed()) for row in data["name_nod_var"][:]]
        columns = [data[f"coord{d}"][:] for d in "xyz"] + [data[f"vals_nod_var{names.index('displacement_' + d) + 1}"][-1] for d in "xyz"]
    return sorted_rows(np.array(columns).T)


def compare(what, file, expected):
    found = sorted_rows(np.loadtxt(file))
    assert found.shape == expected.shape and np.allclose(found[:, :3], expected[:, :3], atol=1e-9), f"{what}: other nodes"
    error = np.abs(found - expected)[:, 3:].max() / np.abs(expected[:, 3:]).max()
    print(f"{what}: {error:.1e} from the program's displacements")
    if not error <= SAME:
        sys.exit(f"{what} differs by {error:.1e}")


def check_symbols(library):
    symbols = re.findall(r" T (\S+)", run("nm", "-D", "--defined-only", library))
    others = [s for s in symbols if not s.startswith("haptos_")]
    if others or len(symbols) < 20:
        sys.exit(f"{library} exports {len(symbols)} functions, among them {others[:5]}")


def environment_of_python(prefix, flags):
    """A sanitised library wants its sanitiser before all others; Python itself leaks."""
    environment = {"PYTHONPATH": str(prefix / "share/haptos/python")}
    if "address" in flags:
        runtime = [run("gcc", f"-print-file-name=lib{name}.so").strip() for name in ("asan", "ubsan")]
        environment.update(LD_PRELOAD=" ".join(runtime), ASAN_OPTIONS="detect_leaks=0")
    return environment


def check_python(prefix, mpirun, work, expected, environment):
    example = prefix / "share/haptos/python/example_beams.py"
    arguments = [sys.executable, example, "--tolerance", "1e-11", "--displacements"]
    print(run(*arguments, work / "python_1.txt", "--plot", work / "pressure.png", **environment).strip())
    compare("Python", work / "python_1.txt", expected)
    assert (work / "pressure.png").read_bytes()[:4] == b"\x89PNG" and (work / "pressure.png").stat().st_size > 5000, "no picture"
    print(run(sys.executable, HERE / "methods.py", **environment).strip())
    try:
        import mpi4py
    except ImportError:
        print("NOTICE: Python on two ranks is SKIPPED: there is no mpi4py")
        return
    print(run(*mpirun, "-n", "2", *arguments, work / "python_2.txt", **environment).strip(), f"(mpi4py {mpi4py.__version__})")
    compare("Python on 2 ranks", work / "python_2.txt", expected)
    print(run(*mpirun, "-n", "2", sys.executable, HERE / "methods.py", **environment).strip())


def main():
    parser = argparse.ArgumentParser()
    for name in ("build", "cmake", "generator", "mpirun"):
        parser.add_argument("--" + name, required=True)
    parser.add_argument("--flags", default="", help="of the compilers")
    arguments = parser.parse_args()
    mpirun = arguments.mpirun.replace(";", " ").split()
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        prefix = work / "installed copy"
        run(arguments.cmake, "--install", arguments.build, "--prefix", prefix)
        shutil.copytree(HERE, work / "source")
        run(arguments.cmake, "-S", work / "source", "-B", work / "build", "-G", arguments.generator, f"-DCMAKE_PREFIX_PATH={prefix}",
            *(f"-DCMAKE_{language}_FLAGS={arguments.flags}" for language in ("C", "Fortran")))
        run(arguments.cmake, "--build", work / "build")
        check_symbols(prefix / "lib/libhaptos_c.so")
        run(*mpirun, "-n", "1", prefix / "bin/haptos", HERE / "beams.xml", "--output", work / "xml.exo")
        expected = read_exodus(work / "xml.exo")
        for program in ("beams_c", "beams_fortran"):
            if not (work / "build" / program).exists():
                print(f"NOTICE: {program} is SKIPPED: there is no Fortran compiler")
                continue
            for ranks in (1, 2, 3):  # of three, two solve
                print(run(*mpirun, "-n", ranks, work / "build" / program, work / f"{program}_{ranks}.txt").strip())
                compare(f"{program} on {ranks} ranks", work / f"{program}_{ranks}.txt", expected)
        check_python(prefix, mpirun, work, expected, environment_of_python(prefix, arguments.flags))
    print("all languages find the same")


if __name__ == "__main__":
    main()
