// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "Haptos_ElementGroup.hpp"

namespace Haptos {

/// \brief Loads as functions of the place x, y, z (in the user's units).
using VectorField = std::function<std::array<double, 3>(double, double, double)>;
using ScalarField = std::function<double(double, double, double)>;

/// \name Consistent nodal loads of one subdomain
///
/// All add into `f` [3 numNodes], entry `3 node + direction`, the integral of N_a times the load.
/// They throw InputError, naming the element and the place, where the field gives a value that is not finite.
///@{

/// \brief Force per volume on every element of `group`.
void addBodyForce(const Coordinates& coordinates, const ElementGroup& group, const VectorField& force,
                  Eigen::Ref<Eigen::VectorXd> f);

/// \brief Force per area, in global axes, on sides of `group`.
void addTraction(const Coordinates& coordinates, const ElementGroup& group,
                 const std::vector<GroupSide>& sides, const VectorField& traction,
                 Eigen::Ref<Eigen::VectorXd> f);

/// \brief Pressure on sides of `group`, along the inward normal of the side as it is meshed; positive pushes
/// into the body.
void addPressure(const Coordinates& coordinates, const ElementGroup& group,
                 const std::vector<GroupSide>& sides, const ScalarField& pressure,
                 Eigen::Ref<Eigen::VectorXd> f);
///@}

}  // namespace Haptos
