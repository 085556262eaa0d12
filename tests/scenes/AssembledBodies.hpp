// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

#include "Haptos_LinearElasticity.hpp"
#include "Haptos_Mesh.hpp"

namespace Haptos::Scenes {

/// \brief u_component(node) = value.
struct HeldComponent {
  std::int64_t node;
  int component;
  double value;
};

/// \brief Whole bodies, not torn: one stiffness matrix over the free degrees of freedom, K_ff u_f = f_f - K_fp u_p.
///
/// A body that the held components leave free keeps those rigid motions: they span R (orthonormal columns),
/// K_ff R = 0, and `solve` is the pseudo-inverse of K_ff.
class AssembledBodies {
 public:
  /// \param materialOfBlock [blocks] position in materials
  AssembledBodies(const Mesh& mesh, const std::vector<IsotropicMaterial>& materials,
                  const std::vector<int>& materialOfBlock, Formulation formulation,
                  const std::vector<HeldComponent>& held);

  Eigen::Index numFree() const { return Eigen::Index(free_.size()); }
  const std::vector<int>& position() const { return position_; }  ///< [3 nodes] among the free ones, or -1
  const Eigen::VectorXd& held() const { return held_; }           ///< [3 nodes] held values, 0 elsewhere
  const Eigen::MatrixXd& R() const { return R_; }                 ///< [free x rigid motions]

  /// \brief f_f - K_fp u_p for a load vector [3 nodes].
  Eigen::VectorXd reduce(const Eigen::VectorXd& load) const;
  /// \brief K^+ of every column, without refinement.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  /// \brief K^+ f with residuals in long double.
  Eigen::VectorXd solveRefined(const Eigen::VectorXd& right) const;
  /// \brief f - K_ff u, summed in long double.
  Eigen::VectorXd residual(const Eigen::VectorXd& right, const Eigen::VectorXd& u) const;
  /// \brief || |K_ff| |u| ||: round-off of the residual is eps times this.
  double roundOffScale(const Eigen::VectorXd& u) const;
  /// \brief All displacements [3 nodes] of free ones.
  Eigen::VectorXd expand(const Eigen::VectorXd& u) const;
  /// \brief K u over all degrees of freedom [3 nodes].
  Eigen::VectorXd forces(const Eigen::VectorXd& u) const { return all_ * u; }

 private:
  using Sparse = Eigen::SparseMatrix<double>;
  void numberFree(const std::vector<HeldComponent>& held);
  void findRigidMotions(const Mesh& mesh);
  void factor();

  Sparse all_, K_;
  std::vector<int> position_, free_;
  std::vector<char> keep_;        // [free] 0: fixed for the factor of a floating body
  std::vector<int> kept_;
  Eigen::VectorXd held_;
  Eigen::MatrixXd R_;
  Eigen::SimplicialLDLT<Sparse> factor_;
};

/// \brief Body of every node by elements that share nodes; -1 for a node without elements.
std::vector<int> bodiesOfNodes(const Mesh& mesh, int& count);

}  // namespace Haptos::Scenes
