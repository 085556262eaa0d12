// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_BodyMotions.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <set>

#include "FetiScene.hpp"
#include "Haptos_DualProblem.hpp"
#include "Haptos_Error.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

struct Unheld {
  Scene scene;
  Feti feti;
  BodyMotions bodies;
  UnheldMotions motions;

  explicit Unheld(const SceneOptions& options)
      : scene(makeScene(options)),
        feti(makeFeti(Tpetra::getDefaultComm(), scene)),
        bodies(bodyMotions(feti, scene)),
        motions(findUnheldMotions(*feti.comm, feti.G->rows(), bodies.Z(), std::vector<char>(std::size_t(feti.G->rows().rows()), 1))) {}

  // The load f = force (a function of the body and the place) on every copy.
  RCP<Vector> load(const std::function<Point(int, const Point&)>& force) const {
    const auto offsets = scene.offsets();
    Eigen::VectorXd f(offsets.back());
    for (const auto& sub : scene.subdomains)
      for (int i = 0; i < sub.numNodes(); ++i)
        for (int d = 0; d < 3; ++d) f[offsets[sub.id] + 3 * i + d] = force(sub.body, sub.coordinates[i])[d];
    return scattered(feti.dealt.jump->getDomainMap(), f);
  }

  std::string refusal(const std::function<Point(int, const Point&)>& force) const {
    const auto f = load(force);
    try {
      requireBalance(motions, bodies, feti.G->restrictLoad(*f, *feti.systems), f->norm2());
    } catch (const InsufficientModel& e) {
      return e.what();
    }
    return "";
  }
};

SceneOptions onlyLowerHeld(bool contact, bool frictional) {
  SceneOptions options = heldScene(5);
  options.hold = [](int body, const Point& x) { return std::string(body == 0 && x[0] < 1e-9 ? "xyz" : ""); };
  options.contact = contact;
  options.frictional = frictional;
  return options;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

// It is to load one factor block, not all subdomains of the body.
TEUCHOS_UNIT_TEST(BodyMotions, AHoldActsOnItsMotionInOneSubdomain) {
  const Unheld t(onlyLowerHeld(false, false));
  TEST_ASSERT(t.bodies.Z().cols() == 12 && t.feti.G->dimension() > 12);
  for (int m = 0; m < int(t.bodies.Z().cols()); ++m) {
    const Eigen::SparseVector<double> w = t.bodies.hold(m);
    TEST_FLOATING_EQUALITY(w.norm(), 1.0, 1e-12);
    TEST_ASSERT(w.dot(Eigen::SparseVector<double>(t.bodies.Z().col(m))) > 0);
    std::set<Eigen::Index> subdomains;
    for (Eigen::SparseVector<double>::InnerIterator it(w); it; ++it) subdomains.insert(it.index() / 6);
    TEST_EQUALITY(subdomains.size(), 1u);
  }
}

TEUCHOS_UNIT_TEST(BodyMotions, GluingRowsFeelNoMotionOfABody) {
  const Unheld u(onlyLowerHeld(true, true));
  const CoarseRows rows = u.feti.G->rows() * u.bodies.Z();
  const auto& m = u.feti.dealt.jump->multipliers();
  double gluing = 0, others = 0;
  for (int row = 0; row < int(m.kinds().size()); ++row)
    (m.kinds()[row] == RowKind::Gluing ? gluing : others) += rows.row(row).norm();
  TEST_ASSERT(gluing < 1e-12);
  double all = 0;
  Teuchos::reduceAll(*u.feti.comm, Teuchos::REDUCE_SUM, others, Teuchos::outArg(all));
  TEST_ASSERT(all > 1.0);
}

TEUCHOS_UNIT_TEST(BodyMotions, UnheldMotionsAreCounted) {
  TEST_EQUALITY(int(Unheld(onlyLowerHeld(false, false)).motions.basis.cols()), 6);
  TEST_EQUALITY(int(Unheld(onlyLowerHeld(true, false)).motions.basis.cols()), 3);  // slides and turns on the plane
  TEST_EQUALITY(int(Unheld(onlyLowerHeld(true, true)).motions.basis.cols()), 0);
  SceneOptions both = onlyLowerHeld(false, false);
  both.hold = [](int body, const Point& x) { return std::string(body == 0 && x[0] < 1e-9 ? "x" : ""); };
  TEST_EQUALITY(int(Unheld(both).motions.basis.cols()), 3 + 6);
  both.hold = [](int, const Point&) { return std::string(); };  // nothing is held: no scale but round-off
  TEST_EQUALITY(int(Unheld(both).motions.basis.cols()), 12);
}

TEUCHOS_UNIT_TEST(BodyMotions, UnheldMotionsLieInTheKernel) {
  const Unheld u(onlyLowerHeld(true, false));
  const Dense product = Dense(u.feti.G->rows() * u.bodies.Z() * u.motions.basis.sparseView());
  double mine = largest(product), all = 0;
  Teuchos::reduceAll(*u.feti.comm, Teuchos::REDUCE_MAX, mine, Teuchos::outArg(all));
  TEST_ASSERT(all < 1e-7);
  for (Eigen::Index i = 0; i < u.motions.basis.cols(); ++i)
    for (Eigen::Index j = 0; j < u.motions.basis.cols(); ++j)
      TEST_ASSERT(std::abs(u.motions.basis(u.motions.pivots[i], j) - (i == j)) < 1e-10);
}

TEUCHOS_UNIT_TEST(BodyMotions, LoadsOnUnheldMotionsAreNamed) {
  const Unheld free(onlyLowerHeld(false, false));
  const std::string pushed = free.refusal([](int body, const Point&) { return body == 1 ? Point{1, 0, 0} : Point{0, 0, 0}; });
  out << pushed << "\n";
  TEST_ASSERT(contains(pushed, "body 'upper'") && contains(pushed, "translation along (1, 0, 0)"));
  const std::string turned = free.refusal([](int body, const Point& x) {  // about the axis through the middle
    return body == 1 ? Point{0.5 - x[1], x[0] - 0.75, 0} : Point{0, 0, 0};
  });
  out << turned << "\n";
  TEST_ASSERT(contains(turned, "body 'upper'") && contains(turned, "rotation about the axis (0, 0, 1)"));
  TEST_EQUALITY(free.refusal([](int body, const Point&) { return body == 0 ? Point{1, 2, 3} : Point{0, 0, 0}; }), "");

  const Unheld sliding(onlyLowerHeld(true, false));
  TEST_ASSERT(contains(sliding.refusal([](int, const Point&) { return Point{0, 1, -5}; }), "translation along (0, 1, 0)"));
  TEST_EQUALITY(sliding.refusal([](int, const Point&) { return Point{0, 0, -5}; }), "");
}

// With the holds G G^T is regular, and solves on the range of G what it did before.
TEUCHOS_UNIT_TEST(BodyMotions, HoldsMakeTheCoarseProblemRegular) {
  const Unheld u(onlyLowerHeld(true, false));
  const auto f = u.load([](int, const Point&) { return Point{0, 0, -5}; });
  const Eigen::VectorXd e = u.feti.G->restrictLoad(*f, *u.feti.systems);
  requireBalance(u.motions, u.bodies, e, f->norm2());
  const auto holds = holdsFor(u.motions, u.bodies);
  TEST_EQUALITY(int(holds.size()), 3);
  const auto GGT = Teuchos::rcp(new CoarseProblem(*u.feti.comm, u.feti.G->rows(), {}, holds));
  DualProblem dual(u.feti.F, u.feti.G, GGT);
  dual.setStep({f, Teuchos::rcp(new Vector(u.feti.map())), {}});
  TEST_ASSERT((u.feti.G->applyG(*dual.lambdaIm) - e).norm() < 1e-9 * e.norm());
  const Dense P = denseOf(*dual.P);
  TEST_ASSERT(largest(P * P - P) < 1e-9);
  TEST_ASSERT(largest(u.feti.G->applyG(*scatteredColumns(u.feti.map(), P))) < 1e-9);
}
