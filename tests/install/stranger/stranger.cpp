// SPDX-License-Identifier: BSD-3-Clause
// A stranger's own problem on an installed Haptos: a chain of springs, A = tridiag(-1, 4, -1), whose entries come in
// groups of three: one with a lower bound 0, two in an ellipse with the semi-axes 0.3 and 0.15.
#include <Haptos_BoundEllipseSet.hpp>
#include <Haptos_SmalseSolMgr.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

using Haptos::BoundEllipseSet;
using Haptos::MultiVector;
using Haptos::Operator;
using Teuchos::RCP;
using Teuchos::rcp;

namespace {

constexpr int groupsPerRank = 20;
constexpr double semiAxes[2] = {0.3, 0.15};

RCP<Haptos::CrsMatrix> makeChain(const RCP<const Haptos::Map>& map) {
  auto a = rcp(new Haptos::CrsMatrix(map, 3));
  const Haptos::GlobalOrdinal last = map->getGlobalNumElements() - 1;
  for (Haptos::GlobalOrdinal i = map->getMinGlobalIndex(); i <= map->getMaxGlobalIndex(); ++i) {
    a->insertGlobalValues(i, Teuchos::tuple(i), Teuchos::tuple(4.0));
    if (i > 0) a->insertGlobalValues(i, Teuchos::tuple(i - 1), Teuchos::tuple(-1.0));
    if (i < last) a->insertGlobalValues(i, Teuchos::tuple(i + 1), Teuchos::tuple(-1.0));
  }
  a->fillComplete();
  return a;
}

struct Findings {
  double worst = 0;                        // largest violation of the optimality conditions
  int lifted = 0, pressed = 0, inside = 0, sliding = 0;  // how many groups are where
};

// With g = A x - b: x >= 0, g >= 0, x g = 0 at a bound; in an ellipse g = 0 inside, and on its boundary
// -g = t (x1/a1^2, x2/a2^2) with t >= 0.
Findings examine(const MultiVector& x, const MultiVector& g) {
  Findings found;
  const auto xv = x.getData(0), gv = g.getData(0);
  for (int i = 0; i < int(xv.size()); i += 3) {
    found.worst = std::max({found.worst, -xv[i], -gv[i], std::abs(std::min(xv[i], gv[i]))});
    ++(xv[i] > 1e-6 ? found.pressed : found.lifted);

    const double normal[2] = {xv[i + 1] / (semiAxes[0] * semiAxes[0]), xv[i + 2] / (semiAxes[1] * semiAxes[1])};
    const double level = xv[i + 1] * normal[0] + xv[i + 2] * normal[1];
    const bool slides = level > 1 - 1e-6;
    ++(slides ? found.sliding : found.inside);
    const double t = slides ? -(gv[i + 1] * normal[0] + gv[i + 2] * normal[1]) /
                                  (normal[0] * normal[0] + normal[1] * normal[1]) : 0.0;
    found.worst = std::max({found.worst, level - 1, -t, std::abs(gv[i + 1] + t * normal[0]),
                            std::abs(gv[i + 2] + t * normal[1])});
  }
  return found;
}

Belos::ReturnType solve(const RCP<const Operator>& a, const RCP<MultiVector>& x, const RCP<const MultiVector>& b) {
  std::vector<BoundEllipseSet::Bound> bounds;
  std::vector<BoundEllipseSet::Ellipse> ellipses;
  for (int i = 0; i < 3 * groupsPerRank; i += 3) {
    bounds.push_back({i, 0.0});
    ellipses.push_back({{i + 1, i + 2}, {semiAxes[0], semiAxes[1]}, {0.0, 0.0}});
  }
  auto omega = rcp(new BoundEllipseSet(x->getMap(), bounds, ellipses));
  using Problem = Haptos::QuadraticProgram<double, MultiVector, Operator>;
  Haptos::SmalseSolMgr<double, MultiVector, Operator> solver;
  auto parameters = Teuchos::parameterList();
  parameters->set("Convergence Tolerance", 1e-10);
  solver.setParameters(parameters);
  solver.setProblem(rcp(new Problem(a, x, b, omega)));
  return solver.solve();
}

}  // namespace

int main(int argc, char* argv[]) {
  Tpetra::ScopeGuard scope(&argc, &argv);
  const auto comm = Tpetra::getDefaultComm();
  auto map = rcp(new Haptos::Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(), 3 * groupsPerRank, 0, comm));
  auto a = makeChain(map);
  auto x = rcp(new MultiVector(map, 1)), b = rcp(new MultiVector(map, 1));
  {
    auto values = b->getDataNonConst(0);
    for (int i = 0; i < int(values.size()); ++i) {
      const auto row = map->getGlobalElement(i);
      const double amplitude = row / 3 % 2 == 0 ? 0.2 : 2.0;  // weakly and strongly loaded groups in turn
      values[i] = amplitude * std::sin(0.7 * double(row + 1));
    }
  }
  const bool converged = solve(a, x, b) == Belos::Converged;

  MultiVector g(map, 1);
  a->apply(*x, g);
  g.update(-1.0, *b, 1.0);
  const Findings mine = examine(*x, g);
  double worst = 0;
  Teuchos::reduceAll(*comm, Teuchos::REDUCE_MAX, mine.worst, Teuchos::outArg(worst));
  const int counts[4] = {mine.lifted, mine.pressed, mine.inside, mine.sliding};
  int all[4] = {};
  Teuchos::reduceAll(*comm, Teuchos::REDUCE_SUM, 4, counts, all);
  if (comm->getRank() == 0)
    std::printf("%s; violation %.1e; lifted %d, pressed %d, inside %d, sliding %d\n",
                converged ? "converged" : "not converged", worst, all[0], all[1], all[2], all[3]);
  const bool allKinds = all[0] > 0 && all[1] > 0 && all[2] > 0 && all[3] > 0;
  return converged && allKinds && worst < 1e-8 ? 0 : 1;
}
