// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DeflatedPreconditioner.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "Haptos_DeflatedContactBlock.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_PartShape.hpp"
#include "Haptos_PolynomialMotions.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_SoftModes.hpp"
#include "HeldBeams.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

// Two beams held at one end, or two plates.
struct Setup : HeldBeams {
  std::vector<char> slender;
  RCP<const DeflatedPreconditioner> deflated;

  explicit Setup(double height, const std::array<int, 3>& bricks = {4, 2, 2}, int parts = 4) : HeldBeams(height, 0, bricks, parts) {
    for (const auto& sub : feti.dealt.mine) slender.push_back(isSlender(aspectOf(sub.coordinates)));
    deflated = DeflatedPreconditioner::make(M, slender, {});
  }

  // Columns of G^T on all ranks.
  Dense denseGT() const {
    const Eigen::Index l = 6 * scene.partition.count;
    MultiVector GT(feti.map(), std::size_t(l));
    feti.G->applyGT(Dense::Identity(l, l), GT);
    return gathered(GT);
  }

  // Largest and smallest eigenvalue of P F P A P on its range, where A should be about the inverse of F.
  std::array<double, 2> spectrum(const Dense& A) const {
    const Dense GT = denseGT(), F = denseOf(*feti.F);
    const Dense P = Dense::Identity(F.rows(), F.rows()) - GT * densePseudoInverse(GT.transpose() * GT) * GT.transpose();
    const SymmetricSpectrum spectrum(P * F * P);
    const Dense root = spectrum.vectors * spectrum.values.cwiseMax(0.0).cwiseSqrt().asDiagonal() * spectrum.vectors.transpose();
    const Eigen::VectorXd values = symmetricEigenvalues(root * A * root);
    double smallest = values.tail<1>()[0];
    for (double value : values)
      if (value > 1e-6) smallest = std::min(smallest, value);
    return {values.tail<1>()[0], smallest};
  }
};

}  // namespace

TEUCHOS_UNIT_TEST(SoftModes, TellPlatesFromBlocksAndKeepTheEnergy) {
  for (double height : {1.0, 0.02}) {
    const Setup t(height);
    const int found = int(std::count(t.slender.begin(), t.slender.end(), char(1)));
    TEST_EQUALITY(found, height < 0.5 ? int(t.slender.size()) : 0);
    if (t.feti.systems->numClasses() == 0) continue;
    const Eigen::Index n = Eigen::Index(t.M->surface().boundary(0).size());
    Dense S(n, n), R(n, 6);
    t.M->surface().apply(0, Dense::Identity(n, n), S);
    for (Eigen::Index i = 0; i < n; ++i) R.row(i) = (*t.feti.systems)[t.feti.systems->members()[0].front()].R().row(t.M->surface().boundary(0)[std::size_t(i)]);
    const SoftSpectrum soft = softSpectrum(S, R, 0.05);
    TEST_COMPARE(largest(soft.L.transpose() * soft.L - S), <=, 1e-10 * largest(S));
    TEST_COMPARE(largest(soft.L * R), <=, 1e-9 * largest(soft.L));
    TEST_COMPARE(soft.modes.cols(), >=, height < 0.5 ? 5 : 0);
    for (Eigen::Index j = 0; j < soft.modes.cols(); ++j)
      TEST_COMPARE((soft.L * soft.modes.col(j)).squaredNorm(), <, 0.05 * soft.modes.col(j).dot(S.diagonal().cwiseProduct(soft.modes.col(j))));
  }
}

// Where round-off has made soft energies negative there is a root of S all the same: what they had is nothing to it.
TEUCHOS_UNIT_TEST(SoftModes, KeepTheEnergyOfWhatIsNotDefinite) {
  const Eigen::Index n = 40;
  const Dense Q = squareQ(Dense::NullaryExpr(n, n, [](Eigen::Index i, Eigen::Index j) { return std::sin(1.0 + 1.7 * double(i * i) + 2.3 * double(j) * double(i % 7 + 1)); }));
  Eigen::VectorXd mu = Eigen::VectorXd::LinSpaced(n, 1, 2);
  mu.head(6).setZero();
  mu[6] = -1e-12;
  mu[7] = 1e-6;
  const Dense S = Q * mu.asDiagonal() * Q.transpose(), R = Q.leftCols(6);
  const SoftSpectrum soft = softSpectrum(S, R, 0.05);
  TEST_COMPARE(largest(soft.L.transpose() * soft.L - S), <=, 1e-11);
  TEST_COMPARE(largest(soft.L * R), <=, 1e-12);
  TEST_EQUALITY(soft.modes.cols(), 2);
}

// Between contact rows by the difference, where nothing is slender.  In high bodies most motions have nothing on contact rows.
TEUCHOS_UNIT_TEST(DeflatedPreconditioner, ContactBlock) {
  TEST_ASSERT(Setup(0.02).deflated->contactBlock().M.is_null());
  for (const auto& t : {Setup(1.0), Setup(6.0, {2, 2, 12}, 12)}) {
    const auto block = t.deflated->contactBlock();
    TEST_ASSERT(!block.M.is_null() && block.entriesRead > 0);
    const Dense Z = denseOf(*t.deflated), between = denseOf(*block.M);
    const auto isContact = [&](Eigen::Index row) {
      const RowKind kind = t.scene.rows.kinds[std::size_t(row)];
      return kind == RowKind::Normal || kind == RowKind::Tangential;
    };
    int compared = 0;
    for (Eigen::Index i = 0; i < Z.rows(); ++i)
      for (Eigen::Index j = 0; j < Z.cols(); ++j) {
        if (!isContact(i) || !isContact(j)) continue;
        ++compared;
        TEST_ASSERT(std::abs(between(i, j) - Z(i, j)) <= 1e-10 * largest(Z));
      }
    TEST_ASSERT(compared > 0);
  }
}

// By global numbers of all ranks, -1: none.
void compareBetween(const Setup& t, const Dense& M, std::vector<int> rows, Teuchos::FancyOStream& out, bool& success) {
  const auto& map = *t.feti.map();
  for (int& row : rows) row = row < 0 ? -1 : int(map.getGlobalElement(row));
  rows = gatheredOnAll(*map.getComm(), rows);
  const Dense Z = denseOf(*t.deflated);
  TEST_EQUALITY(M.rows(), Eigen::Index(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const double wanted = rows[i] < 0 || rows[j] < 0 ? 0.0 : Z(rows[i], rows[j]);
      TEST_ASSERT(std::abs(M(Eigen::Index(i), Eigen::Index(j)) - wanted) <= 1e-10 * largest(Z));
    }
}

// Pairs of nodes do not meet, so groups of them have what M_Z has between their rows.
TEUCHOS_UNIT_TEST(DeflatedPreconditioner, GroupsOfContactRows) {
  const Setup t(1.0);
  std::vector<std::vector<int>> groups(3);
  for (const LocalPair& pair : t.feti.dealt.jump->multipliers().pairs())
    for (int row : {pair.normal, pair.tangential[0], pair.tangential[1]})
      groups[std::size_t(t.feti.map()->getGlobalElement(pair.normal)) % 3].push_back(row);
  const auto block = t.deflated->contactBlock();
  const auto M = block.ofGroups(groups);
  for (std::size_t g = 0; g < groups.size(); ++g) compareBetween(t, M[g], groups[g], out, success);
  std::vector<int> rows{-1};
  for (const auto& group : groups) rows.insert(rows.end(), group.begin(), group.end());
  compareBetween(t, block.between(rows), rows, out, success);
}

// Where Y has few entries it is kept with K^+ in the place of W = Y C^T.
TEUCHOS_UNIT_TEST(DeflatedPreconditioner, SparseRootsOfContactBlocksAreWhatDenseOnesAre) {
  constexpr int kMotions = 4, kAny = 12;
  const Setup t(1.0);
  const auto& map = *t.feti.dealt.jump->multipliers().contactMap();
  const int n = int(localNumElements(map));
  Eigen::SparseMatrix<double> Y(n, kMotions);
  for (int i = 0; i < n; ++i)
    if (const auto row = map.getGlobalElement(i); row % 3 == 0) Y.insert(i, int(row / 3 % kMotions)) = 1 + std::sin(double(row));
  const Dense C = Dense::NullaryExpr(kAny, kMotions, [](Eigen::Index i, Eigen::Index j) { return std::sin(1.0 + double(7 * i + 3 * j)); });
  const double scale = std::sqrt(largest(denseOf(*t.M)));
  const DeflatedContactBlock sparse(t.M, Y, scale * C), dense(t.M, Dense(Y) * scale * C.transpose());
  const auto entriesOf = [&](const DeflatedContactBlock& block) { return sumOfAll(*map.getComm(), block.entriesRead()); };
  TEST_COMPARE(entriesOf(sparse), <, entriesOf(dense));
  const Dense wanted = denseOf(dense);
  TEST_COMPARE(largest(denseOf(sparse) - wanted), <=, 1e-13 * largest(wanted));
  std::vector<int> rows(static_cast<std::size_t>(n));
  std::iota(rows.begin(), rows.end(), 0);
  TEST_COMPARE(largest(sparse.between(rows) - dense.between(rows)), <=, 1e-13 * largest(wanted));
  TEST_COMPARE(largest(sparse.ofGroups({rows})[0] - dense.ofGroups({rows})[0]), <=, 1e-11 * largest(wanted));
  MultiVector x(sparse.getDomainMap(), 3), y(sparse.getRangeMap(), 3), z(sparse.getRangeMap(), 3);
  x.randomize();
  sparse.apply(x, y, Teuchos::NO_TRANS, 2.0);
  dense.apply(x, z, Teuchos::NO_TRANS, 2.0);
  TEST_COMPARE(largestDifference(y, z), <=, 1e-12 * largest(wanted));
}

// Few spectral modes where few are wanted, none at all where those that are left out are too stiff.
TEUCHOS_UNIT_TEST(DeflatedPreconditioner, TakesTheStiffestModes) {
  const Setup t(0.2);
  const int rigid = 6 * t.scene.partition.count, spectral = t.deflated->numCoarse() - rigid;
  TEST_COMPARE(spectral, >, 4);
  const auto with = [&](long most, double stiffestLeft) {
    DeflatedMotions::Spectra wanted;
    wanted.most = most;
    wanted.stiffestLeft = stiffestLeft;
    return DeflatedPreconditioner::make(t.M, t.slender, wanted);
  };
  const auto few = with(spectral / 2, 1e300);
  TEST_COMPARE(few->numCoarse(), <=, rigid + spectral / 2);
  TEST_COMPARE(few->numCoarse(), >, rigid);
  TEST_EQUALITY(with(spectral, 4.5)->numCoarse(), rigid + spectral);
  TEST_ASSERT(with(spectral / 2, 4.5).is_null());
  out << spectral << " spectral modes, " << few->numCoarse() - rigid << " of them where half are wanted\n";
}

// Plates whose soft motions are too many keep the softest: half of them does half of the work, none is a hundred times as bad.
TEUCHOS_UNIT_TEST(DeflatedPreconditioner, TakesTheSoftestModes) {
  const Setup t(0.02);
  const int rigid = 6 * t.scene.partition.count, soft = t.deflated->numCoarse() - rigid;
  const auto with = [&](int columns) {
    DeflatedMotions::Spectra wanted;
    wanted.columns = columns;
    return DeflatedPreconditioner::make(t.M, t.slender, wanted);
  };
  const auto all = with(rigid + soft), half = with(rigid + soft / 2), none = with(rigid);
  TEST_EQUALITY(all->numCoarse(), rigid + soft);
  TEST_COMPARE(half->numCoarse(), <=, rigid + soft / 2);
  TEST_COMPARE(half->numCoarse(), >, rigid);
  TEST_EQUALITY(none->numCoarse(), rigid);
  TEST_ASSERT(with(rigid - 1).is_null());
  const auto largestOf = [&](const auto& M) { return t.spectrum(denseOf(*M))[0]; };
  const double withAll = largestOf(all), withHalf = largestOf(half), without = largestOf(none);
  out << soft << " soft modes: M F up to " << withAll << ", with " << half->numCoarse() - rigid << " of them " << withHalf << ", with none " << without << "\n";
  TEST_COMPARE(withHalf, <=, 0.1 * without);
}

// Every third row that a rank has, and one that is not there.
TEUCHOS_UNIT_TEST(DeflatedPreconditioner, BetweenRowsIsThatPartOfIt) {
  for (double height : {1.0, 0.02}) {
    const Setup t(height);
    std::vector<int> rows{-1};
    for (int row = 0; row < int(localNumElements(*t.feti.map())); row += 3) rows.push_back(row);
    const Dense between = t.deflated->between(rows);
    compareBetween(t, between, rows, out, success);
    TEST_COMPARE(smallestEigenvalue(between), >=, -1e-13 * largest(denseOf(*t.deflated)));
  }
}

TEUCHOS_UNIT_TEST(DeflatedPreconditioner, ManyColumnsAreWhatEachIsAlone) {
  for (double height : {1.0, 0.02}) {
    const Setup t(height);
    MultiVector x(t.feti.map(), 3), y(t.feti.map(), 3);
    x.randomize();
    y.putScalar(1.0);
    t.deflated->apply(x, y, Teuchos::NO_TRANS, 2.0, 0.5);
    for (std::size_t v = 0; v < 3; ++v) {
      Vector alone(t.feti.map());
      alone.putScalar(1.0);
      t.deflated->apply(*x.getVector(v), alone, Teuchos::NO_TRANS, 2.0, 0.5);
      const double size = alone.normInf();
      alone.update(-1.0, *y.getVector(v), 1.0);
      TEST_COMPARE(alone.normInf(), <=, 1e-12 * size);
    }
  }
}

TEUCHOS_UNIT_TEST(DeflatedPreconditioner, BalancedSymmetricAndNearTheInverse) {
  for (double height : {1.0, 0.2, 0.02}) {
    const Setup t(height);
    const Dense M = denseOf(*t.M), Z = denseOf(*t.deflated), GT = t.denseGT();
    TEST_COMPARE(largest(Z - Z.transpose()), <=, 1e-9 * largest(Z));
    TEST_COMPARE(smallestEigenvalue(Z), >=, -1e-10 * largest(Z));
    TEST_COMPARE(largest(GT.transpose() * Z), <=, 1e-7 * largest(GT) * largest(Z));
    TEST_COMPARE(smallestEigenvalue(M - Z), >=, -1e-9 * largest(M));  // energies only become less
    const auto plain = t.spectrum(M), deflated = t.spectrum(Z);
    out << "height " << height << ", coarse " << t.deflated->numCoarse() << ": M F in " << plain[1] << " to " << plain[0] << ", deflated "
        << deflated[1] << " to " << deflated[0] << "\n";
    TEST_COMPARE(t.deflated->numCoarse(), >=, 6 * t.scene.partition.count);
    TEST_COMPARE(deflated[0], <=, height == 0.2 ? 6.0 : 3.0);  // theta is at most 4 beside the spectral modes
    TEST_COMPARE(deflated[1], >=, 0.99);
    TEST_COMPARE(plain[0], >=, (height < 0.1 ? 30 : height < 0.5 ? 3 : 1) * deflated[0]);  // the plates are a hard case
  }
}

// Flat subdomains bend as a whole: that is in the polynomials, which are soft, no rigid motions, and do what spectral modes do for far less.
TEUCHOS_UNIT_TEST(DeflatedPreconditioner, PolynomialsOfFlatSubdomains) {
  const Setup t(0.2, {6, 6, 1}, 6);
  const LocalSystems& systems = *t.feti.systems;
  std::vector<Dense> motions, none;
  for (int c = 0; c < systems.numClasses(); ++c) {
    const int member = systems.members()[std::size_t(c)].front();
    const auto& boundary = t.M->surface().boundary(c);
    const auto K = systems.source().assemble(member);
    const Dense w = motions.emplace_back(polynomialMotions({systems.source().coordinates(member), K, systems[member].R(), boundary}));
    none.push_back(w.leftCols(0));
    TEST_COMPARE(w.cols(), >=, 1);
    Dense S(w.rows(), w.rows());
    t.M->surface().apply(c, Dense::Identity(w.rows(), w.rows()), S);
    const Eigen::VectorXd D = K.diagonal()(boundary);
    for (Eigen::Index j = 0; j < w.cols(); ++j) {
      const double scale = w.col(j).dot(D.cwiseProduct(w.col(j)));
      TEST_COMPARE(w.col(j).dot(S * w.col(j)), <, 0.05 * scale);  // with the interior free it is less still
      TEST_COMPARE(w.col(j).dot(S * w.col(j)), >, 1e-8 * scale);
    }
    TEST_COMPARE(largest(systems[member].R()(boundary, Eigen::all).transpose() * D.asDiagonal() * w), <=, 1e-8 * D.maxCoeff() * largest(w));
  }
  const auto polynomial = DeflatedPreconditioner::make(t.M, motions), rigid = DeflatedPreconditioner::make(t.M, none);
  const auto plain = t.spectrum(denseOf(*t.M)), first = t.spectrum(denseOf(*rigid)), cured = t.spectrum(denseOf(*polynomial));
  out << "M F up to " << plain[0] << ", by rigid motions " << first[0] << ", by polynomials " << cured[0] << "\n";
  TEST_COMPARE(2 * cured[0], <=, first[0]);
  TEST_COMPARE(cured[1], >=, 0.99);
}

