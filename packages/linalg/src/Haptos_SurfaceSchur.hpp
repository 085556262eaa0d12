// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "Haptos_LocalSolverFactor.hpp"
#include "Haptos_NodeBlockMatrix.hpp"

namespace Haptos {

/// \brief Schur complement of one subdomain's stiffness on its boundary unknowns b, with interior i the rest.
///
///   S = K_bb - K_bi K_ii^+ K_ib
///
/// symmetric positive semidefinite, nb x nb, in the order of the list given.  A boundary that does not hold the
/// interior (a kernel vector of K that vanishes on b) leaves K_ii singular; S exists all the same, and K_ii is
/// then regularised as a floating subdomain is.  Nothing communicates.
///
/// In single precision, which is enough for a preconditioner, it takes less than half the memory and time; entries and vectors
/// are scaled, so that the range does not depend on the units. A boundary that does not consist of whole nodes, three unknowns
/// in a row each, stays in double precision.
///
/// Use: the Dirichlet preconditioner of FETI, Farhat, Mandel, Roux, Comput. Methods Appl. Mech. Engng. 115 (1994) 365.
class SurfaceSchur {
 public:
  /// \param K        n x n, symmetric positive semidefinite, both triangles stored.
  /// \param kernel   n x k, orthonormal columns spanning the kernel of K.
  /// \param boundary local unknowns 0..n-1, without repetition, in any order; all or none may be listed.
  /// \throws InputError if CHOLMOD is asked for and not built in.
  /// \throws std::runtime_error if K_ii does not factor.
  SurfaceSchur(const Eigen::SparseMatrix<double>& K, const Eigen::MatrixXd& kernel, const std::vector<int>& boundary,
             LocalSolverMethod method = LocalSolverMethod::Automatic, FactorPrecision precision = FactorPrecision::Double);
  /// \brief K_bb in the place of S: the lumped preconditioner's, an upper bound of it.
  static SurfaceSchur lumped(const Eigen::SparseMatrix<double>& K, const std::vector<int>& boundary, FactorPrecision precision);
  ~SurfaceSchur();
  SurfaceSchur(SurfaceSchur&&) noexcept;

  Eigen::Index size() const;  ///< nb

  /// Y := S X, both nb x m, by one solve with K_ii.  X and Y must not overlap.
  void apply(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> Y) const;

  /// S(c, c), exactly symmetric, `c` positions in the boundary list; costs half a solve with K_ii for each of them, a whole one without a supernodal factor.
  Eigen::MatrixXd block(const std::vector<int>& c) const;

  /// S itself, nb x nb, exactly symmetric: the block of all.
  Eigen::MatrixXd dense() const;

  /// \brief Of the factor of K_ii; bytes: of one `apply`.
  FactorWork work() const { return interior_ ? interior_->work() : FactorWork{}; }

  Eigen::Index interiorKernelSize() const;  ///< dimension of the kernel of K_ii; 0 unless b does not hold i

 private:
  struct Parts {
    Eigen::SparseMatrix<double> Kbb, Kib;
  };
  struct NodeParts {
    NodeBlockMatrix Kbb, Kib;
  };
  SurfaceSchur() = default;
  void keep(const Eigen::SparseMatrix<double>& K, const std::vector<int>& boundary, const std::vector<int>& interior,
            FactorPrecision precision);
  void keepByNodes(const Eigen::SparseMatrix<double>& K, const std::vector<int>& boundary, const std::vector<int>& interior);
  void applyDouble(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> Y) const;
  void applySingle(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> Y) const;
  Parts columns(const std::vector<int>& c) const;  ///< [nb x c] and [interior x c]

  Parts double_;      // one of the two; the other is empty
  NodeParts single_;
  bool isSingle_ = false;
  double scale_ = 1;  // of the single precision entries
  Eigen::Index size_ = 0;
  Eigen::Index interiorKernelSize_ = 0;
  std::unique_ptr<LocalSolverFactor> interior_;  // null without interior unknowns
};

}  // namespace Haptos
