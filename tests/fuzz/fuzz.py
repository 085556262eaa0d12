#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs haptos on mutated inputs and checks how every run ends.

    fuzz.py --server build/sanitize/bin/haptos_fuzz_server --meshes build/sanitize/bin/regression_meshes --count 10000 --seed 7

Input number i of a seed is always the same; `--only i --keep FOLDER` makes it again and leaves its files.  A run must end with
status 0, 1, 2 or 3 within `--seconds`, without a signal or a sanitizer's finding; with status 1 or 3 it prints one line on stderr
and leaves no result; and its memory must be in proportion to its files.  Exit status 1 if one did not.
"""
import argparse
import collections
import json
import os
import pathlib
import random
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "regression")]

try:
    import netCDF4
    import mutations
    import netcdf_classic
    if "hdf5 structure" in sys.argv:
        import hdf5_mutations
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)
import haptos_runs

KINDS = {"xml": 8, "exodus structure": 5, "exodus bytes": 3, "hdf5 bytes": 2, "command line": 2}
ALONE = "hdf5 structure"  # slow: drawn by --kind alone
# Reports go to files, of faults too, as a trial has no stderr; short stacks and little memory that waits, for speed.
SANITIZER = ":".join(["detect_leaks=0", "allocator_may_return_null=1", "log_path=sanitizer", "malloc_context_size=3", "quarantine_size_mb=48",
                      *(f"handle_{signal}=2" for signal in ("segv", "sigbus", "sigfpe", "sigill", "abort"))])
TRIAL_SECONDS = 20  # then it is ended, without a report
ALLOWED_MB = 400  # beside a scene of a few hundred unknowns; its own peak is below 40


class Seeds:
    """The right inputs that are changed."""

    def __init__(self, meshes, folder):
        subprocess.run([meshes, str(folder)], check=True)
        self.mesh = (folder / "stack.exo").read_bytes()
        self.exodus = netcdf_classic.read(folder / "stack.exo")
        self.hdf5 = _as_hdf5(folder / "stack.exo", folder / "stack_hdf5.exo")
        two_beams = (haptos_runs.INPUTS / "table31.xml").read_text()
        smalse = haptos_runs.stack(Solver={"Method": "SMALSE", "Relative Tolerance": 1e-4})
        field = haptos_runs.stack(Solver={"Method": "Subspace Newton"})
        field["Boundary Conditions"]["press"]["Value"] = "1+x*y"
        self.scenes = [haptos_runs.xml_of(haptos_runs.STACK), haptos_runs.xml_of(smalse), haptos_runs.xml_of(field), two_beams]


def _as_hdf5(source, target):
    with netCDF4.Dataset(source) as old, netCDF4.Dataset(target, "w", format="NETCDF4") as new:
        old.set_auto_mask(False)
        new.setncatts({a: old.getncattr(a) for a in old.ncattrs()})
        for name, dimension in old.dimensions.items():
            new.createDimension(name, None if dimension.isunlimited() else len(dimension))
        for name, variable in old.variables.items():
            copy = new.createVariable(name, variable.dtype, variable.dimensions, zlib=bool(variable.dimensions) and name.startswith("c"))
            copy.setncatts({a: variable.getncattr(a) for a in variable.ncattrs()})
            copy[:] = variable[:]
    return target.read_bytes()


def make_input(seeds, options, number, folder):
    """Writes the files of one input and returns (kind, arguments)."""
    chance = random.Random(f"{options.seed} {number}")
    drawn = chance.choices(list(KINDS), KINDS.values())[0]
    kind = options.kind or drawn
    scene, mesh, arguments = seeds.scenes[0].encode(), seeds.mesh, ["scene.xml"]
    if kind == "xml":
        scene = mutations.mutate_xml(chance, chance.choice(seeds.scenes))
        # A generated mesh may be as large as it likes; here it is one of few elements, unless the size itself was changed.
        scene = scene.replace(b'Subdomains Per Edge" type="int" value="4"', b'Subdomains Per Edge" type="int" value="1"')
    elif kind == "exodus structure":
        mesh = netcdf_classic.to_bytes(mutations.mutate_exodus(chance, seeds.exodus))
    elif kind == "exodus bytes":
        mesh = mutations.mutate_bytes(chance, seeds.mesh)
    elif kind == "hdf5 bytes":
        mesh = mutations.mutate_bytes(chance, seeds.hdf5, kinds=(0, 1, 4, 5))  # its length is kept: the library looks at it first
    elif kind == ALONE and chance.random() < 0.5:
        mesh = hdf5_mutations.mutate_plain(chance, seeds.exodus)
    elif kind == ALONE:
        mesh = hdf5_mutations.mutate_objects(chance, seeds.hdf5)
    else:
        arguments = mutations.command_line(chance, "scene.xml")
    (folder / "scene.xml").write_bytes(scene)
    (folder / "stack.exo").write_bytes(mesh)
    return kind, arguments


class Server:
    """haptos_fuzz_server in a folder of its own; started again where it should end."""

    def __init__(self, options, folder):
        ranks = [] if options.ranks == 1 else [*shlex.split(options.mpirun), "-n", str(options.ranks)]
        stay = ["--stay"] if options.stay or ranks else []
        self.start = {"args": [*ranks, options.server, *stay, str(options.seconds)], "cwd": folder, "stdin": subprocess.PIPE, "stdout": subprocess.PIPE,
                      "stderr": subprocess.DEVNULL if ranks else None, "text": True,
                      "env": {"OPENBLAS_NUM_THREADS": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                              "OMPI_MCA_mpi_yield_when_idle": "1",
                              **os.environ, "UBSAN_OPTIONS": "print_stacktrace=1",
                              "ASAN_OPTIONS": SANITIZER + ":" + os.environ.get("ASAN_OPTIONS", "")}}
        self.is_sanitized = b"__asan_init" in pathlib.Path(options.server).read_bytes()
        self.process = subprocess.Popen(**self.start)

    def run(self, arguments):
        self.process.stdin.write("".join(a.encode("utf-8", "surrogateescape").hex() + "," for a in arguments) + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline().split()
        if len(answer) != 3:  # a server that stays went with the run; mpirun tells the signal as the shell does
            code = self.process.wait()
            self.process = subprocess.Popen(**self.start)
            return code if code < 0 else 128 - code if code > 128 else -98, 0.0, 0.0
        return int(answer[0]), float(answer[1]), float(answer[2])

    def stop(self):
        self.process.stdin.close()
        self.process.wait()


LIBRARIES = ("libhdf5", "libnetcdf", "libexoIIv2", "libsz", "libz.")


def is_of_libraries(report):
    """Whether a report speaks of code and memory of the libraries alone: they would harm themselves only; or of a trial's limit."""
    if "AddressSanitizer failed to allocate" in report and "error code: 12" in report:
        return True
    stacks = [[line for line in part.splitlines() if line.lstrip().startswith("#") and "sanitizer" not in line and "libasan" not in line]
              for part in report.split("\n\n")]
    tops = [stack[0] for stack in stacks if stack]
    return bool(tops) and all(any(library in top for library in LIBRARIES) for top in tops)


ON_TRIAL = "ends in a fault of the HDF5 library"


def text_of(path):
    return path.read_text(errors="replace") if path.exists() else ""


def finding(folder, err, is_trial_explained):
    """The first line of what a sanitizer tells.  What it finds in the libraries on trial ends the trial, as any fault there does."""
    reports = [text_of(path) for path in folder.glob("sanitizer.*")]
    for report in [*(r for r in reports if not is_of_libraries(r)), *([err] if "runtime error" in err else [])]:
        lines = [line.strip() for line in report.splitlines() if line.strip("= ")]
        return " ".join(lines[:1] + [line for line in lines if line.startswith("#") and "Haptos" in line][:1])
    if ON_TRIAL in err and not reports and not is_trial_explained:
        return "a trial ends without a report"
    return None


def complaint(folder, status, megabytes, is_trial_explained):
    """What is wrong with the end of a run, or None."""
    err = text_of(folder / "err")
    lines = [line for line in err.splitlines() if line.strip()]
    found = finding(folder, err, is_trial_explained)
    if found:
        return f"sanitizer: {found}"
    if status == -14:
        return "hangs"
    if status not in (0, 1, 2, 3):
        return f"status {status}: {lines[-1] if lines else ''}"
    if megabytes > ALLOWED_MB:
        return f"takes {megabytes:.0f} MB"
    if status not in (1, 3):
        return None
    if len(lines) != 1 or not lines[0].startswith("haptos: ") or len(lines[0]) > 2000:
        return f"status {status} with {len(lines)} lines on stderr"
    if any(word in err for word in ("Throw ", ".cpp", "Teuchos", "internal error")):
        return "speaks of its inside"
    left = {p.name for p in folder.iterdir() if not p.name.startswith("sanitizer.")} - {"scene.xml", "stack.exo", "out", "err"}
    return f"leaves {sorted(left)}" if left else None


def clean(folder):
    for path in folder.iterdir():
        shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()


def work(seeds, numbers, folder, options, note):
    server = Server(options, folder)
    for number in numbers:
        clean(folder)
        kind, arguments = make_input(seeds, options, number, folder)
        status, seconds, megabytes = server.run(arguments)
        wrong = complaint(folder, status, megabytes, not server.is_sanitized or seconds > TRIAL_SECONDS)
        note(number, kind, (status, ON_TRIAL in text_of(folder / "err")), seconds, megabytes, wrong)
    server.stop()


class Notes:
    def __init__(self, total):
        self.on_trial = collections.Counter()
        self.ends, self.worst, self.complaints = collections.Counter(), collections.defaultdict(lambda: [0.0, 0.0]), []
        self.total, self.lock = total, threading.Lock()

    def __call__(self, number, kind, end, seconds, megabytes, wrong):
        status, on_trial = end
        with self.lock:
            self.ends[kind, status] += 1
            self.on_trial[kind] += on_trial
            worst = self.worst[kind]
            worst[:] = max(worst[0], seconds), max(worst[1], megabytes)
            if wrong:
                self.complaints.append({"number": number, "kind": kind, "what": wrong})
                print(f"input {number} ({kind}): {wrong}", flush=True)

    def print_table(self):
        statuses = sorted({s for _, s in self.ends})
        print("| kind | inputs | " + " | ".join(f"status {s}" for s in statuses) + " | fault on trial | longest [s] | most memory [MB] |")
        print("|---" * (len(statuses) + 5) + "|")
        for kind in sorted(self.worst):
            counts = [self.ends[kind, s] for s in statuses]
            print(f"| {kind} | {sum(counts)} | " + " | ".join(map(str, counts)) + " | {} | {:.1f} | {:.0f} |".format(self.on_trial[kind], *self.worst[kind]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--server", required=True)
    parser.add_argument("--meshes", required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--only", type=int)
    parser.add_argument("--kind", choices=[*KINDS, ALONE], help="all inputs of one kind; else five are drawn")
    parser.add_argument("--keep", type=pathlib.Path)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--stay", action="store_true", help="all runs in one process: fast, but one may spoil the next")
    parser.add_argument("--ranks", type=int, default=1, help="more than one stay")
    parser.add_argument("--mpirun", default="mpirun --oversubscribe --bind-to none")
    parser.add_argument("--seconds", type=int, default=60)
    parser.add_argument("--figures", type=pathlib.Path, help="JSON")
    options = parser.parse_args()
    options.server = str(pathlib.Path(options.server).resolve())
    numbers = range(options.first, options.first + options.count) if options.only is None else range(options.only, options.only + 1)
    notes = Notes(len(numbers))
    with tempfile.TemporaryDirectory(prefix="haptos_fuzz_") as temporary:
        seeds = Seeds(options.meshes, pathlib.Path(temporary))
        threads = []
        for k in range(options.workers):
            folder = pathlib.Path(temporary) / f"worker{k}" if not options.keep else options.keep.resolve()
            folder.mkdir(parents=True, exist_ok=True)
            threads.append(threading.Thread(target=work, args=(seeds, numbers[k::options.workers], folder, options, notes)))
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    notes.print_table()
    if options.figures:
        options.figures.write_text(json.dumps({"seed": options.seed, "count": len(numbers), "complaints": notes.complaints, "on_trial": notes.on_trial, "worst": notes.worst,
                                               "ends": {f"{k}: {s}": n for (k, s), n in sorted(notes.ends.items())}}, indent=1) + "\n")
    done = sum(notes.ends.values())
    print(f"{done} of {len(numbers)} inputs, {len(notes.complaints)} complaints")
    return 0 if done == len(numbers) and not notes.complaints else 1


if __name__ == "__main__":
    sys.exit(main())
