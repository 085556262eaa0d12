// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "Haptos_ContactCoarse.hpp"
#include "Haptos_ContactFactor.hpp"
#include "Haptos_ContactKrylov.hpp"
#include "Haptos_DualVectors.hpp"
#include "Haptos_ExactContact.hpp"
#include "Haptos_SchwarzPreconditioner.hpp"
#include "Haptos_SubspaceNewtonOptions.hpp"

namespace Haptos {

/// \brief M between contact rows as the condensed contact problem needs it: products, and solves with something of each pair added.
///
/// All vectors are this rank's contact values [3 pairs].
class ContactMatrix {
 public:
  using Blocks = std::vector<Eigen::Matrix3d>;  ///< [pairs]

  /// Dense: 3 x pairs applications of M now, the matrix on all ranks, direct solves: where M is slow, and so badly scaled that Krylov
  /// methods fail (slender subdomains).  Products: Krylov methods, preconditioned by pairs, then by groups of them, then with coarse jumps beside
  /// these; each comes where the one before fails or takes longer, and the dense matrix where all fail, or rows are few.  Neither where there is an exact map.
  enum class Kind { Dense, Products };

  struct Parts {
    RCP<const Operator> M;     ///< between contact rows
    Eigen::VectorXd diagonal;  ///< [3 pairs] about M's, what is 0 counts as 1
    std::function<Eigen::MatrixXd()> dense{};  ///< makes the matrix of all ranks' contact values, the same on all.  Collective.  Empty: by columns.
    Eigen::MatrixXd kernel{};  ///< [3 pairs x k] independent; M does not feel them: motions of floating bodies.  Maybe empty.
    std::function<Eigen::MatrixXd()> smooth{};  ///< makes jumps for a coarse space [3 pairs x any].  Collective.  Empty: there are none.
    double entriesRead = 0;                     ///< of matrices, in a product by M, over all ranks; 0: as many as of a dense one
    std::function<std::vector<PairGroup>()> groups{};  ///< makes groups of pairs that overlap.  Collective.  Empty: there are none.
    /// About M of each group by itself, of all ranks' values, rank after rank: where the matrix is not made.  Collective.
    std::function<std::vector<Eigen::MatrixXd>(const std::vector<PairGroup>&)> ofGroups{};
    ExactContactMap exact{};  ///< where it is there: all products and solves by it
  };
  /// Collective.
  ContactMatrix(Parts parts, const DualVectors& vectors, Kind kind, const SubspaceNewtonOptions::Condensed& options);
  ContactMatrix(const ContactMatrix&) = delete;  // factors refer to it
  ContactMatrix& operator=(const ContactMatrix&) = delete;

  /// \brief M := factor M.  Factors and coarse spaces are made anew where they are needed.
  void scale(double factor);
  double scaling() const { return scaling_; }  ///< of what it was made from

  Eigen::VectorXd multiply(const Eigen::VectorXd& x) const;  ///< Collective

  /// \brief (A M + B) d = b, to a relative tolerance.  Collective.
  Eigen::VectorXd solve(const Blocks& A, const Blocks& B, const Eigen::VectorXd& b, double tolerance) const;
  /// \brief Whether the last factor that solved one was of at most half of the rows.
  bool wasSmall() const { return last_ && 2 * last_->numFactored() <= numbering_.size(); }
  /// \brief (M + K) d = b for one b after the other, K symmetric and positive semidefinite.
  class Symmetric {
   public:
    Symmetric(const ContactMatrix& M, Blocks K) : M_(M), K_(std::move(K)) {}
    Eigen::VectorXd solve(const Eigen::VectorXd& b);  ///< Collective

   private:
    using Map = ExactContact::Map;
    Eigen::VectorXd solveAny(const Eigen::VectorXd& b);
    Eigen::VectorXd solveExactly(const Eigen::VectorXd& b);

    const ContactMatrix& M_;
    Blocks K_;
    std::unique_ptr<const ContactFactor> factor_;   // where M is dense
    Map exact_;                                     // where it is exact
    std::optional<ContactEquations> equations_;     // where it is not
    std::pair<bool, bool> helped_{};                // by symmetric groups, by coarse jumps
  };

  /// \brief 1 / (normal compliance of the pair, the other pairs open): as far as a pair feels a stiffness, it is this one; 0 where
  /// none is felt.  Dense only.
  Eigen::VectorXd normalStiffness() const;

  /// \brief The part of x [3 pairs] that the kernel spans, of least distance.  Collective.
  Eigen::VectorXd kernelPart(const Eigen::VectorXd& x) const;
  bool hasCoarse() const { return coarse_ && !isDirect_; }  ///< Krylov methods by a coarse space solve systems
  bool hasKernel() const { return kernel_.cols() > 0; }

  const DualVectors& vectors() const { return vectors_; }

 private:
  Eigen::VectorXd solveAny(const Blocks& A, const Blocks& B, const Eigen::MatrixXd& free, const Eigen::VectorXd& b, double tolerance) const;
  Eigen::VectorXd withoutFree(const Eigen::MatrixXd& free, Eigen::VectorXd d) const;
  Eigen::MatrixXd freeMotions(const Blocks& B) const;
  Eigen::VectorXd consistentPart(const Blocks& A, const Blocks& B, const Eigen::MatrixXd& N, const Eigen::VectorXd& b) const;
  Eigen::VectorXd partIn(const Eigen::MatrixXd& motions, const Eigen::VectorXd& x) const;
  void makeDirect() const;
  void makeDense() const;
  void makeDenseForProducts() const;
  void makeGroups() const;
  void keepDense(const Eigen::MatrixXd& matrix) const;
  Eigen::MatrixXd multiplyMany(const Eigen::MatrixXd& X) const;
  void makeCoarse() const;
  void keepCoarse(ContactCoarse coarse) const;
  Eigen::MatrixXd multiplyColumns(Eigen::Index count, const std::function<Eigen::MatrixXd(Eigen::Index, Eigen::Index)>& columns) const;
  Eigen::MatrixXd byColumns() const;
  enum class Method { Gmres, Cg };
  bool mayStay(const ContactEquations::Solution& solution, Method method) const;
  bool makeMore(bool isConverged, Method method) const;
  bool areGroupsCheaper(double steps) const;
  bool makeSymmetricGroups(double steps) const;
  double entriesOfProduct() const;
  std::pair<bool, bool> helpers() const { return {symmetricGroups_ != nullptr, coarse_ != nullptr}; }
  Eigen::MatrixXd onAllRanks(const Eigen::MatrixXd& mine) const { return numbering_.onAllRanks(mine); }
  using Shape = ContactFactor::Shape;
  std::optional<Eigen::VectorXd> solveByLast(ContactEquations equations, const Eigen::MatrixXd& blocks, const Eigen::VectorXd& b) const;
  std::optional<Eigen::VectorXd> solveDirectly(const Eigen::MatrixXd& blocks, const Eigen::VectorXd& b) const;
  std::unique_ptr<const ContactFactor> factorByForces(const Eigen::MatrixXd& blocks) const;
  void makeCompliance() const;
  ContactEquations symmetricEquations(const Blocks& K) const;
  ContactEquations generalEquations(const Blocks& A, const Blocks& B, double tolerance) const;
  double stepsOfRenewal() const;
  Eigen::VectorXd solveExactly(const Blocks& A, const Blocks& B, const Eigen::VectorXd& b, double tolerance) const;
  ContactEquations::Solution solveByGroups(const Blocks& A, const Blocks& B, const Eigen::VectorXd& b, double tolerance) const;

  RCP<const Operator> M_;  // times scaling_
  double scaling_ = 1;
  std::function<Eigen::MatrixXd()> makeWhole_, makeSmooth_;
  std::function<std::vector<PairGroup>()> findGroups_;
  std::function<std::vector<Eigen::MatrixXd>(const std::vector<PairGroup>&)> ofGroups_;
  const DualVectors& vectors_;
  ContactNumbering numbering_;
  Eigen::VectorXd diagonal_;
  Eigen::MatrixXd kernel_;
  std::optional<ExactContact> exact_;  // times scaling_
  Kind kind_;
  SubspaceNewtonOptions::Condensed options_;
  double entriesRead_ = 0;             // in a product of M
  double productsOfFactor_ = 0;        // that a factorisation of the dense matrix is worth
  bool isCheaperDense_ = false;        // for products: half of it is less than what they read of M
  mutable Eigen::MatrixXd dense_;      // [all contact values]^2, or empty
  mutable bool isDirect_ = false;      // systems are solved by factors of dense_
  mutable Eigen::MatrixXd wholeKernel_;  // beside dense_: orthonormal, of all ranks
  mutable Eigen::MatrixXd compliance_;   // M^+ beside dense_, empty until it is asked for
  mutable bool isCompliant_ = true;      // it solves what it is used for
  mutable std::unique_ptr<const ContactFactor> last_;  // of a general system
  mutable std::unique_ptr<SchwarzPreconditioner> groups_;         // null until Krylov methods take long without them
  mutable std::unique_ptr<SchwarzPreconditioner> symmetricGroups_;  // the same for symmetric systems
  mutable std::unique_ptr<const ContactCoarse> coarse_;           // null until Krylov methods fail without it
  mutable std::unique_ptr<TwoLevelPreconditioner> twoLevel_;       // beside it, of the last general system
  mutable bool isCoarseReady_ = false;                             // for some law, M as it is
  mutable int freshSteps_ = 0;                                     // of GMRES, for the law that it was made for
  mutable double moreSteps_ = 0;                                   // of all others since then
  mutable int numLost_ = 0;                                        // solves in a row that failed with it
  mutable long products_ = 0, solves_ = 0;  // by Krylov methods
};

}  // namespace Haptos
