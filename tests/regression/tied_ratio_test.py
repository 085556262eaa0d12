# SPDX-License-Identifier: BSD-3-Clause
"""Contact with friction costs little more than the same bodies tied together, a linear problem: counts and bytes, no seconds."""
import json

import haptos_runs
from haptos_runs import INPUTS, SceneTest, run_haptos

# Of contact beside tied, each about a tenth above the worst of the cells k = 1 to 4, p = 2 to 5: 3 more (18 and 15, 14 and 11), 1.10, 1.54.
MORE_MULTIPLICATIONS, LOCAL_SOLVES, COARSE_BYTES = 4, 1.2, 1.7  # the last two of a multiplication


class TiedRatio(SceneTest):
    def cost(self, k, p, *more):
        sets = [f"Mesh->Two Beams->Subdomains Per Edge={k}", f"Mesh->Two Beams->Elements Per Subdomain Edge={p}", *more]
        outcome = run_haptos([INPUTS / "table31.xml", "--output", "beams.exo", "--summary", "beams.json", *sum((["--set", s] for s in sets), [])],
                             folder=self.folder)
        self.assertEqual(outcome.status, 0, outcome)
        return json.loads((self.folder / "beams.json").read_text())

    def test_counts_and_bytes(self):
        for k, p in ((1, 3), (1, 5), (2, 2), (2, 3), (2, 5), (3, 3), (3, 5), (4, 2)):
            with self.subTest(k=k, p=p):
                contact = self.cost(k, p)
                tied = self.cost(k, p, "Contact->interface->Friction->Law=Tied")
                self.assertEqual((contact["solver"]["method"], tied["solver"]["method"]), ("Subspace Newton", "PCPG"))
                self.assertEqual(tied["model"]["tied_pairs"], contact["model"]["contact_pairs"])

                def multiplications(summary):
                    return summary["solver"]["hessian_multiplications"]

                def ratio(measure):
                    self.assertGreater(measure(tied), 0)
                    return measure(contact) / multiplications(contact) / (measure(tied) / multiplications(tied))

                more = multiplications(contact) - multiplications(tied)
                local_solves = ratio(lambda s: s["solver"]["local_solves"])  # every vector through a K^+, whose factors are the same
                coarse_bytes = ratio(lambda s: 16 * s["coarse"]["solves"] * s["coarse"]["factor_entries"])  # L is read twice a solve
                print(f"k {k}, p {p}: {multiplications(tied)} and {more} more, local solves {local_solves:.2f}, coarse bytes {coarse_bytes:.2f}")
                self.assertLessEqual(more, MORE_MULTIPLICATIONS)
                self.assertLessEqual(local_solves, LOCAL_SOLVES)
                self.assertLessEqual(coarse_bytes, COARSE_BYTES)
                self.assertLessEqual(contact["coarse"]["set_ups"], contact["solver"]["hessian_multiplications"])


if __name__ == "__main__":
    haptos_runs.main()
