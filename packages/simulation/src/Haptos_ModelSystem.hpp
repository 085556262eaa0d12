// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_ContactSystem.hpp"
#include "Haptos_DistributedModel.hpp"

namespace Haptos {

/// \brief A model of elements as a ContactSystem takes it.  `model` must outlive what is returned.  Collective.
SystemModel systemModelOf(const DistributedModel& model, std::int64_t numMeshNodes);

/// \brief Loads and right-hand sides of a model.  Collective.
/// \throws InputError on all ranks for a load that cannot be evaluated
StepData firstStep(const DistributedModel& model, const FetiSystem& system);

}  // namespace Haptos
