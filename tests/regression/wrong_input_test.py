# SPDX-License-Identifier: BSD-3-Clause
"""Wrong inputs: exit status 1, one message that says what is wrong and what would be right, no file left."""
import copy
import os
import unittest

import haptos_runs
from haptos_runs import STACK, SceneTest, displacement, material, stack, xml_of

RANKS = (1, 3)
NO_SUCH_FOLDER = "no_such_folder"


def give_dimension(path, variable, wanted):
    """Gives the last index of a variable of a netCDF file the dimension `wanted`, in its header alone."""
    whole = bytearray(path.read_bytes())

    def word(at):
        return int.from_bytes(whole[at:at + 4], "big")

    at, names = 16, []  # magic, records, tag and number of the dimensions
    for _ in range(word(12)):
        names.append(whole[at + 4:at + 4 + word(at)].decode())
        at += 8 + (word(at) + 3) // 4 * 4
    at = whole.index(variable.encode()) + (len(variable) + 3) // 4 * 4
    last = at + 4 * word(at)
    whole[last:last + 4] = names.index(wanted).to_bytes(4, "big")
    path.write_bytes(whole + bytes(100000))


class WrongInput(SceneTest):
    def refuse(self, scene, *parts, arguments=()):
        for ranks in RANKS:
            with self.subTest(ranks=ranks):
                before = {path.name for path in self.folder.rglob("*")} | {"scene.xml"}
                outcome = self.run_scene(scene, *arguments, ranks=ranks)
                self.assert_one_message(outcome, 1, *parts)
                self.assertEqual({path.name for path in self.folder.rglob("*")}, before, "a file is left behind")
                self.assertEqual(outcome.out, "", "nothing is printed before the message")


class WrongParameters(WrongInput):
    def test_unknown_parameter(self):
        self.refuse(stack(**{"Solver": {"Relative Tolerence": 1e-6}}), "Solver->Relative Tolerence", "Relative Tolerance")

    def test_unknown_list(self):
        self.refuse(stack(Contacts={}), "Contacts", "'Contact'")

    def test_unknown_parameter_on_the_command_line(self):
        self.refuse(stack(), "Relative Tolerances", "'Relative Tolerance'",
                    arguments=["--set", "Solver->Relative Tolerances=1e-6"])

    def test_unknown_option(self):
        self.refuse(stack(), "--validate", "--validate-only", arguments=["--validate"])

    def test_line_break_in_a_name(self):
        self.refuse(stack(), "'--sum mary'", arguments=["--sum\nmary"])

    def test_wrong_type(self):
        self.refuse(stack(Decomposition__Subdomains="four"), "Decomposition->Subdomains", "int")

    def test_wrong_type_on_the_command_line(self):
        self.refuse(stack(), "Decomposition->Subdomains", "'four'", "int", arguments=["--set", "Decomposition->Subdomains=four"])

    def test_out_of_range(self):
        for ratio in (0.5, 0.7, -1.25):
            scene = stack()
            scene["Materials"]["soft"]["Poisson's Ratio"] = ratio
            self.refuse(scene, "Materials->soft->Poisson's Ratio", str(ratio), "-1 < value < 0.5")

    def test_not_a_number(self):
        for text in ("nan", "inf"):
            self.refuse(stack(), "Materials->soft->Young's Modulus", text,
                        arguments=["--set", f"Materials->soft->Young's Modulus={text}"])

    def test_too_large_to_be_computed_with(self):
        self.refuse(stack(), "Materials->soft->Young's Modulus", "1e-200", "1e-100", "units",
                    arguments=["--set", "Materials->soft->Young's Modulus=1e-200"])
        self.refuse(stack(), "Materials->soft->Young's Modulus", "1e+101", "1e+100", "units",
                    arguments=["--set", "Materials->soft->Young's Modulus=1e101"])
        for value, name in ((1e101, "1e+101"), ("-1e101*z", "'-1e101*z'")):
            scene = stack()
            scene["Boundary Conditions"]["press"]["Value"] = value
            self.refuse(scene, "Boundary Conditions->press->Value", name, "1e+100")

    def test_stiffnesses_too_far_apart(self):
        scene = stack(Materials={"soft": material(["lower"]), "hard": material(["upper"])})
        scene["Materials"]["hard"]["Young's Modulus"] = 1e18
        self.refuse(scene, "Materials", "'hard'", "1e+18", "'soft'", "1000", "1e+14", "rigid plane")

    def test_not_a_number_in_an_array(self):
        scene = stack()
        scene["Boundary Conditions"]["side"]["Value"] = [0.0, float("nan"), 0.0]
        self.refuse(scene, "Boundary Conditions->side->Value", "nan")

    def test_unknown_choice(self):
        self.refuse(stack(Solver={"Method": "Smalse"}), "Solver->Method", "'SMALSE'")

    def test_constants_of_smalse(self):
        self.refuse(stack(Solver={"SMALSE": {"Expansion": "Projected GC"}}), "Solver->SMALSE->Expansion", "'Projected GC'",
                    "did you mean 'Projected CG'", "Fixed Step")
        self.refuse(stack(Solver={"SMALSE": {"Inner Reductoin": 0.5}}), "Solver->SMALSE->Inner Reductoin", "'Inner Reduction'")
        self.refuse(stack(Solver={"SMALSE": {"Inner Reduction": 1.0}}), "Solver->SMALSE->Inner Reduction", "0 <= value < 1")
        self.refuse(stack(), "Solver->SMALSE->Step Length", "0 < value < 2", arguments=["--set", "Solver->SMALSE->Step Length=2"])

    def test_missing_parameter(self):
        scene = stack()
        del scene["Materials"]["soft"]["Young's Modulus"]
        self.refuse(scene, "Materials->soft->Young's Modulus")

    def test_pcpg_with_contact(self):
        self.refuse(stack(Solver={"Method": "PCPG"}), "Solver->Method", "PCPG", "9 contact pairs", "Automatic")

    def test_newton_without_preconditioner(self):
        self.refuse(stack(Solver={"Method": "Subspace Newton"}, Preconditioner={"Type": "None"}),
                    "Preconditioner->Type", "Subspace Newton", "Dirichlet", "Lumped")


class WrongXml(WrongInput):
    def test_missing_file(self):
        for ranks in RANKS:
            outcome = haptos_runs.run_haptos(["elsewhere.xml"], ranks, self.folder)
            self.assert_one_message(outcome, 1, "'elsewhere.xml'", "does not exist")

    def test_malformed(self):
        whole = xml_of(STACK)
        for text in (whole[: len(whole) // 2], whole.replace("</ParameterList>", "</ParameterLost>", 1),
                     whole.replace('name="Mesh"', 'name="Mesh', 1), "", "nothing of the kind"):
            self.refuse(text, "scene.xml")

    def test_other_root(self):
        self.refuse(xml_of(STACK, "Calculix"), "Calculix", "Haptos")


class WrongMesh(WrongInput):
    def test_missing_file(self):
        self.refuse(stack(Mesh__File="stick.exo"), "stick.exo")

    def test_truncated_file(self):
        whole = (self.folder / "stack.exo").read_bytes()
        for part in (0.1, 0.5, 0.95):
            (self.folder / "short.exo").write_bytes(whole[: int(part * len(whole))])
            self.refuse(stack(Mesh__File="short.exo"), "short.exo")

    def test_text_file(self):
        (self.folder / "text.exo").write_text("solid cube\n")
        self.refuse(stack(Mesh__File="text.exo"), "text.exo")

    def test_folder(self):
        (self.folder / "folder.exo").mkdir()
        self.refuse(stack(Mesh__File="folder.exo"), "folder.exo")

    def test_coordinate_is_not_a_number(self):
        self.refuse(stack(Mesh__File="not_a_number.exo"), "not_a_number.exo", "8", "nan")

    def test_size_of_the_mesh(self):
        self.refuse(stack(Mesh__File="tiny.exo"), "Mesh: extends over 2e-60", "1e-50", "1e+50", "unit of length")
        self.refuse(stack(Mesh__File="huge.exo"), "Mesh: extends over 2e+60", "unit of length")

    def test_inverted_element(self):
        self.refuse(stack(Mesh__File="inverted.exo"), "14", "inverted")

    def test_side_without_area(self):
        self.refuse(stack(Mesh__File="folded.exo"), "elements 1 and 5 share a side without area")

    def test_quadratic_element_with_a_middle_at_a_corner(self):
        self.refuse(stack(Mesh__File="middle_at_corner.exo"), "element 1 (HEX20)", "lower", "its node 9", "middle")
        self.refuse(stack(Mesh__File="middle_is_corner.exo"), "element 1 (HEX20)", "lower", "its node 9", "middle")

    def test_unknown_type_of_elements(self):
        path = self.folder / "unknown.exo"
        path.write_bytes((self.folder / "stack.exo").read_bytes().replace(b"HEX8", b"HEY8"))
        self.refuse(stack(Mesh__File="unknown.exo"), "unknown.exo", "'lower'", "'HEY8'", "8 nodes", "HEX8", "TETRA10")

    def test_face_given_twice(self):
        self.refuse(stack(Mesh__File="contact_twice.exo"), "'joint'", "Secondary Side Set", "'upper_bottom'", "side 5 of element 9", "twice")

    def test_nothing_opposite(self):
        for discretization in ("Automatic", "Node To Node", "Mortar"):
            scene = stack(Mesh__File="apart.exo")
            scene["Contact"]["joint"]["Discretization"] = discretization
            self.refuse(scene, "'joint'", "'lower_top'", "lies opposite", "'upper_bottom'")

    def test_surfaces_that_face_away(self):
        for discretization in ("Automatic", "Mortar"):
            scene = stack()
            scene["Contact"]["joint"].update({"Secondary Side Set": "upper_top", "Primary Side Set": "lower_bottom", "Discretization": discretization})
            self.refuse(scene, "'joint'", "'upper_top'", "'lower_bottom'", "look away")

    def test_missing_side_set(self):
        existing = ["lower_top", "upper_bottom", "upper_top"]
        scene = stack()
        scene["Boundary Conditions"]["press"]["Sets"] = ["upper_tip"]
        self.refuse(scene, "Boundary Conditions->press->Sets", "'upper_tip'", *existing)
        scene = stack()
        scene["Boundary Conditions"]["floor"]["Sets"] = ["flor"]
        self.refuse(scene, "Boundary Conditions->floor->Sets", "'flor'", *existing)
        scene = stack()
        scene["Contact"]["joint"]["Primary Side Set"] = "lower_tip"
        self.refuse(scene, "'joint'", "Primary Side Set", "'lower_tip'", *existing)

    def test_block_without_material(self):
        self.refuse(stack(Materials={"soft": material(["lower"])}), "'upper'", "no material")

    def test_block_named_twice(self):
        for names in (["lower", "lower", "upper"], ["lower", "upper", "lower"]):
            self.refuse(stack(Materials={"soft": material(names)}), "Materials->soft->Element Blocks", "'lower'", "twice")

    def test_block_of_two_materials(self):
        self.refuse(stack(Materials={"soft": material(["lower", "upper"]), "hard": material(["upper"])}), "Element Blocks", "'upper'",
                    "already has the material")

    def test_missing_block(self):
        self.refuse(stack(Materials={"soft": material(["lower", "uper"])}), "Materials->soft->Element Blocks", "'uper'",
                    "lower", "upper")

    def test_non_matching_interface(self):
        scene = stack(Mesh__File="non_matching.exo")
        scene["Contact"]["joint"]["Discretization"] = "Node To Node"
        self.refuse(scene, "'joint'", "match", "Mortar")


class WrongFriction(WrongInput):
    def with_friction(self, mesh="fields.exo", **friction):
        scene = stack(Mesh__File=mesh)
        scene["Contact"]["joint"]["Friction"].update({name.replace("_", " "): value for name, value in friction.items()})
        return scene

    def test_no_such_field(self):
        self.refuse(self.with_friction(Coefficients=["MU", "MV"]), "Contact->joint->Friction->Coefficients", "no nodal field 'MV'", "MU, NEGATIVE")
        self.refuse(self.with_friction(Principal_Field=["MU", "ONE", "TWO"]), "Contact->joint->Friction->Principal Field", "no nodal field 'TWO'")
        self.refuse(self.with_friction("stack.exo", Coefficients=["MU", "0.3"]), "Coefficients", "no nodal field 'MU'", "none")

    def test_field_of_the_wrong_length(self):
        for wanted in ("num_elem", "len_line"):  # 16 and 81
            path = self.folder / "length.exo"
            path.write_bytes((self.folder / "fields.exo").read_bytes())
            give_dimension(path, "vals_nod_var5", wanted)
            self.refuse(self.with_friction("length.exo", Coefficients=["ZERO", "0.3"]), "length.exo", "'ZERO'", "one value for each of the 54 nodes")

    def test_coefficient_that_is_no_coefficient_at_one_node(self):
        self.refuse(self.with_friction(Coefficients=["0.3", "NEGATIVE"]), "Friction->Coefficients", "F2", "'NEGATIVE'", "-0.25", "node 35 (0.5, 1, 1)")
        self.refuse(self.with_friction(Coefficients=["NAN_AT_ONE", "0.3"]), "Friction->Coefficients", "F1", "nan", "node 35 (0.5, 1, 1)")
        self.refuse(self.with_friction(Coefficients=["x - 0.1", "0.3"]), "Friction->Coefficients", "F1", "'x - 0.1'", "-0.1", "node 28 (0, 0, 1)")
        self.refuse(self.with_friction(Coefficients=["0.3", "0.1/(x - 0.5)^2"]), "Friction->Coefficients", "'0.1/(x - 0.5)^2'", "inf", "node 29 (0.5, 0, 1)")
        self.refuse(self.with_friction(Coefficients=["-0.1", "MU"]), "Friction->Coefficients", "-0.1", "at least 0")
        self.refuse(self.with_friction(Coefficients=["0.1 + q", "MU"]), "Friction->Coefficients", "0.1 + q")

    def test_axes(self):
        self.refuse(self.with_friction(Principal_Field=["ZERO", "ZERO", "ZERO"]), "Principal Field", "(0, 0, 0)", "node 28 (0, 0, 1)")
        axes = {"Point": [0.5, 0.5, 0.0], "Axis": [0.0, 0.0, 1.0], "Direction": "Circumferential"}
        self.refuse(self.with_friction(Cylindrical=axes), "Friction->Cylindrical", "node 32 (0.5, 0.5, 1)", "Circumferential", "Axial")
        self.refuse(self.with_friction(Cylindrical={**axes, "Axis": [0.0, 0.0, 0.0]}), "Friction->Cylindrical->Axis", "zero vector")
        self.refuse(self.with_friction(Cylindrical={"Axis": [0.0, 0.0, 1.0]}), "Friction->Cylindrical->Point", "missing")
        self.refuse(self.with_friction(Cylindrical=axes, Principal_Field=["MU", "MU", "MU"]), "only one of", "'Cylindrical'", "'Principal Field'")


class WrongGap(WrongInput):
    def with_joint(self, **changes):
        scene = stack()
        scene["Contact"]["joint"].update({name.replace("_", " "): value for name, value in changes.items()})
        return scene

    def test_gap(self):
        self.refuse(self.with_joint(Gap="closed"), "Contact->joint->Gap", "'closed'", "Geometric", "Closed")
        self.refuse(self.with_joint(Gap="1/(x - 0.5)"), "Contact->joint->Gap", "inf", "0.5")
        self.refuse(self.with_joint(Initial_Penetration="Remove"), "Contact->joint->Initial Penetration", "'Remove'", "Resolve", "Ignore")

    def test_smoothing(self):
        for shape in ("Cylinder", "Sphere"):
            self.refuse(self.with_joint(Primary_Smoothing=shape, Discretization="Mortar"), "'joint'", "'lower_top'", shape.lower(), "Primary Smoothing None")
        scene = self.with_joint(Primary_Smoothing="Sphere")
        del scene["Contact"]["joint"]["Primary Side Set"]
        scene["Contact"]["joint"]["Rigid Plane"] = {"Point": [0.0, 0.0, 1.0], "Normal": [0.0, 0.0, 1.0]}
        self.refuse(scene, "Contact->joint->Primary Smoothing", "Rigid Plane")


class WrongConditions(WrongInput):
    def with_press(self, expression):
        scene = stack()
        scene["Boundary Conditions"]["press"]["Value"] = expression
        return scene

    def test_expression_does_not_parse(self):
        for expression in ("2*(x", "q*x", "x +* y", "sin()"):
            self.refuse(self.with_press(expression), "Boundary Conditions->press->Value", expression)

    def test_expression_is_too_long(self):
        self.refuse(self.with_press("x+" * 10000 + "x"), "Boundary Conditions->press->Value", "20001 characters", "19999")

    def test_expression_gives_nan(self):
        self.refuse(self.with_press("sqrt(x - 5)"), "Boundary Conditions->press->Value", "sqrt(x - 5)")

    def test_expression_gives_nan_in_a_part(self):
        self.refuse(self.with_press("sqrt(0.6 - x)"), "Boundary Conditions->press->Value", "sqrt(0.6 - x)")

    def test_displacement_gives_nan(self):
        scene = stack()
        scene["Boundary Conditions"]["side"]["Value"] = ["0", "0/(z - 1)", "0"]
        self.refuse(scene, "Boundary Conditions->side->Value", "0/(z - 1)")

    def test_contradicting_displacements(self):
        scene = copy.deepcopy(STACK)
        scene["Boundary Conditions"]["twist"] = displacement(["upper_south"], (0.0, 0.25, 0.0))
        self.refuse(scene, "Boundary Conditions->twist", "Boundary Conditions->side", "y-displacement", "0.25", "node")


class WrongOutput(WrongInput):
    """Found before the mesh is read."""

    def test_missing_folder(self):
        self.refuse(stack(Output__File=NO_SUCH_FOLDER + "/result.exo"), "Output->File", NO_SUCH_FOLDER)
        self.refuse(stack(Output__Summary=NO_SUCH_FOLDER + "/summary.json"), "Output->Summary", NO_SUCH_FOLDER)

    def test_file_in_the_place_of_a_folder(self):
        self.refuse(stack(Output__File="stack.exo/result.exo"), "Output->File", "stack.exo")

    def test_folder_in_the_place_of_a_file(self):
        (self.folder / "result.exo").mkdir()
        (self.folder / "summary.json").mkdir()
        self.refuse(stack(Output__Summary=""), "result.exo")
        self.refuse(stack(Output__File=""), "summary.json")

    def test_pipe_in_the_place_of_a_file(self):
        os.mkfifo(self.folder / "pipe")  # a device would do as well, but a test should not risk one
        self.refuse(stack(Output__File="pipe"), "Output->File", "'pipe'", "device or a pipe")
        self.refuse(stack(Output__Summary="pipe"), "Output->Summary", "'pipe'", "device or a pipe")

    def test_result_in_the_place_of_an_input(self):
        """Also by another way to the same file."""
        os.symlink("stack.exo", self.folder / "link.exo")
        os.link(self.folder / "stack.exo", self.folder / "hard_link.exo")
        whole = (self.folder / "stack.exo").read_bytes()
        for name in ("stack.exo", "./stack.exo", "link.exo", "hard_link.exo"):
            for output in ("File", "Summary"):
                self.refuse(stack(**{f"Output__{output}": name}), f"Output->{output}", "Mesh->File", "stack.exo", "another name")
        for output in ("File", "Summary"):
            self.refuse(stack(**{f"Output__{output}": "scene.xml"}), f"Output->{output}", "scene.xml", "the input")
            self.refuse(stack(), "Output->File", "scene.xml", arguments=["--output", "scene.xml"])
        self.assertEqual((self.folder / "stack.exo").read_bytes(), whole)

    def test_one_name_for_two_results(self):
        self.refuse(stack(Output__Summary="./result.exo"), "Output->Summary", "Output->File", "another name")

    def test_folder_is_not_writable(self):
        locked = self.folder / "locked"
        locked.mkdir()
        locked.chmod(0o555)
        if os.access(locked, os.W_OK):  # the administrator may write everywhere but there
            locked = "/proc"
        if os.access(locked, os.W_OK) and not os.path.isdir("/proc/self"):
            self.skipTest("every folder is writable here")
        self.refuse(stack(Output__File=f"{locked}/result.exo"), "Output->File", str(locked))


if __name__ == "__main__":
    haptos_runs.main()
