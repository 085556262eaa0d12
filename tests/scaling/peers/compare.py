#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Haptos beside PETSc, GetFEM and CalculiX on the same two beams, one core, CPU seconds.  See README.md."""
import argparse
import functools
import glob
import json
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
INPUT = HERE / "beams.xml"
PYTHON = "/usr/bin/python3" if os.path.exists("/usr/bin/python3") else sys.executable  # apt's modules are this one's
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1",
              "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
BRICKS = {8: (2, 4), 12: (2, 6), 16: (2, 8), 20: (4, 5), 24: (4, 6), 32: (4, 8), 48: (8, 6)}  # N: k, p with k p = N


HUGE_PAGES = {"GLIBC_TUNABLES": "glibc.malloc.hugetlb=1"}  # for all programs alike; the program haptos asks for them by itself, a library does not


def environment():
    env = {**os.environ, **ONE_THREAD}
    petsc = sorted(glob.glob("/usr/lib/petscdir/*/*/lib/python3/dist-packages"))
    env["PYTHONPATH"] = os.pathsep.join(petsc + [env.get("PYTHONPATH", "")])
    return env


def available():
    """What is installed; the rest is named and left out."""
    env, found = environment(), set()
    for name, module, package in (("PETSc", "petsc4py", "python3-petsc4py"), ("GetFEM", "getfem", "python3-getfem")):
        if subprocess.run([PYTHON, "-c", "import numpy, " + module], env=env, capture_output=True, check=False).returncode == 0:
            found.add(name)
        else:
            print("%s is missing: the Python module %s (Debian: %s)" % (name, module, package))
    if shutil.which("ccx") or shutil.which("ccx_2.20"):
        found.add("CalculiX")
    else:
        print("CalculiX is missing: the program ccx (Debian: calculix-ccx)")
    return found


def cpu_seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, env=environment(), check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def two_beams(k, p):
    return ["--set", "Mesh->Two Beams->Subdomains Per Edge=%d" % k, "--set", "Mesh->Two Beams->Elements Per Subdomain Edge=%d" % p]


@functools.lru_cache(maxsize=None)
def start_seconds(program):
    """CPU seconds of a run without work: libraries, MPI, reading the input."""
    with tempfile.TemporaryDirectory() as folder:
        return cpu_seconds([program, str(INPUT), "--validate-only", "--summary", os.path.join(folder, "s.json"), *two_beams(1, 2)])


def run_haptos(program, n, method, extra=()):
    """Summary of one run with its CPU seconds: `cpu` in all, `fcs` those of factor, coarse and solve.

    The latter by their share of the wall, the start of the program (its libraries, MPI) taken off before.
    """
    with tempfile.TemporaryDirectory() as folder:
        summary = os.path.join(folder, "s.json")
        command = [program, str(INPUT), "--summary", summary, "--output", os.path.join(folder, "r.exo")]
        command += two_beams(*BRICKS[n])
        for item in ("Decomposition->Method=" + method, *extra):
            command += ["--set", item]
        cpu = cpu_seconds(command)
        result = json.loads(pathlib.Path(summary).read_text())
    result["cpu"] = cpu
    times = result["time"]
    result["fcs"] = (cpu - start_seconds(program)) * (times["factor"] + times["coarse"] + times["solve"]) / times["total"]
    if result["solver"]["status"] != "converged":
        sys.exit("Haptos did not converge: " + result["solver"]["reason"])
    return result


def run_peer(script, *arguments):
    run = subprocess.run([PYTHON, str(HERE / script), *arguments], env=environment(), capture_output=True, text=True, check=False)
    if run.returncode != 0:
        print("  %s failed: %s" % (script, (run.stderr or run.stdout).strip().splitlines()[-1]))
        return None
    return json.loads(run.stdout.strip().splitlines()[-1])


def verdict(ok):
    return "holds" if ok else "DOES NOT HOLD"


def least(repeat, run, seconds):
    """The fastest of some runs: what a busy machine, or one that hands out memory slowly, adds is no program's own."""
    runs = [run() for _ in range(repeat)]
    return None if None in runs else min(runs, key=seconds)


def compare_petsc(program, n, repeat):
    peer = least(repeat, lambda: run_peer("peer_petsc.py", "-n", str(n)), lambda run: run["setup"] + run["solve"])
    if peer is None:
        return None
    if not peer["residual"] < 2e-6:
        print("  PETSc did not converge")
        return None
    seconds = peer["setup"] + peer["solve"]
    print("  PETSc CG+GAMG, tied, %d unknowns: set-up %.2f + solve %.2f s, %d iterations, true residual %.1e" %
          (peer["unknowns"], peer["setup"], peer["solve"], peer["iterations"], peer["residual"]))
    for law, extra, goals in (("frictional", (), (1.5, 0.7)), ("tied", ("Contact->interface->Friction->Law=Tied",), (0.7, 0.7))):
        for method, goal in zip(("METIS", "Bricks"), goals):
            ours = least(repeat, lambda: run_haptos(program, n, method, extra), lambda run: run["fcs"])
            print("  Haptos, %s, %s: factor + coarse + solve %.2f s, %d multiplications, %d subdomains: %.2f times PETSc (goal %.1f)" %
                  (law, method, ours["fcs"], ours["solver"]["hessian_multiplications"], ours["model"]["subdomains"], ours["fcs"] / seconds, goal))
    return seconds


def compare_trilinos(program, n, repeat, petsc):
    """Through Stratimikos, in turns in one process: medians.  `petsc`: seconds of the same problem, or None."""
    for method in ("METIS", "Bricks"):
        command = [program, str(INPUT), *two_beams(*BRICKS[n]), "--set", "Decomposition->Method=" + method, "--", str(repeat),
                   str(HERE / "muelu.xml"), str(HERE / "haptos.xml")]
        run = subprocess.run(command, env={**environment(), "OMP_THREAD_LIMIT": "1"}, capture_output=True, text=True, check=False)
        if run.returncode != 0:
            print("  %s failed: %s" % (program, (run.stderr or run.stdout).strip()[-300:]))
            return
        peer, ours = (json.loads(line) for line in run.stdout.splitlines() if line.startswith("{"))
        seconds = ours["setup"] + ours["solve"]
        for who in (peer, ours):
            print("  Stratimikos, %s, tied, %s, %d unknowns, %d subdomains: set-up %.2f + solve %.2f s, %d iterations, true residual %.1e" %
                  (who["solver"], method, who["unknowns"], who["subdomains"], who["setup"], who["solve"], who["iterations"], who["residual"]))
        print("    Haptos: %.2f times CG + MueLu, %.2f by the fastest runs%s (goal 0.7); work done agrees within %.0e" %
              (seconds / (peer["setup"] + peer["solve"]), ours["least"] / peer["least"], "" if petsc is None else ", %.2f times PETSc" % (seconds / petsc), abs(peer["work"] / ours["work"] - 1)))


def compare_contact(program, n, name, script, goal, tolerance):  # minutes a run: once
    peer = run_peer(script, str(n))
    if peer is None:
        return
    ours = run_haptos(program, n, "METIS")
    contact = ours["contact"]["interface"]
    tangential = sum(f * f for f in contact["tangential_force"]) ** 0.5
    difference = abs(peer["tangential_force"] / tangential - 1)
    print("  %s %.2f s, Haptos in all %.2f s: %.1f times as fast (goal %d)" % (name, peer["total"], ours["cpu"], peer["total"] / ours["cpu"], goal))
    print("    normal force %.3f against %.3f, tangential %.3f against %.3f: agreement of the latter within %.0f %% %s" %
          (peer["normal_force"], contact["normal_force"], peer["tangential_force"], tangential, 100 * tolerance, verdict(difference < tolerance)))


PEERS = ["PETSc", "Trilinos", "GetFEM", "CalculiX"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--haptos", default=str(HERE.parents[2] / "build/release/bin/haptos"))
    parser.add_argument("--elements", type=int, nargs="+", default=[16], choices=sorted(BRICKS), help="N, elements a unit length")
    parser.add_argument("--peers", nargs="+", default=PEERS, choices=PEERS)
    parser.add_argument("--repeat", type=int, default=3, help="runs of PETSc and beside it, of which the fastest counts")
    parser.add_argument("--trilinos", default=str(HERE.parents[2] / "build/release/bin/peer_trilinos"), help="built by: ninja -C build/release bin/peer_trilinos")
    parser.add_argument("--huge-pages", action="store_true", help="the C library asks for huge pages (glibc.malloc.hugetlb=1), in every program")
    options = parser.parse_args()
    if options.huge_pages:
        ONE_THREAD.update(HUGE_PAGES)
    found = available() & set(options.peers)
    if "Trilinos" in options.peers:
        if shutil.which(options.trilinos):
            found.add("Trilinos")
        else:
            print("Trilinos is missing: the program %s (ninja -C build/release bin/peer_trilinos; needs trilinos-all-dev)" % options.trilinos)
    for n in options.elements:
        print("N = %d" % n, flush=True)
        petsc = compare_petsc(options.haptos, n, options.repeat) if "PETSc" in found else None
        if "Trilinos" in found:
            compare_trilinos(options.trilinos, n, options.repeat, petsc)
        if "GetFEM" in found:
            compare_contact(options.haptos, n, "GetFEM", "peer_getfem.py", 10, 0.05)
        if "CalculiX" in found:
            compare_contact(options.haptos, n, "CalculiX", "peer_calculix.py", 40, 0.05)


if __name__ == "__main__":
    main()
