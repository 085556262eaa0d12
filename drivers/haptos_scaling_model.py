# SPDX-License-Identifier: BSD-3-Clause
"""What one iteration must send on the two-beams benchmark, derived from its lattice (doc/scaling.md); of METIS parts bounds only.

k subdomains and k p elements along the short edge, 2 k along the long one, two bodies: s = 4 k^3 subdomains.
"""
import itertools
import math


def subdomains(k):
    return 4 * k**3


def unknowns(k, p):
    return 3 * subdomains(k) * (p + 1) ** 3


def coarse_unknowns(k):
    return 6 * subdomains(k)


def coarse_blocks(k):
    """6 x 6 blocks in the lower triangle of G G^T: pairs of bricks that share a node, or a node and its opposite."""
    layer = (6 * k - 2) * (3 * k - 2)  # ordered pairs of neighbours in a layer of 2 k x k bricks, each with itself too
    return layer * (3 * k - 2) + 2 * k**3 + layer


def factor_entries_bound(k):
    """Entries of the sparse factor: growth l^(4/3) of nested dissection in space; 30 is above what was measured."""
    return 30 * coarse_unknowns(k) ** (4 / 3)


def slab_bytes(k, p, touches_clamp=True):
    """Bytes across one plane between layers of bricks, both ways together, for B or for B^T, one vector, if ranks hold whole layers."""
    return 8 * 3 * (2 * k * k * (p + 1) ** 2 + (k * p + 1 if touches_clamp else 0))


def ranks_of_subdomains(k, ranks):
    """Subdomains are dealt in their order: along the beam, then across, then upwards."""
    count, weight = subdomains(k), 1.0
    return [min(ranks - 1, int((s + 0.5) * weight / count * ranks)) for s in range(count)]


class Lattice:
    """Nodes of both beams as (body, x, y, z), their copies, and who owns their rows."""

    def __init__(self, k, p, ranks):
        self.k, self.p, self.n = k, p, k * p
        self.rank_of = ranks_of_subdomains(k, ranks)

    def nodes(self):
        return itertools.product(range(2), range(2 * self.n + 1), range(self.n + 1), range(self.n + 1))

    def copies(self, node):
        """Subdomains that share a node, ascending."""
        body, *position = node
        k, p = self.k, self.p
        bricks = [[b for b in {x // p, (x - 1) // p} if 0 <= b < size] for x, size in zip(position, (2 * k, k, k))]
        return sorted(2 * k**3 * body + x + 2 * k * (y + k * z) for x, y, z in itertools.product(*bricks))

    def opposite(self, node):
        """The other node of a contact pair, or None."""
        body, x, y, z = node
        if z == (0 if body else self.n):
            return (1 - body, x, y, self.n if body else 0)
        return None

    def rows(self, node):
        """(number of rows, subdomains that they touch) of the node's constraints; pairs count at the lower node."""
        copies = self.copies(node)
        if self.is_highest(node):
            copies.reverse()
        yield from ((3, copies[:j + 1]) for j in range(1, len(copies)))  # row j joins copy j to those before it: the owner has the first
        if node[1] == 0:
            yield 3, copies  # clamped
        other = self.opposite(node)
        if other and node[0] == 0 and node[1] > 0:
            yield 3, copies + self.copies(other)

    def group(self, node):
        other = self.opposite(node)
        return self.copies(node) + (self.copies(other) if other else [])

    def is_highest(self, node):
        """Whether the highest subdomain has the rows instead of the lowest: every other one leaves what it shares."""
        return min(self.group(node)) % 2 == 1

    def owner(self, node):
        return self.rank_of[(max if self.is_highest(node) else min)(self.group(node))]


def imports(k, p, ranks):
    """{(owner, user): rows} that a rank needs and another owns."""
    lattice, result = Lattice(k, p, ranks), {}
    for node in lattice.nodes():
        owner = lattice.owner(node)
        for count, touched in lattice.rows(node):
            for user in {lattice.rank_of[s] for s in touched} - {owner}:
                result[owner, user] = result.get((owner, user), 0) + count
    return result


def jump_traffic(k, p, ranks):
    """Per rank: (messages, bytes) sent for one vector by B (users to owners) and by B^T (owners to users)."""
    forward, transposed = ([[0, 0] for _ in range(ranks)] for _ in range(2))
    for (owner, user), rows in imports(k, p, ranks).items():
        for traffic, sender in ((forward, user), (transposed, owner)):
            traffic[sender][0] += 1
            traffic[sender][1] += 8 * rows
    return forward, transposed


def counts_factors(summary):
    """KLU2 keeps L and U, its multiplications are not counted, and ranks cannot share its coarse factor: one rank has it."""
    return "without CHOLMOD" not in summary["haptos"]["build"]


def shared_factor(summary):
    """What a solve with a factor that all ranks share sends at most, in how many reductions, and how much of the work the busiest rank has."""
    ranks, coarse = summary["haptos"]["ranks"], summary["coarse"]
    depth = math.ceil(math.log2(ranks))
    rows = [("bytes of the coarse solves <=", coarse["solves"] * 16 * (coarse["unknowns"] + coarse["between"] + coarse["last"]), coarse["solve_bytes"]),
            ("reductions of the coarse solves <=", coarse["solves"] * (2 * depth + 4), coarse["solve_reductions"])]
    if coarse["unknowns"] < 6 * EVEN_FROM * ranks or not counts_factors(summary):
        return rows
    return rows + [(f"{text}, most of a rank <=", int(busiest_share(ranks) * coarse[name + "_all"]), int(coarse[name]))
                   for name, text in (("flops", "multiplications in coarse factors"), ("entries_read", "coarse entries read"))]


EVEN_FROM = 16  # subdomains a rank


def busiest_share(ranks):
    """Of the work of all ranks, where each has some tens of subdomains: an even share, and as much again at most."""
    return min(1.0, 2 / ranks) if ranks > 2 else 0.6


def faces_of_boxes(elements, part, ranks):
    """Bytes of a vector that B lets a rank send in the mean, if subdomains of `part` elements, ranks and the whole are cubes."""
    return 72 * (elements / ranks) ** (2 / 3) * (1 - ranks ** (-1 / 3)) * (1 + part ** (-1 / 3)) ** 2


RAGGED = 5  # of METIS parts: rows that the busiest rank sends, against such cubes


FEW = 4  # subdomains a rank, below which nothing is said of its work on them


def even_share(ranks, parts):
    """Of the work on subdomains, as a part of all: 0.55 on 2 ranks, 0.1475 on 8, 0.025 on 64; 1.6 even shares where a rank has few of them."""
    if ranks == 1:
        return 1.0
    doublings = math.log2(ranks)
    return (min(1.1 + 0.02 * (doublings - 1) ** 2, 1 + 0.1 * doublings) if parts >= EVEN_FROM * ranks else 1.6) / ranks


def compare_parts(summary, p):
    """Bounds of a run on METIS parts."""
    ranks, coarse, local = summary["haptos"]["ranks"], summary["coarse"], summary["local"]
    elements, parts = 4 * p ** 3, summary["model"]["subdomains"]
    rows = [("elements", elements, local["elements_all"]), ("coarse unknowns", 6 * parts, coarse["unknowns"])]
    if parts >= FEW * ranks:
        even = even_share(ranks, parts)
        rows += [(f"{text}, most of a rank <=", int(even * local[name + "_all"]), int(local[name]))
                 for name, text in (("elements", "elements"), ("flops", "multiplications in factors"), ("bytes_read", "bytes of factors read"))]
    if ranks > 1:
        for name, block in (("B", "jump"), ("B^T", "jump_transposed")):
            sent = summary["communication"][block]
            rows.append((f"bytes of {name}, most of a rank <=", int(RAGGED * sent["vectors"] * faces_of_boxes(elements, elements / parts, ranks)),
                         int(sent["over_ranks"]["message_bytes"]["max"])))
    if coarse["factors"] < ranks:
        share = busiest_share(ranks) if counts_factors(summary) else 1
        held = int(share * 2.2 * 27 * coarse["unknowns"] ** (4 / 3))
        rows += shared_factor(summary) + [("coarse entries held, most of a rank <=", held, coarse["factor_entries"])]
    return rows


def compare(summary, k, p):
    """[(quantity, formula, measured)] of one run; every pair must be equal, except bounds (names that end in '<=')."""
    if k == 0:
        return compare_parts(summary, p)
    ranks, coarse = summary["haptos"]["ranks"], summary["coarse"]
    rows = [("subdomains", subdomains(k), summary["model"]["subdomains"]),
            ("unknowns", unknowns(k, p), summary["model"]["primal_unknowns"]),
            ("coarse unknowns", coarse_unknowns(k), coarse["unknowns"]),
            ("coarse blocks", coarse_blocks(k), coarse["blocks"]),
            ("coarse factor entries <=", int((1 if counts_factors(summary) else 2) * factor_entries_bound(k)), coarse["factor_entries"])]
    if coarse["factors"] == ranks:
        per_solve = 8 * coarse_unknowns(k) if ranks > 1 else 0
        rows.append(("bytes of the coarse solves", per_solve * coarse["solve_reductions"], coarse["solve_bytes"]))
    else:
        rows += shared_factor(summary)
    forward, transposed = jump_traffic(k, p, ranks)
    for name, expected, block in (("B", forward, "jump"), ("B^T", transposed, "jump_transposed")):
        measured = summary["communication"][block]
        for index, key, text in ((0, "messages", "messages"), (1, "message_bytes", "bytes")):
            totals = [measured["vectors"] * rank[index] for rank in expected]
            rows.append((f"{text} of {name}, most of a rank", max(totals), max(measured[key])))
            rows.append((f"{text} of {name}, all ranks", sum(totals), sum(measured[key])))
            # The sums could agree by chance; rank by rank they cannot.
            rows.append((f"ranks whose {text} of {name} agree", ranks, sum(a == b for a, b in zip(totals, measured[key]))))
    return rows


def agrees(row):
    name, formula, measured = row
    return measured <= formula if name.endswith("<=") else measured == formula
