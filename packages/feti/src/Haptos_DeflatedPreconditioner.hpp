// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <array>
#include <functional>
#include <memory>
#include <optional>

#include "Haptos_DeflatedMotions.hpp"
#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_DualPreconditioner.hpp"
#include "Haptos_SubdomainColumns.hpp"

namespace Haptos {

class DeflatedContactBlock;
class PanelJumps;

/// \brief M_Z = B_D Pi^T S Pi B_D^T, Pi = I - Z K^+ Z^T S, K = Z^T S Z: the Dirichlet preconditioner for slender subdomains and hard elements.
///
/// M x is the force of the displacement B_D^T x, whose jump is x; M_Z x that of B_D^T x + Z a, a such that the energy is
/// least.  Z holds the rigid motions of every subdomain, the soft ones of slender ones (`SoftSpectrum`) and those that cutting makes stiff of
/// others (`SpectralModes`), averaged over the copies of a node
/// and across closed contact, so that B Z = 0.  With all continuous motions in Z, M_Z would be the inverse of F.  Since
/// Z holds the rigid motions, G M_Z = 0.
///
/// Slender subdomains take S = L^T L, and Pi acts between L and L^T.  K is kept as one dense factor on every rank.
/// Every column of Z costs an application of M once.
class DeflatedPreconditioner final : public Operator {
 public:
  using Spectra = DeflatedMotions::Spectra;

  /// \brief Null where rigid motions alone are more than Z may have, or spectral modes more than are wanted.  Collective.
  ///
  /// \param slender [local subdomains] those whose soft motions are looked for; `base` must have their S in double
  /// precision, since soft motions live in its last digits.
  static RCP<const DeflatedPreconditioner> make(const RCP<const DualPreconditioner>& base, const std::vector<char>& slender,
                                                const Spectra& spectra);

  /// \brief Of motions that are given, beside the rigid ones; nothing is slender.  Null where there are too many.  Collective.
  ///
  /// \param soft [classes] on the boundary, [unknowns x any], independent of rigid motions
  static RCP<const DeflatedPreconditioner> make(const RCP<const DualPreconditioner>& base, const std::vector<Eigen::MatrixXd>& soft);

  RCP<const Map> getDomainMap() const override { return base_->getDomainMap(); }
  RCP<const Map> getRangeMap() const override { return base_->getRangeMap(); }
  bool hasTransposeApply() const override { return true; }
  /// Pi is applied on both sides, so that round-off in K leaves M_Z semidefinite.  Collective: as M, and two reductions.
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1.0,
             double beta = 0.0) const override;

  struct Block {
    RCP<const Operator> M;
    double entriesRead = 0;  ///< of matrices, in a product, over all ranks
    /// As `DeflatedContactBlock::ofGroups`, by owned rows.  Collective.
    std::function<std::vector<Eigen::MatrixXd>(const std::vector<std::vector<int>>& rows)> ofGroups{};
    std::function<Eigen::MatrixXd(const std::vector<int>& rows)> between{};  ///< as `DeflatedPreconditioner::between`, far cheaper
  };
  /// \brief M_Z between contact rows, on `MultiplierMap::contactMap`, as M_cc - Y_c K^+ Y_c^T with Y = B_D S Z: far cheaper than M_Z.
  ///
  /// Null where subdomains are slender on any rank: the difference would lose the digits of their soft motions.  Collective.
  Block contactBlock() const;

  /// \brief M_Z between rows of all ranks, as a Gram matrix, which keeps it semidefinite; far cheaper than by columns of M_Z.
  ///
  /// \param rows owned rows of this rank, -1: none, with a row and column of zeros.
  /// \return [all rows given x all rows given], rank after rank, the same on all ranks.  Collective.
  Eigen::MatrixXd between(const std::vector<int>& rows) const;

  const DualPreconditioner& base() const { return *base_; }
  int numCoarse() const { return int(scale_.size()); }  ///< columns of Z, over all ranks
  long applications() const { return applications_; }

 private:
  explicit DeflatedPreconditioner(RCP<const DualPreconditioner> base);
  static RCP<const DeflatedPreconditioner> make(const RCP<const DualPreconditioner>& base, std::optional<DeflatedMotions> motions, long most);
  void toHalf(MultiVector& t) const;
  void fromHalf(MultiVector& t) const;
  void averageMotions(PanelJumps& jumps, RowPanel& t) const;
  void applyRest(MultiVector& t) const;
  template <class Local>
  void onSubdomains(MultiVector& t, Local&& local) const;
  void assemble(const std::vector<Eigen::MatrixXd>& motions);
  Eigen::MatrixXd rowsOfBCZ(const std::vector<int>& rows) const;
  RCP<const DeflatedContactBlock> makeContactBlock(const Eigen::MatrixXd& Y) const;
  void factor(const Eigen::MatrixXd& K);
  void project(const SubdomainColumns& A, const SubdomainColumns& C, MultiVector& t) const;
  void appendHalves(int width, std::vector<SubdomainColumns::Piece> pieces, SubdomainColumns& half, SubdomainColumns& rest) const;
  Eigen::MatrixXd timesS(int congruenceClass, const SubdomainColumns::Piece& t) const;
  std::vector<std::vector<Eigen::Index>> boundaryUnknowns() const;
  void shareSlender(const SubdomainColumns& half, SubdomainColumns& rest) const;
  bool isHalved(std::size_t subdomain) const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& g) const;

  RCP<const DualPreconditioner> base_;
  // S_i = H_i^T C_i H_i: H = L and C = 1 in slender subdomains, H = 1 and C = S in others.
  std::vector<Eigen::MatrixXd> L_;  // [classes] empty where subdomains are not slender
  std::vector<Eigen::MatrixXd> S_;  // [classes] while K is made; empty, or of those whose spectra are looked for
  SubdomainColumns HZ_, CHZ_;       // [local primal x coarse]
  mutable long applications_ = 0;
  Eigen::VectorXd scale_;   // [coarse] 1 / sqrt(diag K)
  std::unique_ptr<const PivotedCholesky> factor_;  // of K scaled to unit diagonal
};

}  // namespace Haptos
