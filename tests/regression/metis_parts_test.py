# SPDX-License-Identifier: BSD-3-Clause
"""METIS parts cost at most 1.5 times the multiplications of as many bricks, on both loads of the two beams."""
import json

import haptos_runs
from haptos_runs import INPUTS, SceneTest, run_haptos

WORST = 1.5
BRIEF = (  # the second load: pressure on the top alone, and a larger traction
    ('value="{upper_top, lower_bottom}"', 'value="{upper_top}"'),
    ('value="100*min(1, max(0, 1.5 - x))"', 'value="100"'),
    ('value="{10.0, 10.0, 10.0}"', 'value="{40.0, 30.0, 25.0}"'),
)


class MetisParts(SceneTest):
    def multiplications(self, text, k, p, *cut):
        (self.folder / "beams.xml").write_text(text)
        sets = [f"Mesh->Two Beams->Subdomains Per Edge={k}", f"Mesh->Two Beams->Elements Per Subdomain Edge={p}", *cut]
        outcome = run_haptos(["beams.xml", "--summary", "beams.json", *sum((["--set", s] for s in sets), [])],
                             folder=self.folder)
        self.assertEqual(outcome.status, 0, outcome)
        summary = json.loads((self.folder / "beams.json").read_text())
        self.assertEqual(summary["model"]["subdomains"], 4 * k**3)
        return summary["solver"]["hessian_multiplications"]

    def test_ratio_to_bricks(self):
        squeeze = (INPUTS / "table31.xml").read_text()
        brief = squeeze
        for old, new in BRIEF:
            self.assertIn(old, brief)
            brief = brief.replace(old, new)
        for name, text in (("squeeze", squeeze), ("brief", brief)):
            for k, p in ((2, 4), (3, 3), (3, 4)):
                bricks = self.multiplications(text, k, p, "Decomposition->Method=Bricks")
                for seed in (1, 2):
                    with self.subTest(load=name, k=k, p=p, seed=seed):
                        parts = self.multiplications(text, k, p, "Decomposition->Method=METIS",
                                                     f"Decomposition->Subdomains={4 * k**3}",
                                                     f"Decomposition->Seed={seed}")
                        self.assertLessEqual(parts, WORST * bricks)


if __name__ == "__main__":
    haptos_runs.main()
