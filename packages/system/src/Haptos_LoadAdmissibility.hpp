// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_BodyMotions.hpp"
#include "Haptos_ContactLaw.hpp"
#include "Haptos_NaturalCoarseSpace.hpp"

namespace Haptos {

/// \brief Asks whether contact and friction can carry the loads at all: { l in Omega : G l = e } is not empty.
///
/// For rigid bodies: are there contact forces in their (convex) friction cones that balance the resultants of
/// all floating motions?  The distance between the two is minimised by Newton's method in
/// the dual, whose unknowns are the rigid motions; where it stays positive, the motion found is the one that
/// the loads drive against everything that contact can do.  Cost: a few sweeps over the pairs.  Collective.
/// \param floating motions that equality rows do not feel, \param e R^T f [l], \param loadScale size of the loads [force]
/// \throws InsufficientModel on all ranks, naming the body and the motion.
void requireAdmissibleLoads(const ContactLaw& law, const UnheldMotions& floating, const NaturalCoarseSpace& G,
                            const Eigen::VectorXd& e, const BodyMotions& bodies, double loadScale);

}  // namespace Haptos
