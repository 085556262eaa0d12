// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/SparseCore>
#include <vector>

#include "Haptos_LinearElasticity.hpp"
#include "Haptos_PartShape.hpp"

namespace Haptos {

/// \brief Stiffness matrix K of one subdomain, [3 numNodes x 3 numNodes], degree of freedom `3 node +
/// direction`.
///
/// Both triangles are stored, compressed by columns with ascending rows; K equals its transpose to the
/// last digit.  A node without elements leaves empty columns.  The order of summation is that of the
/// groups and of their elements, so congruent subdomains numbered alike get the same matrix.
///
/// \throws InputError for a bad element or material (see `elementGradients`, `elasticModuli`), or if K has
///   more entries than 32-bit indices can count.
Eigen::SparseMatrix<double> assembleStiffness(const Coordinates& coordinates,
                                              const std::vector<ElementGroup>& groups,
                                              const std::vector<IsotropicMaterial>& materials,
                                              Formulation formulation);

/// \brief Ku := K u without K, by the stress in every element; an independent check of the above.
///
/// \param u, Ku [3 numNodes]; they must not overlap.
/// \throws InputError as `assembleStiffness`.
void applyStiffness(const Coordinates& coordinates, const std::vector<ElementGroup>& groups,
                    const std::vector<IsotropicMaterial>& materials, Formulation formulation,
                    const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::Ref<Eigen::VectorXd> Ku);

/// \brief Stiffness weight of the nodes [numNodes], force per length: sum over the elements of E int |grad N_a|^2, what the diagonal of K
/// has at a node but for Poisson's ratio and directions.
///
/// \param youngsModulus [materials]
/// \param volume if given, that of all elements is added; moments as of boxes and tetrahedra with these corners
/// \throws InputError for a bad element (see `elementGradients`).
std::vector<double> nodalStiffness(const Coordinates& coordinates, const std::vector<ElementGroup>& groups,
                                   const std::vector<double>& youngsModulus, PartVolume* volume = nullptr);

}  // namespace Haptos
