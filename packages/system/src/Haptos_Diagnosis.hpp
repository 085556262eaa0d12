// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "Haptos_ContactSolver.hpp"
#include "Haptos_SystemModel.hpp"

namespace Haptos {

/// \brief A run whose kkt is above the tolerance.
struct UnconvergedRun {
  const FetiSystem& system;
  const Accuracy& accuracy;
  const ContactSolver& solver;
  const Vector& u;                            ///< primal map
  bool passed;                                ///< the method's own test
  const SystemOptions& options;
};

/// \brief Why the method ended, the measure of the KKT system that is worst, where that is, and what helps.  Collective.
std::string explainUnconverged(const UnconvergedRun& run);

}  // namespace Haptos
