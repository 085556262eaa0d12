// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ForcesOfDependentRows.hpp"

#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <map>
#include <memory>

#include "Haptos_DependentRows.hpp"
#include "Haptos_DualPreconditioner.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_RowGram.hpp"

namespace Haptos {
namespace {

class Sum final : public Operator {
 public:
  Sum(RCP<const Operator> M, RCP<const Operator> E) : M_(std::move(M)), E_(std::move(E)) {}

  RCP<const Map> getDomainMap() const override { return M_->getDomainMap(); }
  RCP<const Map> getRangeMap() const override { return M_->getRangeMap(); }
  bool hasTransposeApply() const override { return M_->hasTransposeApply(); }
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1.0, double beta = 0.0) const override {
    M_->apply(x, y, mode, alpha, beta);
    E_->apply(x, y, mode, alpha, 1.0);
  }

 private:
  RCP<const Operator> M_, E_;
};

RCP<const Operator> sum(const RCP<const Operator>& M, const RCP<const CrsMatrix>& E) {
  if (M.is_null()) return M;
  return Teuchos::rcp(new Sum(M, E));
}

struct Entry {
  GlobalOrdinal row, column;
  double value;
};

// Of all ranks, on all: they are few.  Collective.
std::vector<Entry> entriesOnAll(const CrsMatrix& E) {
  std::vector<Entry> mine;
  const Map &rows = *E.getRowMap(), &columns = *E.getColMap();
  const auto A = E.getLocalMatrixHost();
  for (LocalOrdinal i = 0; i < A.numRows(); ++i)
    for (auto k = A.graph.row_map(i); k < A.graph.row_map(i + 1); ++k)
      mine.push_back({rows.getGlobalElement(i), columns.getGlobalElement(A.graph.entries(k)), A.values(k)});
  return gatheredOnAll(*rows.getComm(), mine);
}

// M += E between rows given by their global numbers, -1: none.
void addBetween(const std::vector<Entry>& E, const std::vector<GlobalOrdinal>& rows, Eigen::MatrixXd& M) {
  std::map<GlobalOrdinal, Eigen::Index> places;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i] >= 0) places.emplace(rows[i], Eigen::Index(i));
  for (const Entry& entry : E) {
    const auto row = places.find(entry.row), column = places.find(entry.column);
    if (row != places.end() && column != places.end()) M(row->second, column->second) += entry.value;
  }
}

// Lists of every rank's rows by their global numbers, list by list, in each rank after rank.  Collective.
std::vector<std::vector<GlobalOrdinal>> listsOfAll(const Map& map, const std::vector<std::vector<int>>& lists) {
  std::vector<std::vector<GlobalOrdinal>> mine(lists.size()), all(lists.size());
  for (std::size_t g = 0; g < lists.size(); ++g)
    for (const int row : lists[g]) mine[g].push_back(row < 0 ? GlobalOrdinal(-1) : map.getGlobalElement(row));
  const auto gathered = gatheredOnAll(*map.getComm(), mine);
  for (std::size_t i = 0; i < gathered.size(); ++i) {
    auto& list = all[i % lists.size()];
    list.insert(list.end(), gathered[i].begin(), gathered[i].end());
  }
  return all;
}

void addTo(ContactOperators::Deflated& deflated, const DependentRows& E) {
  if (deflated.M.is_null()) return;
  const auto entries = std::make_shared<const std::vector<Entry>>(entriesOnAll(*E.all));
  const auto map = E.all->getRowMap();
  deflated.M = sum(deflated.M, E.all);
  deflated.contactM = sum(deflated.contactM, E.contact);
  if (deflated.between)
    deflated.between = [between = deflated.between, entries, map](const std::vector<int>& rows) {
      Eigen::MatrixXd M = between(rows);
      addBetween(*entries, listsOfAll(*map, {rows}).front(), M);
      return M;
    };
  if (deflated.ofGroups)
    deflated.ofGroups = [ofGroups = deflated.ofGroups, entries, map](const std::vector<std::vector<int>>& groups) {
      std::vector<Eigen::MatrixXd> M = ofGroups(groups);
      const auto rows = listsOfAll(*map, groups);
      for (std::size_t g = 0; g < M.size(); ++g) addBetween(*entries, rows[g], M[g]);
      return M;
    };
}

}  // namespace

void addForcesOfDependentRows(const DualPreconditioner& M, ContactOperators& operators) {
  const DependentRows E = makeDependentRows(M.jump().multipliers(), M.gram().pairs().dependent(), *operators.diagonalOfM);
  if (E.all.is_null()) return;
  operators.M = sum(operators.M, E.all);
  operators.contactM = sum(operators.contactM, E.contact);
  operators.contactRowsOfM = sum(operators.contactRowsOfM, E.contactRows);
  if (operators.makeDeflatedM)
    operators.makeDeflatedM = [make = operators.makeDeflatedM, E](ContactOperators::Price price) {
      ContactOperators::Deflated deflated = make(price);
      addTo(deflated, E);
      return deflated;
    };
}

}  // namespace Haptos
