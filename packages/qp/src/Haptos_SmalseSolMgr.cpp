// SPDX-License-Identifier: BSD-3-Clause
#include <Teuchos_VerboseObject.hpp>

#include "Haptos_BelosRegistration.hpp"
#include "Haptos_OptionTable.hpp"
#include "Haptos_SmalseSolMgr_def.hpp"

namespace Haptos {

const OptionTable<SmalseSolMgrOptions>& SmalseSolMgrOptions::table() {
  using O = SmalseSolMgrOptions;
  static const auto table =
      OptionTable<O>(SmalseOptions::table())
          .add("Convergence Tolerance", &O::tolerance, NumberRange::atLeast(0), "What the dimensionless residual is compared with")
          .add("Maximum Iterations", &O::maximumIterations, NumberRange::atLeast(1), "Limit of outer steps of one call of solve()")
          .addFrom(SolverOptions::table(), "Maximum Hessian Multiplications", &O::maximumMultiplications)
          .add("Norm Applications", &O::normApplications, NumberRange::atLeast(1),
               "Limit of the multiplications spent on the estimate of ||A||")
          .add("Stagnation Steps", &O::stagnationSteps, NumberRange::atLeast(1),
               "Outer steps without a gain of 10 % in the residual that end the iteration; after a third of them the published inner "
               "test is used alone");
  return table;
}

namespace Details {

constexpr const char* kName = "Haptos SMALSE";

SmalseSolMgrOptions readSmalseParameters(Teuchos::ParameterList& list) {
  if (list.isType<std::string>("Expansion") && list.get<std::string>("Expansion") == "Fixed") {
    list.set("Expansion", std::string(nameOf(Expansion::FixedStep)));
    *Teuchos::VerboseObjectBase::getDefaultOStream() << "warning: " << kName << "->Expansion: Fixed is outdated; write '"
                                                     << nameOf(Expansion::FixedStep) << "'" << std::endl;
  }
  return readManagerParameters<SmalseSolMgrOptions>(
      list, kName, {{"M0", "M Factor"}, {"Eta0", "Eta Factor"}, {"Alpha Factor", "Step Length"}});
}

Teuchos::ParameterList smalseParameters(const SmalseSolMgrOptions& options) { return listOf(options, kName); }

}  // namespace Details

void registerSmalseSolMgr() { registerWithBelos<SmalseSolMgr<double, MultiVector, Operator>>(Details::kName); }

template class SmalseSolMgr<double, MultiVector, Operator>;

}  // namespace Haptos
