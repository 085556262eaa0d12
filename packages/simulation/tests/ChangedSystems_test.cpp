// SPDX-License-Identifier: BSD-3-Clause
// Systems that are changed between solves, or given what is at the edge of what they take: as systems that are made anew, or refused.
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>
#include <limits>

#include "ContactScene.hpp"

using namespace Haptos;
using namespace Haptos::Testing;

namespace {

void scale(Filled& filled, double factor) {
  for (const auto& K : filled.matrices) {
    K->resumeFill();
    K->scale(factor);
    K->fillComplete();
  }
  filled.system.updateStiffness();
}

// The upper body, as the only one.
void addUpper(Filled& filled) {
  const auto comm = Tpetra::getDefaultComm();
  for (std::size_t i = 0; i < filled.pieces.size(); ++i)
    if (filled.pieces[i].body == 1 && int(i) % comm->getSize() == comm->getRank()) {
      filled.matrices.push_back(crsOf(stiffnessOf(filled.pieces[i])));
      Piece piece = filled.pieces[i];
      piece.body = 0;
      filled.addPiece(piece, filled.matrices.back());
    }
}

// A block whose bottom stands on an obstacle, y held everywhere: plane strain.
struct Sheared {
  Filled filled{blocks()};

  Sheared(const std::array<double, 2>& coefficients, const Point& axis) {
    Filled& f = filled;
    const auto comm = Tpetra::getDefaultComm();
    addUpper(f);
    f.system.addInterface("floor", {FrictionLaw::Coulomb, coefficients, 0, false});
    for (std::size_t node = f.mesh.numNodes() / 2; node < f.mesh.numNodes(); ++node) {
      if (int(node) % comm->getSize() != comm->getRank()) continue;
      const Point& x = f.mesh.coordinates[node];
      f.system.prescribe(idOf(std::int64_t(node)), 1, 0.0);
      if (x[2] < 1e-9) f.pairs.push_back(f.system.addPair({0, idOf(std::int64_t(node)), {}, {0, 0, -1}, axis, 0, areaAt(x)}));
    }
  }

  Eigen::VectorXd solve() {
    return filled.solve([](const Point& x) { return x[2] < 1 - 1e-9 ? Point{0, 0, 0} : Point{0.015, 0, -0.06}; });
  }
};

// Supports move all nodes across the plane, and those of the top along it.
void drive(Sheared& sheared, double across) {
  const auto comm = Tpetra::getDefaultComm();
  const Mesh& mesh = sheared.filled.mesh;
  for (std::size_t node = mesh.numNodes() / 2; node < mesh.numNodes(); ++node) {
    if (int(node) % comm->getSize() != comm->getRank()) continue;
    sheared.filled.system.prescribe(idOf(std::int64_t(node)), 1, across);
    if (mesh.coordinates[node][2] > 1 - 1e-9) sheared.filled.system.prescribe(idOf(std::int64_t(node)), 0, 0.01);
  }
}

// Largest difference of T to N F^2 s / |F s|, s what the node of the pair moved by, over the largest T.
double errorOfSlipLaw(const Sheared& sheared, const Eigen::VectorXd& u, const std::array<double, 2>& F, const std::array<Point, 2>& axes) {
  const auto comm = Tpetra::getDefaultComm();
  const Mesh& mesh = sheared.filled.mesh;
  const auto forces = sheared.filled.system.contactForces();
  double mine[2] = {0, 0}, all[2];
  auto force = forces.begin();
  for (std::size_t node = mesh.numNodes() / 2; node < mesh.numNodes(); ++node) {
    if (int(node) % comm->getSize() != comm->getRank() || mesh.coordinates[node][2] > 1e-9) continue;
    std::array<double, 2> Fs;
    for (std::size_t t = 0; t < 2; ++t) Fs[t] = F[t] * Eigen::Vector3d(axes[t].data()).dot(u.segment<3>(3 * Eigen::Index(node)));
    for (std::size_t t = 0; t < 2; ++t) {
      mine[0] = std::max(mine[0], std::abs((*force)[1 + t] - (*force)[0] * F[t] * Fs[t] / std::hypot(Fs[0], Fs[1])));
      mine[1] = std::max(mine[1], std::abs((*force)[1 + t]));
    }
    ++force;
  }
  Teuchos::reduceAll(*comm, Teuchos::REDUCE_MAX, 2, mine, all);
  return all[0] / all[1];
}

}  // namespace

// As a Newton method of an application does, which looks for contact anew where it linearises.
TEUCHOS_UNIT_TEST(ChangedSystem, StiffnessAndPairsMayChangeTogether) {
  const auto filled = makeSystem();
  filled->solve();
  scale(*filled, 2.0);
  filled->system.clearPairs();
  filled->addPairs(0, 0.9);
  const Eigen::VectorXd fewer = filled->solve();
  TEST_ASSERT(filled->outcome.solved && difference(2 * fewer, makeSystem(0, 0.9)->solve()) < 1e-7);
  scale(*filled, 0.5);
  filled->system.setFriction(0, {FrictionLaw::Coulomb, {0, 0}, 0, true});  // tied: other rows of as many pairs
  const auto tied = makeSystem(0, 0.9);
  tied->system.setFriction(0, {FrictionLaw::Coulomb, {0, 0}, 0, true});
  TEST_ASSERT(difference(filled->solve(), tied->solve()) < 1e-7);
}

TEUCHOS_UNIT_TEST(ChangedSystem, ForcesAreOfRowsThatAreThere) {
  const auto comm = Tpetra::getDefaultComm();
  const auto filled = makeSystem();
  filled->solve();
  const auto text = [&] { return refusal([&] { filled->system.contactForces(); }); };
  TEST_EQUALITY(text(), std::string());
  if (comm->getRank() == 0) filled->system.prescribe(idOf(std::int64_t(filled->mesh.numNodes()) - 1), 2, -0.01);
  filled->system.setUp();
  TEST_ASSERT(contains(text(), "solve first"));
  filled->solve();
  TEST_EQUALITY(text(), std::string());
  filled->system.setFriction(0, {FrictionLaw::Coulomb, {0, 0}, 0, true});
  filled->system.setUp();
  TEST_ASSERT(contains(text(), "solve first"));
}

// The motion that costs nothing is found where the coarse matrix is factored, after matrices were let go.
TEUCHOS_UNIT_TEST(ChangedSystem, GoesOnAfterAKernelThatNothingHeld) {
  const auto comm = Tpetra::getDefaultComm();
  Filled filled;
  // Two halves of one body that have nothing in common, as one matrix: twelve motions.
  Piece piece = filled.pieces[0], other = filled.pieces[3];
  const Eigen::SparseMatrix<double> A = stiffnessOf(piece), B = stiffnessOf(other);
  const Eigen::Index a = A.rows(), n = a + B.rows();
  Eigen::SparseMatrix<double> K(n, n);
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [M, at] : {std::pair(&A, Eigen::Index(0)), {&B, a}})
    for (Eigen::Index c = 0; c < M->cols(); ++c)
      for (Eigen::SparseMatrix<double>::InnerIterator it(*M, c); it; ++it) entries.emplace_back(int(at + it.row()), int(at + c), it.value());
  K.setFromTriplets(entries.begin(), entries.end());
  std::vector<std::int64_t> nodes = piece.nodes;
  nodes.insert(nodes.end(), other.nodes.begin(), other.nodes.end());
  Coordinates places = piece.coordinates;
  places.insert(places.end(), other.coordinates.begin(), other.coordinates.end());
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(n, 12);
  for (Eigen::Index node = 0; node < n / 3; ++node) {
    const Eigen::Index column = 3 * node < a ? 0 : 6;
    const auto& x = places[std::size_t(node)];
    R.block<3, 3>(3 * node, column).setIdentity();
    R.block<3, 3>(3 * node, column + 3) << 0, x[2], -x[1], -x[2], 0, x[0], x[1], -x[0], 0;
  }
  const RCP<CrsMatrix> crs = crsOf(K);
  if (comm->getRank() == 0) {
    const auto ids = idsOf(nodes);
    const auto x = flat(places);
    filled.system.addSubdomain({0, Teuchos::arrayViewFromVector(ids), Teuchos::arrayViewFromVector(x), crs,
                                Teuchos::ArrayView<const double>(R.data(), R.size())});
  }
  const auto hold = [&](const std::vector<std::int64_t>& of, double x0) {
    for (const auto node : of)
      if (comm->getRank() == 0 && std::abs(filled.mesh.coordinates[std::size_t(node)][0] - x0) < 1e-9)
        for (int d = 0; d < 3; ++d) filled.system.prescribe(idOf(node), d, 0.0);
  };
  hold(piece.nodes, 0);
  const auto load = [](const Point& x) { return x[2] < 1 - 1e-9 ? Point{0, 0, 0} : Point{0, 0, -0.01}; };
  TEST_ASSERT(contains(refusal([&] { filled.solve(load); }), "no solution"));
  TEST_ASSERT(contains(refusal([&] { filled.solve(load); }), "no solution"));
  hold(other.nodes, 2);
  const Eigen::VectorXd u = filled.solve(load);
  TEST_ASSERT(filled.outcome.solved && u.lpNorm<Eigen::Infinity>() > 1e-4);
}

TEUCHOS_UNIT_TEST(ChangedSystem, PrescribedOverlapHasNoSolution) {
  const auto comm = Tpetra::getDefaultComm();
  const auto filled = makeSystem();
  const auto move = [&](double z) {
    for (std::size_t node = 0; node < filled->mesh.numNodes(); ++node) {
      const Point& x = filled->mesh.coordinates[node];
      if (int(node) % comm->getSize() != comm->getRank() || std::abs(x[2]) > 1e-9 || x[0] < 1.9) continue;
      for (int d = 0; d < 3; ++d) filled->system.prescribe(idOf(std::int64_t(node)), d, d == 2 && node >= filled->mesh.numNodes() / 2 ? z : 0.0);
    }
  };
  move(-0.25);
  TEST_ASSERT(contains(refusal([&] { filled->solve(); }), "make the surfaces overlap by 0.25"));
  move(0.05);
  filled->solve();
  TEST_ASSERT(filled->outcome.solved);
  move(-0.05);  // another value of the same support
  TEST_ASSERT(contains(refusal([&] { filled->solve(); }), "make the surfaces overlap by 0.05"));
}

// Multipliers of before are round-off then.
TEUCHOS_UNIT_TEST(ChangedSystem, LoadsMayFallFar) {
  const auto filled = makeSystem();
  const Eigen::VectorXd u = filled->solve();
  const long first = filled->outcome.multiplications;
  for (const double factor : {1e-15, 1e15, 1e-30}) {
    TEST_ASSERT(difference(factor * u, filled->solve(factor)) < 1e-7);
    TEST_ASSERT(filled->outcome.solved && filled->outcome.multiplications <= first + 2);
  }
}

TEUCHOS_UNIT_TEST(ChangedSystem, GapsThatAreNeverClosedMayBeHuge) {
  const auto filled = makeSystem(), few = makeSystem(0, 0.9);
  for (std::size_t i = 0; i < filled->pairs.size(); ++i)
    if (filled->mesh.coordinates[filled->secondaries[i]][0] < 0.9) filled->system.setGap(filled->pairs[i], 1e30);
  TEST_ASSERT(difference(filled->solve(), few->solve()) < 1e-7);
  TEST_ASSERT(filled->outcome.solved && filled->outcome.multiplications <= few->outcome.multiplications + 3);
}

TEUCHOS_UNIT_TEST(ChangedSystem, ObstaclesThatContradictEachOther) {
  const auto filled = makeSystem();
  if (!filled->secondaries.empty())
    for (const double side : {-1.0, 1.0})
      filled->system.addPair({0, idOf(std::int64_t(filled->secondaries[0])), {}, {0, 0, side}, {1, 0, 0}, -0.1, 1});
  TEST_ASSERT(contains(refusal([&] { filled->solve(); }), "contradict each other"));
}

TEUCHOS_UNIT_TEST(ChangedSystem, RefusesNumbersBeyondItsOwn) {
  const int rank = Tpetra::getDefaultComm()->getRank();
  const auto refusedWith = [&](auto&& fill) {
    Filled filled;
    if (rank == 0) fill(filled);
    return refusal([&] { filled.system.setUp(); });
  };
  const auto addPieceWith = [](Filled& filled, int body, GlobalOrdinal id) {
    const Piece& piece = filled.pieces[0];
    auto ids = idsOf(piece.nodes);
    if (id >= 0) ids.back() = id;
    const auto x = flat(piece.coordinates);
    filled.system.addSubdomain({body, Teuchos::arrayViewFromVector(ids), Teuchos::arrayViewFromVector(x), crsOf(stiffnessOf(piece))});
  };
  TEST_ASSERT(contains(refusedWith([&](Filled& filled) { addPieceWith(filled, 0, std::numeric_limits<GlobalOrdinal>::max()); }), "at most 3074457345618258601"));
  TEST_ASSERT(contains(refusedWith([&](Filled& filled) { addPieceWith(filled, 2000000000, -1); }), "Body 2000000000 is given; there are 1 subdomains"));
  const auto filled = makeSystem();
  TEST_ASSERT(contains(refusal([&] { filled->solve(1e120); }), "A load is not finite, or beyond 1e100"));
  filled->system.prescribe(idOf(0), 0, 1e120);
  TEST_ASSERT(contains(refusal([&] { filled->system.setUp(); }), "at most 1e100"));
  if (rank == 0) filled->system.addPair({0, idOf(20), {{idOf(20), 1.0}}, {0, 0, -1}, {1, 0, 0}});
  TEST_ASSERT(contains(refusal([&] { filled->system.setUp(); }), "on its primary side, too"));
  FrictionSpec rough = filled->friction;
  rough.coefficients[0] = 1e120;
  filled->system.setFriction(0, rough);
  TEST_ASSERT(contains(refusal([&] { filled->system.setUp(); }), "at most 1e+100"));
}

// Where supports leave a pair one direction to slip, the axes of friction say only how large the coefficient is there.
TEUCHOS_UNIT_TEST(ChangedSystem, FrictionInPlaneStrainHasOneDirection) {
  const double angle = 0.5, c = std::cos(angle), s = std::sin(angle);
  const Point oblique{c, s, 0};
  Sheared straight({0.3, 0.3}, {1, 0, 0}), turned({0.3, 0.3}, oblique);
  const Eigen::VectorXd u = straight.solve();
  TEST_ASSERT(difference(u, turned.solve()) < 1e-7);
  TEST_ASSERT(turned.filled.outcome.solved && turned.filled.outcome.multiplications <= straight.filled.outcome.multiplications + 2);
  // T = F^2 e / |F e| g: its part along e is |F e| g, as if that were the coefficient.
  const double alongX = std::hypot(0.4 * c, 0.2 * s);
  Sheared orthotropic({0.4, 0.2}, oblique), equivalent({alongX, 0.1}, {1, 0, 0});
  TEST_ASSERT(difference(orthotropic.solve(), equivalent.solve()) < 1e-7);
  // Forces come in the axes that were given, and are along x.
  const auto forces = orthotropic.filled.system.contactForces(), expected = equivalent.filled.system.contactForces();
  TEST_EQUALITY(forces.size(), expected.size());
  for (std::size_t i = 0; i < forces.size(); ++i) {
    // normal (0, 0, -1): t2 = normal x t1 = (sin, -cos, 0)
    const double alongXOfPair = c * forces[i][1] + s * forces[i][2], alongYOfPair = s * forces[i][1] - c * forces[i][2];
    TEST_ASSERT(std::abs(alongXOfPair - expected[i][1]) < 1e-8 && std::abs(alongYOfPair) < 1e-12);
  }
}

// Supports drive the block across the plane and its top along it: friction has the direction of the whole slip.
TEUCHOS_UNIT_TEST(ChangedSystem, FrictionSeesASlipThatIsDriven) {
  const auto comm = Tpetra::getDefaultComm();
  const auto forcesOf = [&](Sheared& sheared, const Point& t1, const Point& t2) {
    double mine[3] = {0, 0, 0}, all[3];
    for (const auto& force : sheared.filled.system.contactForces()) {
      mine[0] += force[0];
      for (std::size_t d = 0; d < 2; ++d) mine[1 + d] += force[1] * t1[d] + force[2] * t2[d];
    }
    Teuchos::reduceAll(*comm, Teuchos::REDUCE_SUM, 3, mine, all);
    return std::array<double, 3>{all[0], all[1], all[2]};
  };
  const double h = std::sqrt(0.5);
  Sheared changed({0.3, 0.3}, {1, 0, 0}), turned({0.3, 0.3}, {h, h, 0});
  drive(changed, 0);
  const Eigen::VectorXd before = changed.solve();
  drive(changed, 0.05);  // other values of the same supports, and other axes
  drive(turned, 0.05);
  const Eigen::VectorXd driven = changed.solve();
  TEST_ASSERT(changed.filled.outcome.solved && changed.filled.outcome.multiplications <= 40);
  TEST_ASSERT(difference(turned.solve(), driven) < 1e-7);
  const auto forces = forcesOf(changed, {1, 0, 0}, {0, -1, 0}), expected = forcesOf(turned, {h, h, 0}, {h, -h, 0});
  for (std::size_t k = 0; k < 3; ++k) TEST_ASSERT(std::abs(forces[k] - expected[k]) < 1e-7 * expected[0]);
  TEST_ASSERT(std::hypot(forces[1], forces[2]) > 0.299 * forces[0]);  // all pairs slide, in nearly one direction:
  TEST_ASSERT(std::abs(forces[1]) < 0.25 * std::abs(forces[2]));      // they follow the top by less than .01
  drive(changed, 0.0);
  TEST_ASSERT(difference(before, changed.solve()) < 1e-7);
  // Once the coefficients differ the axes are those that were given.
  changed.filled.system.setFriction(0, {FrictionLaw::Coulomb, {0.3, 0.2}, 0, false});
  Sheared orthotropic({0.3, 0.2}, {1, 0, 0});
  drive(orthotropic, 0.0);
  TEST_ASSERT(difference(orthotropic.solve(), changed.solve()) < 1e-7);
}

// Along an axis of friction, and coefficients differ: forces follow the law along both axes, whichever of them is driven.
TEUCHOS_UNIT_TEST(ChangedSystem, OrthotropicFrictionSeesASlipThatIsDriven) {
  const std::array<Point, 2> alongX{{{1, 0, 0}, {0, -1, 0}}}, alongY{{{0, 1, 0}, {1, 0, 0}}};  // the normal is (0, 0, -1)
  for (const std::array<double, 2>& F : {std::array{0.3, 0.1}, std::array{0.1, 0.3}, std::array{0.3, 3e-4}, std::array{3e-4, 0.3}})
    for (const auto& axes : {alongX, alongY}) {
      Sheared sheared(F, axes[0]);
      drive(sheared, 0.05);
      const Eigen::VectorXd u = sheared.solve();
      TEST_ASSERT(sheared.filled.outcome.solved && sheared.filled.outcome.multiplications <= 40);
      TEST_COMPARE(errorOfSlipLaw(sheared, u, F, axes), <, 1e-5);
    }
  // Coefficients of another ratio are other rows, a common factor is none.
  Sheared changed({0.2, 0.2}, {1, 0, 0}), same({0.3, 0.1}, {1, 0, 0});
  drive(changed, 0.05);
  drive(same, 0.05);
  changed.solve();
  for (const std::array<double, 2>& F : {std::array{0.0, 0.0}, std::array{0.3, 0.0}, std::array{0.15, 0.05}, std::array{0.3, 0.1}}) {
    changed.filled.system.setFriction(0, {FrictionLaw::Coulomb, F, 0, false});
    changed.solve();
    TEST_ASSERT(changed.filled.outcome.solved);
  }
  TEST_ASSERT(difference(changed.solve(), same.solve()) < 1e-7);
  TEST_COMPARE(errorOfSlipLaw(changed, same.solve(), {0.3, 0.1}, alongX), <, 1e-5);
}

// A block between two obstacles that are nearer to each other than it is thick: no load, no support.
TEUCHOS_UNIT_TEST(ChangedSystem, InterferenceAloneIsMeasuredByItsForces) {
  const auto comm = Tpetra::getDefaultComm();
  Filled filled;
  addUpper(filled);
  filled.system.addInterface("jaws", {FrictionLaw::Coulomb, {0.3, 0.3}, 0, false});
  filled.system.setTolerance(1e-6);
  for (std::size_t node = filled.mesh.numNodes() / 2; node < filled.mesh.numNodes(); ++node) {
    const Point& x = filled.mesh.coordinates[node];
    if (int(node) % comm->getSize() != comm->getRank() || (x[2] > 1e-9 && x[2] < 1 - 1e-9)) continue;
    filled.system.addPair({0, idOf(std::int64_t(node)), {}, {0, 0, x[2] < 0.5 ? -1.0 : 1.0}, {1, 0, 0}, -0.01, 1});
  }
  filled.solve(0);
  TEST_ASSERT(filled.outcome.solved);
  double mine = 0, sum = 0;
  for (const auto& force : filled.system.contactForces()) mine += force[0];
  Teuchos::reduceAll(*comm, Teuchos::REDUCE_SUM, mine, Teuchos::outArg(sum));
  // Sticking faces 2 x 1, pressed by .02: between E and the modulus of a strain in one direction.
  const double E = kMaterials[1].youngsModulus, uniaxial = E * 0.75 / (1.25 * 0.5);
  TEST_ASSERT(sum / 2 > 0.02 * 2 * E && sum / 2 < 0.02 * 2 * uniaxial);
}
