// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DeflatedPreconditioner.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <type_traits>

#include "Haptos_DeflatedContactBlock.hpp"
#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_PanelJumps.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_SurfaceOperators.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

constexpr int kColumnsOfZ = RowPanel::kColumns;  // that are made at a time
constexpr double kDependent = 1e-14;   // pivots of K with unit diagonal
constexpr double kCancelled = 1e-12;   // of a motion: what its average has left by round-off, where clamps hold all of it

// This rank's entries, in place.
Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>> columnsOf(MultiVector& t) {
  const auto data = t.get1dViewNonConst();
  return {data.getRawPtr(), Eigen::Index(t.getLocalLength()), Eigen::Index(t.getNumVectors()), Eigen::OuterStride<>(Eigen::Index(t.getStride()))};
}

// A(:, rows) X: motions of neighbours are on few rows
Eigen::MatrixXd timesRows(const Eigen::MatrixXd& A, const std::vector<Eigen::Index>& rows, const Eigen::MatrixXd& X) {
  if (Eigen::Index(rows.size()) == A.cols()) return A * X;
  return A(Eigen::all, rows) * X;
}

}  // namespace

RCP<const DeflatedPreconditioner> DeflatedPreconditioner::make(const RCP<const DualPreconditioner>& base, const std::vector<char>& slender,
                                                                      const Spectra& spectra) {
  return make(base, DeflatedMotions::find(*base, slender, spectra), spectra.columns);
}

RCP<const DeflatedPreconditioner> DeflatedPreconditioner::make(const RCP<const DualPreconditioner>& base, const std::vector<Eigen::MatrixXd>& soft) {
  return make(base, DeflatedMotions::given(*base, soft), DeflatedMotions::kLargest);
}

// How many columns there would be is known before they are made, and the same on all ranks.
RCP<const DeflatedPreconditioner> DeflatedPreconditioner::make(const RCP<const DualPreconditioner>& base, std::optional<DeflatedMotions> motions, long most) {
  if (!motions || motions->count(*base->getRangeMap()->getComm()) > most) return {};
  const auto result = Teuchos::rcp(new DeflatedPreconditioner(base));
  result->L_ = std::move(motions->L);
  result->S_ = std::move(motions->S);
  result->assemble(motions->ofSubdomains);
  result->S_.assign(result->L_.size(), {});
  return result;
}

DeflatedPreconditioner::DeflatedPreconditioner(RCP<const DualPreconditioner> base)
    : base_(std::move(base)), HZ_(boundaryUnknowns()), CHZ_(boundaryUnknowns()) {}

// t_i := local(class, t_i) on the boundary unknowns of every subdomain, all columns at once that are not zero there
template <class Local>
void DeflatedPreconditioner::onSubdomains(MultiVector& t, Local&& local) const {
  const auto& offsets = base_->jump().primalOffsets();
  auto columns = columnsOf(t);
  for (int i = 0; i < base_->systems().size(); ++i) {
    const int c = base_->systems()[i].congruenceClass;
    const auto& dofs = base_->surface().boundary(c);
    const Eigen::Index offset = Eigen::Index(offsets[std::size_t(i)]);
    const auto at = [&](std::size_t k, Eigen::Index v) -> double& { return columns(offset + dofs[k], v); };
    std::vector<Eigen::Index> filled;
    for (Eigen::Index v = 0; v < columns.cols(); ++v)
      if (std::any_of(dofs.begin(), dofs.end(), [&](int dof) { return columns(offset + dof, v) != 0; })) filled.push_back(v);
    if (filled.empty()) continue;
    Eigen::MatrixXd x(Eigen::Index(dofs.size()), Eigen::Index(filled.size()));
    for (std::size_t v = 0; v < filled.size(); ++v)
      for (std::size_t k = 0; k < dofs.size(); ++k) x(Eigen::Index(k), Eigen::Index(v)) = at(k, filled[v]);
    local(c, x);
    for (std::size_t v = 0; v < filled.size(); ++v)
      for (std::size_t k = 0; k < dofs.size(); ++k) at(k, filled[v]) = x(Eigen::Index(k), Eigen::Index(v));
  }
}

// t := H t with S = H^T C H: L t where a subdomain is slender, t where it is not
void DeflatedPreconditioner::toHalf(MultiVector& t) const {
  onSubdomains(t, [&](int c, Eigen::MatrixXd& x) {
    const Eigen::MatrixXd& L = L_[std::size_t(c)];
    if (L.size() > 0) x = product(L, x);
  });
}

// t := H^T t
void DeflatedPreconditioner::fromHalf(MultiVector& t) const {
  onSubdomains(t, [&](int c, Eigen::MatrixXd& x) {
    if (L_[std::size_t(c)].size() > 0) x = transposedProduct(L_[std::size_t(c)], x);
  });
}

// t := C t: t where a subdomain is slender, S t where it is not
void DeflatedPreconditioner::applyRest(MultiVector& t) const {
  onSubdomains(t, [&](int c, Eigen::MatrixXd& x) {
    if (L_[std::size_t(c)].size() > 0) return;
    const Eigen::MatrixXd given = x;
    base_->surface().apply(c, given, x);
  });
}

// Averages that are round-off would be scaled to motions like others, which have jumps.
void DeflatedPreconditioner::averageMotions(PanelJumps& jumps, RowPanel& t) const {
  Eigen::MatrixXd squares(kColumnsOfZ, 2);
  squares.col(0) = t.squares();
  jumps.average(t);
  squares.col(1) = t.squares();
  const Eigen::MatrixXd all = sumOfAll(*getRangeMap()->getComm(), squares);
  for (Eigen::Index j = 0; j < kColumnsOfZ; ++j)
    if (all(j, 1) <= kCancelled * kCancelled * all(j, 0))
      for (const int row : t.filled()) t.fill(std::size_t(row))[j] = 0;
}

std::vector<std::vector<Eigen::Index>> DeflatedPreconditioner::boundaryUnknowns() const {
  std::vector<std::vector<Eigen::Index>> unknowns(std::size_t(base_->systems().size()));
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    for (int dof : base_->surface().boundary(base_->systems()[int(i)].congruenceClass))
      unknowns[i].push_back(Eigen::Index(base_->jump().primalOffsets()[i]) + dof);
  return unknowns;
}

// S_i = L^T L: it is slender.
bool DeflatedPreconditioner::isHalved(std::size_t subdomain) const {
  return L_[std::size_t(base_->systems()[int(subdomain)].congruenceClass)].size() > 0;
}

// C = 1 there.
void DeflatedPreconditioner::shareSlender(const SubdomainColumns& half, SubdomainColumns& rest) const {
  for (std::size_t i = 0; i < std::size_t(base_->systems().size()); ++i)
    if (isHalved(i)) rest.share(i, half);
}

// Appends H t and C H t, which are the same where a subdomain is slender.
void DeflatedPreconditioner::appendHalves(int width, std::vector<SubdomainColumns::Piece> pieces, SubdomainColumns& half, SubdomainColumns& rest) const {
  const auto onAll = [&](SubdomainColumns::Piece& piece, Eigen::MatrixXd values) {
    piece.values = std::move(values);
    piece.rows.resize(std::size_t(piece.values.rows()));
    std::iota(piece.rows.begin(), piece.rows.end(), 0);
  };
  const auto classOf = [&](const SubdomainColumns::Piece& piece) { return base_->systems()[int(piece.subdomain)].congruenceClass; };
  for (auto& piece : pieces)
    if (isHalved(piece.subdomain)) onAll(piece, timesRows(L_[std::size_t(classOf(piece))], piece.rows, piece.values));
  half.append(width, pieces);
  for (auto& piece : pieces)
    if (!isHalved(piece.subdomain)) onAll(piece, timesS(classOf(piece), piece));
  rest.append(width, pieces);
}

// S t by its dense matrix as long as that is there
Eigen::MatrixXd DeflatedPreconditioner::timesS(int congruenceClass, const SubdomainColumns::Piece& t) const {
  if (const Eigen::MatrixXd& S = S_[std::size_t(congruenceClass)]; S.size() > 0) return timesRows(S, t.rows, t.values);
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(Eigen::Index(base_->surface().boundary(congruenceClass).size()), t.values.cols()), y(x.rows(), x.cols());
  x(t.rows, Eigen::all) = t.values;
  base_->surface().apply(congruenceClass, x, y);
  return y;
}

// H Z and C H Z, `kColumnsOfZ` columns at a time over all ranks (a motion of one rank has averages on others), and K = (H Z)^T (C H Z).
void DeflatedPreconditioner::assemble(const std::vector<Eigen::MatrixXd>& motions) {
  const auto& comm = *getRangeMap()->getComm();
  std::vector<std::array<int, 2>> columns;  // of this rank
  for (int i = 0; i < base_->systems().size(); ++i)
    for (int m = 0; m < int(motions[std::size_t(i)].cols()); ++m) columns.push_back({i, m});
  const int mine = int(columns.size()), before = sumOfLower(comm, mine), all = sumOfAll(comm, mine);
  shareSlender(HZ_, CHZ_);
  PanelJumps jumps(*base_);
  RowPanel t(jumps.size());
  for (int first = 0; first < all; first += kColumnsOfZ) {
    t.clear();
    for (int own = std::max(first - before, 0); own < std::min(first + kColumnsOfZ - before, mine); ++own) {
      const auto& [i, m] = columns[std::size_t(own)];
      const auto motion = motions[std::size_t(i)].col(m);
      for (Eigen::Index k = 0; k < motion.size(); ++k) t.fill(jumps.first(std::size_t(i)) + std::size_t(k))[own + before - first] = motion[k];
    }
    averageMotions(jumps, t);
    const int width = std::min(kColumnsOfZ, all - first);
    appendHalves(width, jumps.piecesOf(t, width), HZ_, CHZ_);
  }
  const auto K = sumOfAll(comm, HZ_.gram(CHZ_));
  factor(0.5 * (K + K.transpose()));
}

// Y = B_D S Z on the rows given
Eigen::MatrixXd DeflatedPreconditioner::rowsOfBCZ(const std::vector<int>& rows) const {
  Eigen::MatrixXd Y(Eigen::Index(rows.size()), CHZ_.cols());
  PanelJumps jumps(*base_);
  RowPanel t(jumps.size());
  for (Eigen::Index first = 0; first < CHZ_.cols(); first += kColumnsOfZ) {
    const Eigen::Index width = std::min<Eigen::Index>(kColumnsOfZ, CHZ_.cols() - first);
    t.clear();
    CHZ_.copyTo(first, width, t);
    jumps.collect(t, rows, Y.middleCols(first, width));
  }
  return Y;
}

// Y_c by columns of C H Z, which are B_D (C H Z) where nothing is slender (H = 1).
DeflatedPreconditioner::Block DeflatedPreconditioner::contactBlock() const {
  const auto& comm = *getRangeMap()->getComm();
  const bool isSlender = std::any_of(L_.begin(), L_.end(), [](const Eigen::MatrixXd& L) { return L.size() > 0; });
  if (anyOfAll(comm, isSlender)) return {};
  const std::vector<int>& contact = base_->jump().multipliers().contactRows();
  const auto block = makeContactBlock(rowsOfBCZ(contact));
  const auto positions = [contact](std::vector<int> rows) {
    for (int& row : rows)
      if (row >= 0) row = int(std::lower_bound(contact.begin(), contact.end(), row) - contact.begin());
    return rows;
  };
  const auto ofGroups = [block, positions](std::vector<std::vector<int>> groups) {
    for (auto& rows : groups) rows = positions(std::move(rows));
    return block->ofGroups(groups);
  };
  const auto between = [block, positions](const std::vector<int>& rows) { return block->between(positions(rows)); };
  return {block, sumOfAll(comm, block->entriesRead()), ofGroups, between};
}

namespace {

// Columns of A without what is round-off of theirs; sizes: sums of magnitudes over all ranks.
Eigen::SparseMatrix<double> sparseColumns(const Eigen::MatrixXd& A, const std::vector<Eigen::Index>& columns, const Eigen::VectorXd& sizes) {
  constexpr double kNothing = 1e-16;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t j = 0; j < columns.size(); ++j)
    for (Eigen::Index i = 0; i < A.rows(); ++i)
      if (const double value = A(i, columns[j]); std::abs(value) > kNothing * sizes[columns[j]]) entries.emplace_back(int(i), int(j), value);
  Eigen::SparseMatrix<double> result(A.rows(), Eigen::Index(columns.size()));
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace

// With W W^T = Y K^+ Y^T, of as few columns as are needed: motions without contact have nothing in Y.  Between the others K^+ is C^T C, and
// with C = Q R they have W = Y R^T.
RCP<const DeflatedContactBlock> DeflatedPreconditioner::makeContactBlock(const Eigen::MatrixXd& Y) const {
  const Eigen::VectorXd sizes = sumOfAll(*getRangeMap()->getComm(), Eigen::VectorXd(Y.cwiseAbs().colwise().sum().transpose()));
  std::vector<Eigen::Index> touching;
  for (Eigen::Index j = 0; j < sizes.size(); ++j)
    if (sizes[j] > 0) touching.push_back(j);
  const Eigen::Index k = Eigen::Index(touching.size());
  if (k == 0) return Teuchos::rcp(new DeflatedContactBlock(base_, Eigen::MatrixXd(Y.rows(), 0)));
  const bool isQrUseless = k >= factor_->rank();
  if (isQrUseless && sumOfAll(*getRangeMap()->getComm(), int(Y.rows())) < k)
    return Teuchos::rcp(new DeflatedContactBlock(base_, Eigen::MatrixXd(factor_->solveHalf(scale_.asDiagonal() * Y.transpose()).transpose())));
  Eigen::MatrixXd units = Eigen::MatrixXd::Zero(scale_.size(), k);
  for (Eigen::Index j = 0; j < k; ++j) units(touching[std::size_t(j)], j) = scale_[touching[std::size_t(j)]];
  Eigen::MatrixXd C = factor_->solveHalf(units);
  if (isQrUseless) return Teuchos::rcp(new DeflatedContactBlock(base_, sparseColumns(Y, touching, sizes), std::move(C)));
  factorQrInPlace(C);
  const Eigen::MatrixXd R = C.topRows(k).triangularView<Eigen::Upper>();
  return Teuchos::rcp(new DeflatedContactBlock(base_, sparseColumns(Y, touching, sizes), R));
}

// Cholesky's factor with pivoting of K scaled to unit diagonal: K is singular, as averaged motions of neighbours contain each other.
void DeflatedPreconditioner::factor(const Eigen::MatrixXd& K) {
  scale_ = K.diagonal();
  const double largest = scale_.maxCoeff();
  for (double& value : scale_) value = value > 1e-28 * largest ? 1 / std::sqrt(value) : 0.0;
  factor_ = std::make_unique<PivotedCholesky>(scale_.asDiagonal() * K * scale_.asDiagonal(), kDependent);
}

// K^+ g, small pivots left out: motions that others contain
Eigen::MatrixXd DeflatedPreconditioner::solve(const Eigen::MatrixXd& g) const {
  return scale_.asDiagonal() * factor_->solve(scale_.asDiagonal() * g);
}

// t := t - A K^+ C^T t.  With A = H Z, C = C H Z this is H Pi H^-1, with the two exchanged its transpose.
void DeflatedPreconditioner::project(const SubdomainColumns& A, const SubdomainColumns& C, MultiVector& t) const {
  const auto g = sumOfAll(*getRangeMap()->getComm(), C.transposedTimes(columnsOf(t)));
  A.subtractProduct(solve(g), columnsOf(t));
}

// With X = H B_D^T e of the rows e and T = (1 - H Z K^+ (C H Z)^T) X it is T^T C T: subdomain by subdomain, of which only those near a row have
// an X.  X^T C T would do in exact numbers, and loses the digits of soft motions; so would (H Z)^T (C H Z) of a slender one.
Eigen::MatrixXd DeflatedPreconditioner::between(const std::vector<int>& rows) const {
  const auto& comm = *getRangeMap()->getComm();
  const int mine = int(rows.size()), before = sumOfLower(comm, mine), all = sumOfAll(comm, mine);
  SubdomainColumns X(boundaryUnknowns()), CX(boundaryUnknowns());
  shareSlender(X, CX);
  PanelJumps jumps(*base_);
  RowPanel t(jumps.size());
  for (int first = 0; first < all; first += kColumnsOfZ) {
    std::vector<std::array<int, 2>> units;
    for (int own = std::max(first - before, 0); own < std::min(first + kColumnsOfZ - before, mine); ++own)
      if (rows[std::size_t(own)] >= 0) units.push_back({rows[std::size_t(own)], own + before - first});
    t.clear();
    jumps.spread(units, t);
    const int width = std::min(kColumnsOfZ, all - first);
    appendHalves(width, jumps.piecesOf(t, width), X, CX);
  }
  const Eigen::MatrixXd a = solve(sumOfAll(comm, CHZ_.gram(X)));
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(all, all);
  for (std::size_t i = 0; i < std::size_t(base_->systems().size()); ++i) {
    if (isHalved(i)) addGram(HZ_.rest(i, X, a), M);
    else HZ_.addEnergy(i, CHZ_, X, CX, a, M);
  }
  return sumOfAll(comm, Eigen::MatrixXd(M.selfadjointView<Eigen::Lower>()));
}

// z = B_D H^T (1 - C H Z K^+ (H Z)^T) C (1 - H Z K^+ (C H Z)^T) H B_D^T x
void DeflatedPreconditioner::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const {
  MultiVector t(base_->jump().getDomainMap(), x.getNumVectors()), z(getRangeMap(), x.getNumVectors());
  base_->spread(x, t);
  toHalf(t);
  project(HZ_, CHZ_, t);
  applyRest(t);
  project(CHZ_, HZ_, t);
  fromHalf(t);
  base_->collect(t, z);
  y.update(alpha, z, beta);
  applications_ += long(x.getNumVectors());
}

}  // namespace Haptos
