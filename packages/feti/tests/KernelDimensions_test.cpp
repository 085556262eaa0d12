// SPDX-License-Identifier: BSD-3-Clause
// Kernels of other dimensions than six, mixed with such of six: a lattice of springs that knows no rotation.
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>

#include "FetiScene.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

// The upper body: every pair of nodes of an element tied by a spring in all directions, K = Laplacian x identity.
class HalfSprings final : public SubdomainStiffness {
 public:
  HalfSprings(const std::vector<Subdomain>& subdomains, const Scene& scene)
      : subdomains_(subdomains), elastic_(subdomains, scene.materials, Formulation::Standard) {}

  int size() const override { return elastic_.size(); }
  const Coordinates& coordinates(int i) const override { return elastic_.coordinates(i); }
  std::vector<int> surface(int i) const override { return elastic_.surface(i); }
  Eigen::MatrixXd kernel(int i) const override {
    if (isElastic(i)) return elastic_.kernel(i);
    return Dense::Identity(3, 3).replicate(Eigen::Index(coordinates(i).size()), 1) / std::sqrt(double(coordinates(i).size()));
  }
  Eigen::SparseMatrix<double> assemble(int i) const override {
    if (isElastic(i)) return elastic_.assemble(i);
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& group : subdomains_[std::size_t(i)].groups)
      for (int e = 0; e < group.numElements(); ++e) addSprings(group, e, entries);
    const auto n = 3 * Eigen::Index(coordinates(i).size());
    Eigen::SparseMatrix<double> K(n, n);
    K.setFromTriplets(entries.begin(), entries.end());
    return K;
  }
  void multiply(int i, const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::Ref<Eigen::VectorXd> Ku) const override {
    Ku += assemble(i) * u;
  }

 private:
  bool isElastic(int i) const { return subdomains_[std::size_t(i)].body == 0; }
  static void addSprings(const ElementGroup& group, int e, std::vector<Eigen::Triplet<double>>& entries) {
    for (int a = 0; a < nodesPerElement(group.topology); ++a)
      for (int b = 0; b < a; ++b)
        for (int d = 0; d < 3; ++d) {
          const int i = 3 * group.nodes(e)[a] + d, j = 3 * group.nodes(e)[b] + d;
          for (const auto& [row, column, value] : {std::tuple(i, i, 2.0), {j, j, 2.0}, {i, j, -2.0}, {j, i, -2.0}})
            entries.emplace_back(row, column, value);
        }
  }

  const std::vector<Subdomain>& subdomains_;
  ElasticStiffness elastic_;
};

struct Springs {
  Scene scene;
  Feti feti;
  std::vector<Dense> K, R;  // of all subdomains

  explicit Springs(LocalDual dual = LocalDual::Implicit) : scene(makeScene(heldScene(6))) {
    const auto make = [](const std::vector<Subdomain>& subdomains, const Scene& s) {
      return std::make_shared<const HalfSprings>(subdomains, s);
    };
    feti = makeFeti(Tpetra::getDefaultComm(), scene, dual, make);
    const HalfSprings all(scene.subdomains, scene);
    for (int i = 0; i < all.size(); ++i) {
      K.push_back(Dense(all.assemble(i)));
      R.push_back(all.kernel(i));
    }
  }
};

}  // namespace

TEUCHOS_UNIT_TEST(KernelDimensions, CoarseUnknownsAreNumberedSubdomainAfterSubdomain) {
  const Springs s;
  const auto offsets = s.scene.offsets();
  const Dense B = denseB(s.scene);
  Eigen::Index l = 0;
  for (const auto& R : s.R) l += R.cols();
  TEST_ASSERT(l % 6 != 0 && l < 6 * Eigen::Index(s.R.size()));
  TEST_EQUALITY(Eigen::Index(s.feti.G->dimension()), l);
  Dense G(l, B.rows());
  Eigen::Index at = 0;
  for (std::size_t i = 0; i < s.R.size(); at += s.R[i++].cols())
    G.middleRows(at, s.R[i].cols()) = (B.middleCols(offsets[i], s.R[i].rows()) * s.R[i]).transpose();
  const Dense applied = s.feti.G->applyG(*scatteredColumns(s.feti.map(), Dense::Identity(B.rows(), B.rows())));
  TEST_ASSERT(largest(applied - G) < 1e-13);

  const Dense b = Dense::Random(l, 2).unaryExpr([](double x) { return std::round(1000 * x); });  // the same on all ranks
  for (const int replicatedUpTo : {1 << 20, 0}) {
    const auto placement = std::make_shared<CoarsePlacement>(s.feti.comm, l, CoarseOptions{replicatedUpTo, 2});
    const CoarseProblem GGT(placement, s.feti.G->rows(), {}, {});
    TEST_ASSERT(largest(G * G.transpose() * GGT.solve(b) - b) < 1e-9 * largest(b));
  }
}

// Fixed rows and changing ones, condensed and not: a series of solves against the dense matrix.
TEUCHOS_UNIT_TEST(KernelDimensions, ChangingRowsAreCondensedAllTheSame) {
  const Springs s;
  const auto& kinds = s.feti.dealt.jump->multipliers().kinds();
  std::vector<double> fixed, changing;
  for (const RowKind kind : kinds) {
    fixed.push_back(isEquality(kind));
    changing.push_back(isEquality(kind) ? 0.0 : 0.5);
  }
  const CoarseRows& C = s.feti.G->rows();
  const auto placement = std::make_shared<CoarsePlacement>(s.feti.comm, C.cols(), CoarseOptions{});
  CoarseProblem A(placement, CoarseProblem::Weighted{C, fixed}, CoarseProblem::Weighted{C, changing}, {}, CoarseProblem::Factor::Now);
  const auto dense = [&](const std::vector<double>& q) {
    const Dense mine = C.transpose() * Dense(Eigen::Map<const Eigen::VectorXd>(q.data(), Eigen::Index(q.size())).asDiagonal() * Dense(C));
    Dense sum(mine.rows(), mine.cols());
    Teuchos::reduceAll(*s.feti.comm, Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), sum.data());
    return sum;
  };
  const Dense fixedPart = dense(fixed), whole = fixedPart + dense(changing);
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(C.cols(), 1, 2), none = Eigen::VectorXd::Zero(C.cols());
  TEST_ASSERT(largest(whole * A.solve(b) - b) < 1e-10 * largest(whole));
  CoarseProblem::Series series(A, b / s.feti.comm->getSize());
  const Eigen::VectorXd first = series.next(none), second = series.next(none);
  TEST_ASSERT(largest(whole * first - b) < 1e-10 * largest(whole));
  TEST_ASSERT(second.size() == b.size() && second.allFinite());
  const CoarseProblem alone(A, {});
  TEST_ASSERT(largest(fixedPart * series.last(alone, none) - b) < 1e-9 * largest(whole));
}

TEUCHOS_UNIT_TEST(KernelDimensions, DualOperatorEqualsDense) {
  for (const LocalDual dual : {LocalDual::Implicit, LocalDual::Explicit}) {
    const Springs s(dual);
    const auto offsets = s.scene.offsets();
    const Dense B = denseB(s.scene);
    Dense F = Dense::Zero(B.rows(), B.rows());
    for (std::size_t i = 0; i < s.K.size(); ++i) {
      const Dense Bi = B.middleCols(offsets[i], s.K[i].rows());
      F += Bi * densePseudoInverse(s.K[i]) * Bi.transpose();
    }
    TEST_ASSERT(largest(denseOf(*s.feti.F) - F) < 1e-10 * largest(F));
  }
}

// The spring lattice turns at a price, so three motions of the upper body are left.
TEUCHOS_UNIT_TEST(KernelDimensions, BodiesMoveAsTheirKernelsAllow) {
  const Springs s;
  const BodyMotions bodies = bodyMotions(s.feti, s.scene);
  TEST_EQUALITY(bodies.Z().cols(), 6 + 3);
  const CoarseRows jumps = s.feti.G->rows() * bodies.Z();
  const auto& kinds = s.feti.dealt.jump->multipliers().kinds();
  double gluing = 0;
  for (std::size_t row = 0; row < kinds.size(); ++row)
    if (kinds[row] == RowKind::Gluing) gluing += jumps.row(Eigen::Index(row)).norm();
  TEST_ASSERT(gluing < 1e-12);
  Eigen::VectorXd up = Eigen::VectorXd::Zero(9);
  up.tail(3).setConstant(0.5);
  TEST_ASSERT(bodies.describe(up).find("body 'upper': translation along") != std::string::npos);
}
