// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_SpectralModes.hpp"

namespace Haptos {

/// \brief The unknowns that a subdomain shares with one it is glued to, in an order that both know.
struct SharedBoundary {
  int neighbour;              ///< global subdomain
  int rank;                   ///< of the neighbour
  std::vector<int> unknowns;  ///< places among the subdomain's boundary unknowns
};

/// \brief [local subdomains] ascending in the neighbour.  Collective.
std::vector<std::vector<SharedBoundary>> sharedBoundaries(const DualPreconditioner& M);

/// \brief What it costs to move copies of a subdomain's nodes apart: |P_D w|^2 in S of the subdomain and of its neighbours.
///
/// Each neighbour that it is glued to gives its own S between the unknowns that both have: near incompressibility no other matrix has
/// its digits (decisions/042).  For S of what it meets at closed contact, and of neighbours whose S is not made, its own stands, times the
/// ratio of the stiffness weights.
class NeighbourStiffness {
 public:
  /// \brief Collective.
  /// \param S [classes] on boundary unknowns, both triangles; empty where it is not made; kept by reference
  NeighbourStiffness(const DualPreconditioner& M, const std::vector<Eigen::MatrixXd>& S);

  /// \brief sum_j D_j S_j D_j on the boundary unknowns of a local subdomain whose S is made.
  Eigen::MatrixXd energy(int subdomain) const;

 private:
  struct Neighbour {
    int subdomain;           // global
    std::vector<int> unknowns;
    std::vector<double> shares;  // its v_j
    std::vector<double> lower;   // triangle of its S, column by column; of one of another rank
    std::vector<int> places;     // of the same unknowns among its own; of one of this rank
  };
  const Eigen::MatrixXd& stiffnessOf(int local) const;
  template <class Add>
  void forEntries(const Neighbour& neighbour, Add&& add) const;
  Eigen::MatrixXd weightsOfOthers(int subdomain, const Eigen::VectorXd& v) const;

  const DualPreconditioner& M_;
  const std::vector<Eigen::MatrixXd>& S_;
  std::vector<CopyWeights> weights_;             // [local subdomains]
  std::vector<std::vector<Neighbour>> glued_;    // [local subdomains] ascending
};

}  // namespace Haptos
