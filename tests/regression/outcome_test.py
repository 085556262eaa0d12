# SPDX-License-Identifier: BSD-3-Clause
"""Exit statuses 0, 2 and 3: what is solved, what is not converged, what has no solution."""
import json
import os
import re
import unittest.mock

import haptos_runs
from haptos_runs import INPUTS, SceneTest, displacement, run_haptos, stack

RANKS = (1, 3)


def sliding(force):
    """The upper cube is held by friction alone: pressed by 1, pulled by `force` along x; it slides at 0.3."""
    scene = stack()
    conditions = scene["Boundary Conditions"]
    del conditions["side"]
    conditions["pull"] = {"Type": "Traction", "Sets": ["upper_top"], "Value": [force, 0.0, 0.0]}
    return scene


def two_beams(test, ranks, status=0, example="two_beams", **values):
    """Summary of an example with other values, by path: `__` for `->`, `_` for a blank."""
    path = test.folder / "summary.json"
    sets = [word for name, value in values.items()
            for word in ("--set", "%s=%s" % (name.replace("__", "->").replace("_", " "), value))]
    done = run_haptos([INPUTS / f"{example}.xml", *sets, "--output", test.folder / "result.exo", "--summary", path], ranks, test.folder)
    test.assertEqual(done.status, status, done)
    return json.loads(path.read_text())


class NoSolution(SceneTest):
    def has_no_solution(self, scene, *parts):
        for ranks in RANKS:
            with self.subTest(ranks=ranks):
                outcome = self.run_scene(scene, ranks=ranks)
                self.assert_one_message(outcome, 3, *parts)
                self.assertNotIn("multiplications", outcome.out)
                self.assertFalse((self.folder / "result.exo").exists())
                self.assertFalse((self.folder / "summary.json").exists())

    def test_body_that_nothing_holds(self):
        scene = stack(Mesh__File="tower.exo")
        scene["Materials"]["soft"]["Element Blocks"].append("third")
        scene["Boundary Conditions"]["drift"] = {"Type": "Body Force", "Element Blocks": ["third"], "Value": [0.0, 2.0, 0.0]}
        self.has_no_solution(scene, "'third'", "translation along (0, 1, 0)", "held by nothing")

    def test_body_that_nothing_holds_turns(self):
        scene = stack()
        del scene["Boundary Conditions"]["side"], scene["Contact"]
        scene["Boundary Conditions"]["press"] = {
            "Type": "Traction", "Sets": ["upper_top"], "Value": ["0.5 - y", "x - 0.5", "0"]}
        self.has_no_solution(scene, "'upper'", "rotation about the axis (0, 0, 1) through (0.5, 0.5, 1.5)", "held by nothing")

    def test_body_pulled_off(self):
        scene = stack()
        del scene["Boundary Conditions"]["side"]
        scene["Boundary Conditions"]["press"]["Value"] = -1.0
        self.has_no_solution(scene, "'upper'", "translation along (0, 0, 1)")

    def test_beyond_the_sliding_limit(self):
        """The friction cone allows no force that works on (1, 0, 0.3), the normal of its side: the motion named."""
        self.has_no_solution(sliding(0.303), "'upper'", "translation along (0.96, 0, 0.29)", "friction")

    def test_prescribed_displacements_overlap(self):
        scene = stack()
        scene["Boundary Conditions"]["floor"] = displacement(["lower_bottom", "lower_top"])
        scene["Boundary Conditions"]["side"] = displacement(["upper_bottom"], (0.0, 0.0, -0.125))
        self.has_no_solution(scene, "'joint'", "node", "overlap", "0.125")


class Solved(SceneTest):
    def solve(self, scene, *arguments, ranks=1):
        outcome = self.run_scene(scene, *arguments, ranks=ranks)
        self.assertEqual(outcome.status, 0, outcome)
        self.assertEqual(outcome.messages, [], outcome)
        self.assertNotIn("\r", outcome.out, "a log gets plain lines")
        return self.summary()

    def test_held_by_friction_alone(self):
        for part in (0.5, 0.9, 0.98):
            with self.subTest(part=part):
                for ranks in RANKS:
                    summary = self.solve(sliding(0.3 * part), ranks=ranks)
                    joint = summary["contact"]["joint"]
                    self.assertLessEqual(summary["accuracy"]["kkt"], 1e-6)
                    self.assertAlmostEqual(joint["normal_force"], 1.0, delta=1e-5)
                    self.assertAlmostEqual(joint["tangential_force"][0], -0.3 * part, delta=1e-5)
                    self.assertGreater(joint["stick"], 0, "nothing sticks, so nothing holds")

    def test_without_mpirun_no_folder_is_shared(self):
        """Runs side by side would make and remove the same session folder of MPI."""
        no_folder = self.folder / "file"
        no_folder.touch()
        with unittest.mock.patch.dict(os.environ, TMPDIR=str(no_folder)):
            self.assertEqual(self.solve(stack())["haptos"]["ranks"], 1)

    def test_friction_along_one_axis_only(self):
        """The body is free to slide along the other axis, where no load acts."""
        for law in ({"Law": "Coulomb"}, {"Law": "Tresca", "Slip Bound": 1.0}):
            for coefficients in ([0.3, 0.0], [0.0, 0.3], [1e-300, 1e-300]):
                scene = sliding(0.0)
                scene["Contact"]["joint"]["Friction"] = {**law, "Coefficients": coefficients}
                with self.subTest(law=law, coefficients=coefficients):
                    for ranks in RANKS:
                        summary = self.solve(scene, ranks=ranks)
                        self.assertLessEqual(summary["accuracy"]["kkt"], 1e-6)
                        self.assertAlmostEqual(summary["contact"]["joint"]["normal_force"], 1.0, delta=1e-5)

    def test_no_preconditioner(self):
        """Automatic takes the method that needs none."""
        summary = self.solve(stack(Preconditioner__Type="None"))
        self.assertEqual(summary["solver"]["method"], "SMALSE")
        self.assertAlmostEqual(summary["contact"]["joint"]["normal_force"], self.solve(stack())["contact"]["joint"]["normal_force"], delta=1e-5)

    def test_slow_where_nothing_can_be_deflated(self):
        """A lumped preconditioner has no other to give way to: conjugate gradients go on."""
        values = {f"Materials__{name}__Poisson's_Ratio": 0.499 for name in ("steel", "aluminium")}
        for ranks in RANKS:
            summary = two_beams(self, ranks, example="table31", Preconditioner__Type="Lumped", Contact__interface__Friction__Law="Tied",
                                Decomposition__Method="METIS", Mesh__Two_Beams__Subdomains_Per_Edge=1,
                                Mesh__Two_Beams__Elements_Per_Subdomain_Edge=8, Solver__Relative_Tolerance=1e-9, **values)
            self.assertGreater(summary["solver"]["hessian_multiplications"], 60)
            self.assertEqual(summary["solver"]["deflation"]["motions"], 0)

    def test_long_ellipses_ask_for_no_spectral_modes(self):
        """Large subdomains, few pairs: they would cost more than all steps, and rigid motions do; near incompressibility nothing else does."""
        for poisson in (0.44, 0.4999):  # 3 modes, and 92
            values = {f"Materials__{name}__Poisson's_Ratio": poisson for name in ("steel", "aluminium")}
            for ranks in RANKS:
                with self.subTest(poisson=poisson, ranks=ranks):
                    summary = two_beams(self, ranks, example="table31", Decomposition__Method="METIS", Decomposition__Subdomains=4,
                                        Contact__interface__Friction__Coefficients="0.3, 3e-4", **values)
                    rigid = summary["model"]["kernel_dimension"]
                    check = self.assertEqual if poisson < 0.45 else self.assertGreater
                    check(summary["solver"]["deflation"]["motions"], rigid)
                    self.assertLessEqual(summary["solver"]["hessian_multiplications"], 24)

    def test_bodies_moved_apart(self):
        """No stress anywhere: forces are round-off, which nothing may be divided by."""
        scene = stack()
        del scene["Boundary Conditions"]["press"]
        for height in (1e-6, 1.0):
            scene["Boundary Conditions"]["side"] = displacement(["upper_top"], (0.0, 0.0, height))
            for ranks in RANKS:
                summary = self.solve(scene, ranks=ranks)
                self.assertLessEqual(summary["accuracy"]["kkt"], 1e-6)
                self.assertEqual(summary["contact"]["joint"]["open"], 9)
        del scene["Contact"]
        self.assertLessEqual(self.solve(scene)["accuracy"]["kkt"], 1e-6)

    def test_forces_of_a_tied_interface(self):
        scene = stack()
        del scene["Boundary Conditions"]["side"]
        scene["Contact"]["joint"]["Friction"] = {"Law": "Tied"}
        scene["Boundary Conditions"]["press"] = {"Type": "Traction", "Sets": ["upper_top"], "Value": [0.25, -0.5, 2.0]}
        for ranks in RANKS:
            joint = self.solve(scene, ranks=ranks)["contact"]["joint"]
            self.assertAlmostEqual(joint["normal_force"], -2.0, delta=1e-5)
            for force, wanted in zip(joint["tangential_force"], (-0.25, 0.5, 0.0)):
                self.assertAlmostEqual(force, wanted, delta=1e-5)
            self.assertEqual((joint["stick"], joint["slip"], joint["open"]), (9, 0, 0))

    def test_faces_listed_twice_are_loaded_once(self):
        forces = []
        for mesh, sets in (("stack.exo", ["upper_top"]), ("doubled.exo", ["upper_top", "upper_top"])):
            scene = stack(Mesh__File=mesh)
            scene["Boundary Conditions"]["press"]["Sets"] = sets
            forces.append(self.solve(scene)["contact"]["joint"]["normal_force"])
        self.assertGreater(forces[0], 0.1)
        self.assertAlmostEqual(forces[1], forces[0], places=9)

    def test_friction_by_expression_and_by_nodal_field(self):
        summaries = []
        for coefficients in (["0.1 + 0.05*x", "0.2"], ["MU", "0.2"]):
            for ranks in RANKS:
                scene = stack(Mesh__File="fields.exo")
                scene["Contact"]["joint"]["Friction"]["Coefficients"] = coefficients
                scene["Boundary Conditions"]["press"] = {"Type": "Traction", "Sets": ["upper_top"], "Value": [0.05, 0.2, -1.0]}
                summaries.append(self.solve(scene, ranks=ranks)["contact"]["joint"])
        self.assertGreater(summaries[0]["slip"], 0)
        for other in summaries[1:]:
            self.assertEqual(other["slip"], summaries[0]["slip"])
            for a, b in zip(other["tangential_force"], summaries[0]["tangential_force"]):
                self.assertAlmostEqual(a, b, places=6)

    def test_axis_ratios_of_thousands_with_few_pairs(self):
        """Subspace Newton alone, where it once stalled and SMALSE had to bring it on its way again."""
        for coefficients in ("{0.3,1e-4}", "{3.0,1e-3}"):
            for ranks in RANKS:
                summary = two_beams(self, ranks, Contact__interface__Friction__Coefficients=coefficients, Solver__Maximum_Recycled_Pairs=20)
                self.assertEqual(summary["solver"]["method"], "Subspace Newton")
                self.assertLessEqual(summary["solver"]["hessian_multiplications"], 40)
                self.assertLessEqual(summary["accuracy"]["kkt"], 1e-6)

    def test_one_method_hands_over_to_the_next(self):
        """A lumped preconditioner makes no condensed model, without which 20 pairs are too few for an axis ratio of 1e5: Newton gives
        up, SMALSE settles the states and hands back.  The summary tells who did how much."""
        for ranks in RANKS:
            summary = two_beams(self, ranks, example="table31", Mesh__Two_Beams__Subdomains_Per_Edge=1, Preconditioner__Type="Lumped",
                                Mesh__Two_Beams__Elements_Per_Subdomain_Edge=5, Contact__interface__Friction__Coefficients="{0.3,3e-6}",
                                Solver__Maximum_Recycled_Pairs=20, Solver__Maximum_Hessian_Multiplications=5000)
            solver = summary["solver"]
            work = re.findall(r"([A-Z][\w ]*) \((\d+)\)", solver["method"])
            self.assertEqual([who for who, _ in work[:3]], ["Subspace Newton", "SMALSE", "Subspace Newton"], solver["method"])
            self.assertEqual(sum(int(multiplications) for _, multiplications in work), solver["hessian_multiplications"])
            self.assertTrue(all(int(multiplications) > 10 for _, multiplications in work), solver["method"])
            self.assertLessEqual(summary["accuracy"]["kkt"], 1e-6)

    def test_smalse_as_published(self):
        """Every expansion with and without the early end of inner loops: the same answer, and each is heeded."""
        forces, counts = {}, {}
        for method, expansion, reduction in [("Subspace Newton", "Automatic", 0.5)] + [
                ("SMALSE", e, r) for e in ("Automatic", "Projected CG", "Fixed Step") for r in (0, 0.5)]:
            summary = two_beams(self, 1, Solver__Method=method, Solver__Relative_Tolerance=1e-8,
                                **{"Solver__SMALSE__Expansion": expansion, "Solver__SMALSE__Inner_Reduction": reduction})
            key = method, expansion, reduction
            joint = summary["contact"]["interface"]
            forces[key] = [joint["normal_force"], *joint["tangential_force"]]
            counts[key] = summary["solver"]["hessian_multiplications"], summary["solver"]["outer_iterations"]
        wanted = next(iter(forces.values()))
        for key, found in forces.items():
            for a, b in zip(found, wanted):
                self.assertAlmostEqual(a, b, delta=1e-6 * wanted[0], msg=key)
        self.assertEqual(len(set(counts.values())), len(counts), counts)
        self.assertLess(counts["SMALSE", "Automatic", 0.5], counts["SMALSE", "Fixed Step", 0], "the defaults do not pay")

    def test_smoothing_is_taken_back_where_it_spoils_the_law(self):
        """The means of copies miss equilibrium by twice the tolerance, the smoothed field the law by ten times: no reason to go on to 5e-8 (277)."""
        summary = two_beams(self, 1, example="table31", Solver__Method="SMALSE", Mesh__Two_Beams__Subdomains_Per_Edge=1,
                            Mesh__Two_Beams__Elements_Per_Subdomain_Edge=5, Solver__Relative_Tolerance=1e-6)
        self.assertLessEqual(summary["accuracy"]["kkt"], 1e-6)
        self.assertLessEqual(summary["solver"]["hessian_multiplications"], 240)

    def test_smalse_without_any_of_our_changes(self):
        summary = two_beams(self, 1, Solver__Method="SMALSE", **{"Solver__SMALSE__" + name: value for name, value in (
            ("Expansion", "Fixed Step"), ("Inner_Reduction", 0), ("M_Floor", 0))})
        self.assertEqual(summary["solver"]["preconditioner_applications"], 0)
        self.assertLessEqual(summary["accuracy"]["kkt"], 1e-6)
        usual = two_beams(self, 1)["contact"]["interface"]["normal_force"]
        self.assertAlmostEqual(summary["contact"]["interface"]["normal_force"], usual, delta=1e-4 * usual)

    def test_displacements_shrink_by_millions(self):
        """A stiff body on a soft one moves far before contact holds it: errors are not measured by what it moved at first."""
        for contrast in ("69e9", "69e12", "69e14"):
            for ranks in RANKS:
                summary = two_beams(self, ranks, **{"Materials__steel__Young's_Modulus": contrast})
                self.assertEqual(summary["solver"]["method"], "Subspace Newton")
                self.assertLessEqual(summary["solver"]["hessian_multiplications"], 60)
                self.assertLessEqual(summary["accuracy"]["kkt"], 1e-6)

    def test_overlap_within_the_gap(self):
        """A clamped pair that just touches is pinned, and the rest is solved."""
        scene = stack()
        scene["Boundary Conditions"]["floor"] = displacement(["lower_bottom", "lower_top"])
        scene["Boundary Conditions"]["side"] = displacement(["upper_bottom"])
        summary = self.solve(scene)
        self.assertEqual(summary["model"]["pinned_rows"], 3 * summary["model"]["contact_pairs"])


class NotConverged(SceneTest):
    def test_lifted_and_pulled(self):
        """A support lifts the body off, so that no pair holds what is pulled: not seen before, but told."""
        scene = sliding(-0.1)
        scene["Boundary Conditions"]["press"] = {"Type": "Displacement", "Sets": ["upper_top"], "Components": "z", "Value": [0.1]}
        for ranks in RANKS:
            outcome = self.run_scene(scene, ranks=ranks)
            self.assert_one_message(outcome, 2, "slide or are open", "body 'upper': translation along (-1, 0, 0)", "gaps too wide")

    def assert_reason(self, summary):
        """The measure that is worst, its value, and where it is."""
        accuracy, reason = summary["accuracy"], summary["solver"]["reason"]
        worst = max((key for key in accuracy if key not in ("kkt", "tolerance", "round_off_floor")), key=accuracy.get)
        self.assertIn(f"largest error: {worst} = {accuracy['kkt']:.2e} ", reason)
        place = {"equilibrium": r" in body '(lower|upper)'", "continuity": r" at node \d+", "field_equilibrium": r" at node \d+"}
        self.assertRegex(reason, place.get(worst, r" at node \d+ of interface 'joint'"))

    def test_round_off_floor(self):
        """Both bodies are moved far away together: strains are differences of large numbers."""
        for distance in (1e4, 1e6):
            for method in ("Automatic", "SMALSE"):
                with self.subTest(distance=distance, method=method):
                    scene = stack(Solver={"Method": method, "Relative Tolerance": 1e-10})
                    for name in ("floor", "side"):
                        scene["Boundary Conditions"][name]["Value"] = [distance, 0.0, 0.0]
                    outcome = self.run_scene(scene)
                    self.assertEqual(outcome.status, 2, outcome)
                    summary = self.summary()
                    accuracy, reason = summary["accuracy"], summary["solver"]["reason"]
                    self.assert_reason(summary)
                    self.assertIn(f"round-off forbids less than about {accuracy['round_off_floor']:.1e}", reason)
                    self.assertIn("raise Solver->Relative Tolerance", reason)
                    self.assertGreater(accuracy["round_off_floor"], 1e-10)
                    self.assertLessEqual(accuracy["kkt"], 10 * accuracy["round_off_floor"])

    def test_the_written_field_is_smoothed_at_the_floor(self):
        """What is written is not worse than round-off asks for: a stiff body that contact alone holds, whose forces are in balance to 6e-9."""
        scene = stack(Decomposition__Subdomains=8, Solver={"Relative Tolerance": 1e-9})
        scene["Materials"] = {"soft": haptos_runs.material(["lower"]), "hard": haptos_runs.material(["upper"])}
        scene["Materials"]["hard"]["Young's Modulus"] = 1e10
        del scene["Boundary Conditions"]["side"]
        scene["Boundary Conditions"]["shear"] = {"Type": "Traction", "Sets": ["upper_top"], "Value": [0.1, 0.05, 0.0]}
        for ranks in RANKS:
            outcome = self.run_scene(scene, ranks=ranks)
            self.assertEqual(outcome.status, 2, outcome)
            summary = self.summary()
            accuracy = summary["accuracy"]
            self.assert_reason(summary)
            self.assertGreater(accuracy["equilibrium"], 1e-9)
            # The last digits of the displacements alone leave 3.5e-9; by its recursion smoothing said 2.3e-10 of a field that lacked 2.3e-8.
            self.assertLessEqual(accuracy["field_equilibrium"], 7e-9)
            self.assertLess(accuracy["kkt"], accuracy["round_off_floor"])
            self.assertIn("round-off forbids less than about", summary["solver"]["reason"])

    def test_what_was_reached_is_kept(self):
        """1e-14 is below round-off: no other method may throw away what the first one came to."""
        for ranks in RANKS:
            summary = two_beams(self, ranks, 2, Solver__Relative_Tolerance=1e-14, Solver__Maximum_Hessian_Multiplications=600)
            self.assertLessEqual(summary["accuracy"]["kkt"], 1e-12)
            self.assertLess(summary["solver"]["hessian_multiplications"], 600)
            self.assertIn("round-off forbids less than about", summary["solver"]["reason"])

    def test_tight_tolerance_above_the_floor(self):
        """Stiffness contrast alone does not raise the floor: 1e-10 is reached at 1e-6 and 1e6."""
        for contrast in (1e-6, 1e6):
            scene = stack(Solver={"Relative Tolerance": 1e-10})
            scene["Materials"] = {"soft": haptos_runs.material(["lower"]), "hard": haptos_runs.material(["upper"])}
            scene["Materials"]["hard"]["Young's Modulus"] = 1000.0 * contrast
            outcome = self.run_scene(scene)
            self.assertEqual(outcome.status, 0, outcome)
            self.assertLessEqual(self.summary()["accuracy"]["kkt"], 1e-10)

    def test_friction_is_named(self):
        scene = stack(Solver={"Method": "Subspace Newton", "Maximum Hessian Multiplications": 3})
        scene["Contact"]["joint"]["Friction"]["Coefficients"] = [0.3, 0.0003]
        self.assertEqual(self.run_scene(scene).status, 2)
        reason = self.summary()["solver"]["reason"]
        self.assertIn("coefficients of friction of 'joint' differ by a factor of 1000", reason)

    def test_remedies_are_named(self):
        """Each remedy where it helps, and only there."""
        dirichlet = "set Preconditioner->Type to Dirichlet"
        steep = "a coefficient of friction of 'joint' is 1.5: above 1 there may be no or several solutions"
        for kind, coefficient, named in (("Dirichlet", 0.3, ()), ("Lumped", 0.3, (dirichlet,)), ("Dirichlet", 1.5, (steep,))):
            scene = stack(Solver={"Maximum Hessian Multiplications": 5}, Preconditioner={"Type": kind})
            scene["Contact"]["joint"]["Friction"]["Coefficients"] = [coefficient, coefficient]
            self.assertEqual(self.run_scene(scene).status, 2)
            reason = self.summary()["solver"]["reason"]
            for remedy in (dirichlet, steep):
                self.assertEqual(remedy in reason, remedy in named, reason)

    def test_memory_is_named(self):
        """Pairs that were dropped are named as the reason, pairs that all stayed are not."""
        for pairs, dropped in ((20, True), (60, False)):
            summary = two_beams(self, 1, 2, Solver__Relative_Tolerance=1e-10, Solver__Maximum_Hessian_Multiplications=28,
                                Solver__Maximum_Recycled_Pairs=pairs)
            self.assertEqual(summary["solver"]["subspace"]["compressions"] > 0, dropped)
            self.assertEqual("raise Solver->Maximum Recycled Pairs (%d)" % pairs in summary["solver"]["reason"], dropped)

    def test_too_few_multiplications(self):
        for ranks in RANKS:
            with self.subTest(ranks=ranks):
                outcome = self.run_scene(stack(Solver={"Maximum Hessian Multiplications": 5}), ranks=ranks)
                self.assertEqual(outcome.status, 2, outcome)
                self.assertEqual(len(outcome.messages), 1, outcome)
                self.assertIn("not converged", outcome.out)
                self.assertIn("hessian multiplications", outcome.messages[0].lower())
                summary = self.summary()
                self.assertEqual(summary["solver"]["status"], "not converged")
                self.assertIn("hessian multiplications", summary["solver"]["reason"].lower())
                self.assert_reason(summary)
                self.assertIn("raise Solver->Maximum Hessian Multiplications (5)", summary["solver"]["reason"])
                self.assertGreater(summary["accuracy"]["kkt"], 1e-6)
                self.assertGreater((self.folder / "result.exo").stat().st_size, 0)
                self.assertIn(b"displacement_x", (self.folder / "result.exo").read_bytes())


if __name__ == "__main__":
    haptos_runs.main()
