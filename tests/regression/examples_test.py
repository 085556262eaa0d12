# SPDX-License-Identifier: BSD-3-Clause
"""An example whose way is slow at first and ends well: the deflated preconditioner, which costs ten times the rest of the solve, is not made."""
import json

import haptos_runs
from haptos_runs import INPUTS, SceneTest, run_haptos

MOST = 36  # multiplications: 30 are taken; 22 with 639 motions


class Examples(SceneTest):
    def test_dovetail(self):
        outcome = run_haptos([INPUTS / "dovetail.xml", "--output", "dovetail.exo", "--summary", "dovetail.json"], folder=self.folder)
        self.assertEqual(outcome.status, 0, outcome)
        solver = json.loads((self.folder / "dovetail.json").read_text())["solver"]
        self.assertEqual(solver["deflation"]["motions"], 0)
        self.assertLessEqual(solver["hessian_multiplications"], MOST)


if __name__ == "__main__":
    haptos_runs.main()
