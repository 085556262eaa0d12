# SPDX-License-Identifier: BSD-3-Clause
"""The summary's keys and types, and the program's ways to say something without solving."""
import os
import pathlib
import platform
import resource
import subprocess

import haptos_runs
from haptos_runs import SceneTest, run_haptos, stack

NUMBER = (int, float)
COUNT = int

KEYS = {
    "haptos": {"version": str, "build": str, "ranks": COUNT},
    "model": {"bodies": COUNT, "subdomains": COUNT, "primal_unknowns": COUNT, "dual_unknowns": COUNT,
              "kernel_dimension": COUNT, "contact_pairs": COUNT, "discretization": str, "law": str, "left_out": list},
    "solver": {"method": str, "status": str, "reason": str, "outer_iterations": COUNT, "hessian_multiplications": COUNT,
               "preconditioner_applications": COUNT, "coarse_solves": COUNT, "local_solves": COUNT, "history": list,
               "deflation": {"motions": COUNT, "applications": COUNT},
               "subspace": {"pairs": COUNT, "compressions": COUNT, "memory_mb": NUMBER}},
    "accuracy": {name: NUMBER for name in ("equilibrium", "field_equilibrium", "continuity", "penetration", "compression",
                                           "complementarity", "cone", "slip_law", "kkt")},
    "contact": {"joint": {"normal_force": NUMBER, "tangential_force": list, "stick": COUNT, "slip": COUNT,
                          "open": COUNT, "max_pressure": NUMBER}},
    "time": {name: NUMBER for name in ("read", "decompose", "assemble", "factor", "coarse", "solve", "recover",
                                       "write", "total")},
    "time_over_ranks": {name: {"min": NUMBER, "mean": NUMBER, "max": NUMBER} for name in ("read", "solve", "total")},
    "memory": {"peak_rss_mb": list, "over_ranks": {"peak_rss_mb": {"min": NUMBER, "mean": NUMBER, "max": NUMBER}}},
    "machine": {"host": str, "hosts": COUNT, "processors": COUNT, "processor": str, "mpi": str, "blas": str, "trilinos": str, "compiler": str},
    "local": {name: NUMBER for name in ("elements", "elements_all", "factor_entries", "factor_entries_all", "flops", "flops_all", "bytes_read",
                                        "bytes_read_all")},
    "coarse": {"unknowns": COUNT, "factors": COUNT, "blocks": COUNT, "factor_entries": COUNT, "factor_entries_all": COUNT,
               "between": COUNT, "last": COUNT, "flops": NUMBER, "flops_all": NUMBER, "entries_read": NUMBER, "entries_read_all": NUMBER, "set_ups": COUNT,
               "set_up_seconds": NUMBER, "solves": COUNT, "solve_seconds": NUMBER, "solve_bytes": COUNT},
    "communication": {name: list for name in ("reductions", "other_collectives", "messages", "message_bytes",
                                              "collective_bytes", "bytes_sent")}
                     | {"over_ranks": {"bytes_sent": {"min": NUMBER, "mean": NUMBER, "max": NUMBER}}}
                     | {"largest_of_phase": {"solve": {"reductions": COUNT, "bytes_sent": COUNT}},
                        "jump": {"vectors": COUNT, "messages": list, "message_bytes": list},
                        "jump_transposed": {"vectors": COUNT, "messages": list, "message_bytes": list}},
}
HISTORY = {"hessian_multiplications": COUNT, "residual": NUMBER, "stick": COUNT, "slip": COUNT, "open": COUNT,
           "reductions": COUNT, "bytes_sent": COUNT}


class Summary(SceneTest):
    def solve(self, scene, *arguments, ranks=1, counting=False):
        outcome = self.run_scene(scene, *arguments, ranks=ranks, counting=counting)
        self.assertEqual((outcome.status, outcome.messages), (0, []), outcome)
        return self.summary()

    def assert_keys(self, found, wanted, path=""):
        for key, kind in wanted.items():
            self.assertIn(key, found, path)
            if isinstance(kind, dict):
                self.assert_keys(found[key], kind, f"{path}/{key}")
            else:
                self.assertIsInstance(found[key], kind, f"{path}/{key}")
                self.assertNotIsInstance(found[key], bool, f"{path}/{key}")

    # An OpenBLAS that does not know the processor takes kernels without AVX; the program has it take others, and the user has the last word.
    def test_kernels_of_the_processor(self):
        blas = self.solve(stack())["machine"]["blas"]
        cpu = pathlib.Path("/proc/cpuinfo")
        if "OpenBLAS" in blas and cpu.exists() and {"avx2", "fma"} <= set(cpu.read_text().split()):
            self.assertNotIn("Prescott", blas)
        os.environ["OPENBLAS_CORETYPE"] = "Prescott"
        try:
            blas = self.solve(stack())["machine"]["blas"]
        finally:
            del os.environ["OPENBLAS_CORETYPE"]
        if "DYNAMIC_ARCH" in blas and platform.machine() == "x86_64":
            self.assertIn("Prescott", blas)

    def test_every_key(self):
        for ranks in (1, 3):
            summary = self.solve(stack(Title="two cubes"), ranks=ranks, counting=True)
            self.assert_keys(summary, KEYS)
            self.assertEqual(summary["haptos"]["title"], "two cubes")
            self.assertGreaterEqual(summary["model"]["congruence_classes"], 1)
            self.assertEqual(summary["haptos"]["ranks"], ranks)
            self.assertEqual(len(summary["memory"]["peak_rss_mb"]), ranks)
            for name, seconds in summary["time_over_ranks"].items():
                self.assertEqual(seconds["max"], summary["time"][name])
                self.assertTrue(0 <= seconds["min"] <= seconds["mean"] * (1 + 1e-12) <= seconds["max"] * (1 + 2e-12), (name, seconds))
            self.assertEqual(summary["machine"]["hosts"], 1)
            self.assertNotIn("/", summary["haptos"]["build"])
            sent = summary["communication"]
            self.assertEqual(sent["over_ranks"]["bytes_sent"]["max"], max(sent["bytes_sent"]))
            for name in ("reductions", "messages", "bytes_sent"):
                self.assertEqual(len(sent[name]), ranks)
                self.assertTrue(all((number > 0) == (ranks > 1) for number in sent[name]), sent[name])
            largest = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / (2 ** 20 if platform.system() == "Darwin" else 2 ** 10)
            self.assertTrue(all(10 < peak < 2000 and peak <= 1.01 * largest for peak in summary["memory"]["peak_rss_mb"]), largest)
            self.assertTrue(summary["model"]["left_out"] and all(isinstance(t, str) for t in summary["model"]["left_out"]))
            self.assertEqual(len(summary["contact"]["joint"]["tangential_force"]), 3)
            self.assertGreater(len(summary["solver"]["history"]), 0)
            for entry in summary["solver"]["history"]:
                self.assert_keys(entry, HISTORY)

    def test_work_of_subdomains(self):
        """All ranks together have the elements and, where no subdomains are alike, the factors of one."""
        arguments = [haptos_runs.INPUTS / "table31.xml", "--set", "Decomposition->Method=METIS", "--set", "Output->File=", "--summary", "summary.json",
                     "--set", "Mesh->Two Beams->Elements Per Subdomain Edge=4"]
        found = []
        for ranks in (1, 3):
            self.assertEqual(run_haptos(arguments, folder=self.folder, ranks=ranks).status, 0)
            found.append(self.summary())
        counts = "without CHOLMOD" not in found[0]["haptos"]["build"]
        one, three = (summary["local"] for summary in found)
        self.assertEqual(one["elements"], 2048)
        if not counts:
            self.assertEqual(three.pop("flops_all"), 0)
        for name in ("elements", "factor_entries", "flops") if counts else ("elements", "factor_entries"):
            self.assertEqual(one[name], one[name + "_all"])
            self.assertEqual(three[name + "_all"], one[name + "_all"])
            self.assertTrue(1 / 3 <= three[name] / three[name + "_all"] < 0.5)
        self.assertGreater(one["bytes_read"], 100 * one["factor_entries"])

    def test_nobody_stands_between_the_program_and_its_mpi(self):
        """Calls of MPI are counted by a program of its own; the other numbers are the same."""
        plain, counting = (self.solve(stack(), ranks=3, counting=counting) for counting in (False, True))
        self.assertEqual(set(counting) - set(plain), {"communication"})
        for entry in plain["solver"]["history"]:
            self.assertFalse({"reductions", "bytes_sent"} & set(entry))
        self.assertEqual(plain["contact"], counting["contact"])
        symbols = subprocess.run(["nm", "--defined-only", haptos_runs.programs.haptos], capture_output=True, text=True, check=True)
        self.assertNotIn(" MPI_", symbols.stdout)

    def test_numbers_fit_together(self):
        summary = self.solve(stack())
        model, solver, accuracy, joint = summary["model"], summary["solver"], summary["accuracy"], summary["contact"]["joint"]
        self.assertEqual(accuracy["kkt"], max(accuracy[key] for key in KEYS["accuracy"] if key != "kkt"))
        self.assertEqual(joint["stick"] + joint["slip"] + joint["open"], model["contact_pairs"])
        self.assertEqual(model["kernel_dimension"], 6 * model["subdomains"])
        self.assertEqual((model["bodies"], model["subdomains"], model["contact_pairs"]), (2, 4, 9))
        self.assertEqual(solver["status"], "converged")
        # every multiplication by F is one solve with each subdomain's matrix, and there are others
        self.assertGreaterEqual(solver["local_solves"], solver["hessian_multiplications"] * model["subdomains"])
        counts = [entry["hessian_multiplications"] for entry in solver["history"]]
        self.assertEqual(counts, sorted(counts))
        self.assertLessEqual(counts[-1], solver["hessian_multiplications"])

    def test_preconditioner_that_was_used(self):
        for values, name in (({}, "Dirichlet"), ({"Preconditioner__Type": "Lumped"}, "Lumped"),
                             ({"Preconditioner__Type": "None"}, "None"), ({"Solver__Method": "SMALSE"}, "None")):
            summary = self.solve(stack(**values))
            self.assertEqual(summary["model"]["preconditioner"], name)
            self.assertEqual(summary["solver"]["preconditioner_applications"] > 0, name != "None")

    def test_times_add_up(self):
        """On one rank; on several, each time is that of the slowest and the sum may be above the total."""
        arguments = [haptos_runs.INPUTS / "table31.xml", "--set", "Mesh->Two Beams->Elements Per Subdomain Edge=3",
                     "--set", "Output->File=", "--summary", "summary.json"]
        missing = []
        for _ in range(5):  # a busy machine may stop the program anywhere, between two phases too
            self.assertEqual(run_haptos(arguments, folder=self.folder).status, 0)
            time = self.summary()["time"]
            missing.append(2 - sum(time.values()) / time["total"])  # part of the total in no phase
            self.assertGreater(missing[-1], -1e-6)
        self.assertLess(min(missing), 0.03)

    def test_few_recycled_pairs(self):
        """The limit is reached, the memory is less, the answer the same."""
        arguments = [haptos_runs.INPUTS / "table31.xml", "--set", "Mesh->Two Beams->Elements Per Subdomain Edge=5",
                     "--set", "Solver->Relative Tolerance=1e-10", "--set", "Output->File=", "--summary", "summary.json"]
        found = []
        for more in ([], ["--set", "Solver->Maximum Recycled Pairs=20"]):
            self.assertEqual(run_haptos([*arguments, *more], folder=self.folder).status, 0)
            found.append(self.summary())
        (every, few), (a, b) = [s["solver"]["subspace"] for s in found], [s["contact"]["interface"] for s in found]
        self.assertGreater(every["pairs"], 20)
        self.assertEqual((every["compressions"], few["pairs"]), (0, 20))
        self.assertGreater(few["compressions"], 0)
        self.assertLess(few["memory_mb"], every["memory_mb"])
        for key in ("stick", "slip", "open"):
            self.assertEqual(a[key], b[key])
        self.assertAlmostEqual(a["normal_force"], b["normal_force"], delta=1e-6 * a["normal_force"])
        self.assertLess(found[1]["solver"]["hessian_multiplications"], 2 * found[0]["solver"]["hessian_multiplications"])

    def test_left_out_without_friction(self):
        for friction in ({"Law": "Frictionless"}, {"Law": "Coulomb", "Coefficients": [0.0, 0.0]},
                         {"Law": "Tresca", "Coefficients": [0.3, 0.3], "Slip Bound": 0.0}):
            scene = stack()
            scene["Contact"]["joint"]["Friction"] = friction
            model = self.solve(scene)["model"]
            self.assertEqual(model["law"], "Frictionless")
            self.assert_says(model, "no tangential multipliers", "'joint'")
            self.assert_says(model, "no mortar")
            with_friction = self.solve(stack())["model"]
            self.assertEqual(with_friction["dual_unknowns"] - model["dual_unknowns"], 2 * model["contact_pairs"])

    def test_left_out_with_tresca(self):
        scene = stack()
        scene["Contact"]["joint"]["Friction"] = {"Law": "Tresca", "Coefficients": [0.3, 0.3], "Slip Bound": 1.0}
        model = self.solve(scene)["model"]
        self.assertEqual(model["law"], "Tresca")
        self.assert_says(model, "no outer fixed point")
        self.assertNotIn("tangential", " ".join(model["left_out"]))

    def test_left_out_with_coulomb(self):
        model = self.solve(stack())["model"]
        self.assertEqual(model["law"], "Coulomb")
        self.assertNotIn("tangential", " ".join(model["left_out"]))
        self.assertNotIn("fixed point", " ".join(model["left_out"]))

    def test_left_out_without_contact(self):
        summary = self.solve(stack(Contact=None))
        self.assert_says(summary["model"], "no contact")
        self.assertNotIn("mortar", " ".join(summary["model"]["left_out"]))
        self.assertEqual((summary["model"]["contact_pairs"], summary["contact"]), (0, {}))
        self.assertEqual(summary["solver"]["method"], "PCPG")

    def assert_says(self, model, *parts):
        self.assertTrue(any(all(p in text for p in parts) for text in model["left_out"]), model["left_out"])


class ProgressLines(SceneTest):
    def test_one_line_on_a_terminal_many_in_a_log(self):
        (self.folder / "scene.xml").write_text(haptos_runs.xml_of(stack()))
        for ranks in (1, 2):
            terminal = haptos_runs.printed_on_terminal(["scene.xml"], ranks, self.folder)
            log = run_haptos(["scene.xml"], ranks, self.folder).out
            for text in (terminal, log):
                self.assertRegex(text, r"\[ +[\d.]+ s\] \d+ multiplications by F")
                self.assertRegex(text, r"converged: kkt")
            self.assertRegex(terminal, r"\r\[ +[\d.]+ s\] \d+ multiplications by F", f"{ranks} ranks")
            self.assertNotIn("\r", log, f"{ranks} ranks")


class WithoutSolving(SceneTest):
    def test_validate_only(self):
        solved = self.run_scene(stack(Output__File=""))
        self.assertEqual(solved.status, 0)
        model = self.summary()["model"]
        for ranks in (1, 3):
            (self.folder / "summary.json").unlink()
            outcome = self.run_scene(stack(), "--validate-only", ranks=ranks)
            self.assertEqual((outcome.status, outcome.messages), (0, []), outcome)
            summary = self.summary()
            self.assert_same(summary["model"], model)
            self.assertNotIn("solver", summary)
            self.assertFalse((self.folder / "result.exo").exists())
            self.assertNotIn("kkt", outcome.out)
            self.assertIn(f'{model["primal_unknowns"]} primal', outcome.out)

    def assert_same(self, found, wanted):
        for key in KEYS["model"]:
            self.assertEqual(found[key], wanted[key], key)

    def test_validate_only_finds_what_has_no_solution(self):
        scene = stack(Contact=None)
        del scene["Boundary Conditions"]["side"]
        for ranks in (1, 3):
            self.assert_one_message(self.run_scene(scene, "--validate-only", ranks=ranks), 3, "'upper'")
            self.assertFalse((self.folder / "summary.json").exists())

    def test_help_version_parameters(self):
        wanted = {"--help": ("usage:", "--validate-only", "Exit status"), "--version": ("haptos 0.",),
                  "--print-parameters": ("Relative Tolerance", "Subdomains Per Edge", "Slip Bound")}
        for option, parts in wanted.items():
            for ranks in (1, 3):
                outcome = run_haptos([option], ranks, self.folder)
                self.assertEqual((outcome.status, outcome.messages), (0, []), outcome)
                for part in parts:
                    self.assertIn(part, outcome.out)
                if ranks == 1:
                    text = outcome.out
                self.assertEqual(outcome.out, text, "printed once")

    def test_result_file_and_summary_by_option(self):
        outcome = self.run_scene(stack(), "--output", "other.exo", "--summary=other.json")
        self.assertEqual(outcome.status, 0, outcome)
        self.assertTrue((self.folder / "other.exo").exists() and (self.folder / "other.json").exists())
        self.assertFalse((self.folder / "result.exo").exists() or (self.folder / "summary.json").exists())


if __name__ == "__main__":
    haptos_runs.main()
