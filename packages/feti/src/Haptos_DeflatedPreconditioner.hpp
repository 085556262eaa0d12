// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <array>
#include <functional>
#include <limits>
#include <memory>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_DualPreconditioner.hpp"
#include "Haptos_SoftModes.hpp"
#include "Haptos_SpectralModes.hpp"
#include "Haptos_SubdomainColumns.hpp"

namespace Haptos {

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
  static constexpr long kLargest = 5000;  ///< columns of Z
  /// Unknowns of a subdomain's boundary up to which its spectral modes are had for as much as some tens of iterations, and up to which its
  /// dense matrices are made at all, and slender ones have soft motions: an eigenproblem takes 2 s at 2600 of them (decisions/016, 042).
  static constexpr int kUsualSpectrum = 1000, kLargestSpectrum = 5000;
  static constexpr long kMostRigid = 2000;  ///< columns that are rigid motions, for spectral modes to come beside them

  /// \brief Which spectral modes are looked for: by default as many as are likely to pay for themselves.
  struct Spectra {
    int largestBoundary = kUsualSpectrum;  ///< in subdomains with so many unknowns that rows touch, or fewer
    long most = 2000;                      ///< of all subdomains, the stiffest ones
    /// If that leaves out stiffer ones there are none: what is left is as bad as S of a capped Poisson's ratio, which is cheap (decisions/050).
    double stiffestLeft = 8;
    long columns = kLargest;  ///< of Z; where there are more soft motions than that, the softest are taken
    /// \brief As many as Z can have, however stiff those are that it cannot: where nothing else leads to an answer.
    static Spectra atAnyPrice() { return {kLargestSpectrum, kLargest, std::numeric_limits<double>::infinity()}; }
  };

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
  bool findMotions(const std::vector<char>& slender, const Spectra& spectra);
  long numMotions() const;
  Eigen::MatrixXd rigidMotions(int subdomain) const;
  Eigen::MatrixXd denseOf(int congruenceClass) const;
  std::vector<SpectralModes> findSpectralModes(const std::vector<Eigen::MatrixXd>& S, const Spectra& wanted) const;
  void takeSoftModes(const std::vector<SoftSpectrum>& soft, long columns);
  bool takeSpectralModes(const std::vector<SpectralModes>& spectral, const Spectra& wanted);
  double boundThatLeaves(long most, double bound, const std::function<long(double)>& countMine) const;
  void toHalf(MultiVector& t) const;
  void fromHalf(MultiVector& t) const;
  void averageMotions(PanelJumps& jumps, RowPanel& t) const;
  void applyRest(MultiVector& t) const;
  template <class Local>
  void onSubdomains(MultiVector& t, Local&& local) const;
  void assemble();
  Eigen::MatrixXd rowsOfBCZ(const std::vector<int>& rows) const;
  Eigen::MatrixXd rootOfDeflation(const Eigen::MatrixXd& Y) const;
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
  std::vector<Eigen::MatrixXd> motions_;  // [local subdomains] on the boundary
  std::vector<Eigen::MatrixXd> L_;        // [classes] empty where subdomains are not slender
  std::vector<Eigen::MatrixXd> S_;        // [classes] while K is made; empty, or of those whose spectra are looked for
  SubdomainColumns HZ_, CHZ_;             // [local primal x coarse]
  mutable long applications_ = 0;
  Eigen::VectorXd scale_;   // [coarse] 1 / sqrt(diag K)
  std::unique_ptr<const PivotedCholesky> factor_;  // of K scaled to unit diagonal
};

}  // namespace Haptos
