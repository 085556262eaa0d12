// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CompactRows.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>

#include "FetiScene.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

bool isKept(GlobalOrdinal row) { return row % 3 != 1; }
bool isPlaced(int subdomain, int dof) { return (subdomain + dof) % 4 != 0; }
double valueOfRow(GlobalOrdinal row) { return std::sin(1.0 + 2.0 * double(row)); }
double valueOfDof(int subdomain, int dof) { return std::cos(3.0 * subdomain + 0.7 * dof); }

struct Compact {
  Dealt dealt;
  std::vector<std::size_t> offsets;
  std::unique_ptr<CompactRows> rows;

  explicit Compact(const Scene& scene) : dealt(deal(Tpetra::getDefaultComm(), scene)), offsets(dealt.jump->primalOffsets()) {
    const MultiplierMap& multipliers = *dealt.multipliers;
    std::vector<char> kept;
    for (std::size_t row = 0; row < localNumElements(*multipliers.overlapMap()); ++row)
      kept.push_back(isKept(multipliers.overlapMap()->getGlobalElement(int(row))));
    rows = std::make_unique<CompactRows>(multipliers, kept, Eigen::Index(offsets.back()), [&](int subdomain, int dof) {
      return isPlaced(subdomain, dof) ? Eigen::Index(offsets[std::size_t(subdomain - dealt.first)]) + dof : -1;
    }, [](const MultiplierMap::OverlapEntry& entry) { return 1.0 / entry.weight; });
  }
  GlobalOrdinal global(std::size_t i) const { return dealt.multipliers->map()->getGlobalElement(rows->rows()[i]); }
};

// sum of entries of W B^T over what `visit` is given
template <class Visit>
void forEachKept(const Scene& scene, Visit&& visit) {
  for (GlobalOrdinal row = 0; row < scene.rows.numRows(); ++row)
    for (auto k = scene.rows.offsets[row]; k < scene.rows.offsets[row + 1] && isKept(row); ++k) {
      const RowEntry& entry = scene.rows.entries[k];
      if (isPlaced(entry.subdomain, entry.dof)) visit(row, entry);
    }
}

}  // namespace

TEUCHOS_UNIT_TEST(CompactRows, OwnRowsAreTheKeptOnesInOrder) {
  const Compact compact(makeScene(heldScene(6)));
  const auto& map = *compact.dealt.multipliers->map();
  std::vector<int> expected;
  for (std::size_t row = 0; row < localNumElements(map); ++row)
    if (isKept(map.getGlobalElement(int(row)))) expected.push_back(int(row));
  TEST_COMPARE_ARRAYS(compact.rows->rows(), expected);
}

TEUCHOS_UNIT_TEST(CompactRows, SpreadsAsTheDenseMatrix) {
  const Scene scene = makeScene(heldScene(6));
  const Compact compact(scene);
  Eigen::VectorXd x(Eigen::Index(compact.rows->rows().size())), expected = Eigen::VectorXd::Zero(Eigen::Index(compact.offsets.back()));
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = valueOfRow(compact.global(std::size_t(i)));
  forEachKept(scene, [&](GlobalOrdinal row, const RowEntry& entry) {
    const int local = entry.subdomain - compact.dealt.first;
    if (local < 0 || local >= int(compact.dealt.mine.size())) return;
    expected[Eigen::Index(compact.offsets[std::size_t(local)]) + entry.dof] += entry.value / entry.weight * valueOfRow(row);
  });
  TEST_ASSERT(compact.dealt.mine.empty() || expected.norm() > 0);
  TEST_COMPARE((compact.rows->spread(x) - expected).norm(), <=, 1e-14 * (1 + expected.norm()));
  Dense two(x.size(), 2), both(expected.size(), 2);
  two << x, -2 * x;
  both << expected, -2 * expected;
  TEST_COMPARE((compact.rows->spread(two) - both).norm(), <=, 1e-14 * (1 + both.norm()));
  const Dense units = compact.rows->spreads(Eigen::VectorXd::Constant(x.size(), 1), 2);  // all rows in one column
  TEST_COMPARE(units.col(0).norm(), ==, 0.0);
  TEST_COMPARE((units.col(1) - compact.rows->spread(Eigen::VectorXd::Ones(x.size()))).norm(), <=, 1e-14 * (1 + units.norm()));
}

TEUCHOS_UNIT_TEST(CompactRows, CollectsFromAllRanks) {
  const Scene scene = makeScene(heldScene(6));
  const Compact compact(scene);
  Eigen::VectorXd t = Eigen::VectorXd::Zero(Eigen::Index(compact.offsets.back())), all = Eigen::VectorXd::Zero(scene.rows.numRows());
  for (const auto& sub : compact.dealt.mine)
    for (int dof = 0; dof < sub.numDofs(); ++dof)
      t[Eigen::Index(compact.offsets[std::size_t(sub.id - compact.dealt.first)]) + dof] = valueOfDof(sub.id, dof);
  forEachKept(scene, [&](GlobalOrdinal row, const RowEntry& entry) {
    all[row] += entry.value / entry.weight * valueOfDof(entry.subdomain, entry.dof);
  });
  TEST_ASSERT(all.norm() > 0);
  const Eigen::VectorXd y = compact.rows->collect(t);
  Dense two(t.size(), 2);
  two << t, 3 * t;
  const Dense both = compact.rows->collect(two);
  TEST_COMPARE((both.col(0) - y).norm() + (both.col(1) - 3 * y).norm(), <=, 1e-14 * all.norm());
  for (Eigen::Index i = 0; i < y.size(); ++i) TEST_COMPARE(std::abs(y[i] - all[compact.global(std::size_t(i))]), <=, 1e-14 * all.norm());
}
