// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "Haptos_ContactKrylov.hpp"
#include "Haptos_ContactOperators.hpp"
#include "Haptos_DualVectors.hpp"

namespace Haptos {

/// \brief Systems with M between contact rows where M + D can be factored for any D (`ExactContactMap`).
///
/// All vectors are this rank's contact values [3 pairs].
class ExactContact {
 public:
  using Blocks = std::vector<Eigen::Matrix3d>;  ///< [pairs]
  using Map = ExactContactMap::Map;

  /// \param vectors kept by reference \param diagonal [3 pairs] about M's, > 0
  ExactContact(ExactContactMap M, const DualVectors& vectors, Eigen::VectorXd diagonal)
      : M_(std::move(M)), vectors_(vectors), diagonal_(std::move(diagonal)) {}

  Eigen::VectorXd multiply(const Eigen::VectorXd& x) const { return M_.multiply(x); }  ///< M x.  Collective
  /// \brief M x without a product where x is what was solved last; else null, the same on all ranks.  Collective.
  const Eigen::VectorXd* productOfLast(const Eigen::VectorXd& x) const;

  /// \brief b -> d with (M + K) d = b, K symmetric and positive semidefinite; NaN where there is none.  Collective, as is what it returns.
  Map solverWith(const Blocks& K) const;
  /// \brief The same with something more on all rows, for K that leaves motions free.
  Map solverNear(const Blocks& K) const;

  /// \brief A preconditioner for (A M + B) d = b, and products that know what it returned last.  Collective.
  void prepare(ContactEquations& equations, const Blocks& A, const Blocks& B) const;

 private:
  struct Product {
    Eigen::VectorXd x, Mx;
  };
  ExactContactMap M_;
  const DualVectors& vectors_;
  Eigen::VectorXd diagonal_;
  mutable Product last_;
};

}  // namespace Haptos
