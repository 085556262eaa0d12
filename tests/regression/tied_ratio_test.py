# SPDX-License-Identifier: BSD-3-Clause
"""Contact with friction costs little more than the same bodies tied together, a linear problem: counts and readings, no seconds."""
import json

import haptos_runs
from haptos_runs import INPUTS, SceneTest, run_haptos

# Of contact beside tied, about a tenth above the worst of the cells k = 1 to 4, p = 2 to 5.  The last two of a multiplication, the last in readings
# of the tied problem's coarse factor: 1.7 times the four that conjugate gradients on P F P take.  The tied problem itself takes two.
MORE_MULTIPLICATIONS, LOCAL_SOLVES, COARSE_READINGS, TIED_READINGS = 4, 1.2, 6.8, 3


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

                def readings(summary):
                    coarse = summary["coarse"]
                    return coarse["solves"] * coarse["factor_entries"] / multiplications(summary) / tied["coarse"]["factor_entries"]

                more = multiplications(contact) - multiplications(tied)
                local_solves = ratio(lambda s: s["solver"]["local_solves"])  # every vector through a K^+, whose factors are the same
                print(f"k {k}, p {p}: {multiplications(tied)} and {more} more, local solves {local_solves:.2f}, "
                      f"coarse readings {readings(contact):.2f} and {readings(tied):.2f}")
                self.assertLessEqual(more, MORE_MULTIPLICATIONS)
                self.assertLessEqual(local_solves, LOCAL_SOLVES)
                self.assertLessEqual(readings(contact), COARSE_READINGS)
                self.assertLessEqual(readings(tied), TIED_READINGS)
                self.assertLessEqual(contact["coarse"]["set_ups"], contact["solver"]["hessian_multiplications"])


if __name__ == "__main__":
    haptos_runs.main()
