// SPDX-License-Identifier: BSD-3-Clause
#include <BelosSolverFactory_Tpetra.hpp>
#include <sstream>

#include "Haptos_SmalseSolMgr_def.hpp"

namespace Haptos {
namespace Details {
namespace {

RCP<const Teuchos::ParameterList> makeSmalseParameters() {
  auto p = Teuchos::rcp(new Teuchos::ParameterList("Haptos SMALSE"));
  p->set("Convergence Tolerance", 1e-6, "What the dimensionless residual is compared with.");
  p->set("Maximum Iterations", 1000, "Limit of outer steps of one call of solve().");
  p->set("Maximum Hessian Multiplications", 5000, "Limit over all calls of solve(), norm estimate included.");
  p->set("Norm Applications", 10, "Limit of the multiplications spent on the estimate of ||A||.");
  p->set("Gamma", 1.0, "Gamma > 0 of the proportionality test.");
  p->set("Alpha Factor", 1.9, "Fixed steplength times ||H||, in (0, 2].");
  p->set("Expansion", std::string("Automatic"), "Fixed | Projected CG | Automatic.");
  p->set("Rho Factor", 1.0, "Penalty rho / ||A||, > 0.");
  p->set("M0", 1.0, "First M / rho of the inner test ||g^P|| <= min(M ||Q (x - x0)||, eta), > 0.");
  p->set("M Floor", 0.1, "Least M / rho, >= 0.");
  p->set("Beta", 10.0, "M is divided by this where the Lagrangian grew too little, > 1.");
  p->set("Eta0", 0.1, "eta / ||b||, > 0.");
  p->set("Inner Reduction", 0.5,
         "An inner loop may also end once it reduced ||g^P|| to this fraction of its start, in [0, 1); 0: never. "
         "Not used any more after a third of the Stagnation Steps without gain.");
  p->set("Stagnation Steps", 50, "Outer steps without a gain of 10 % in the residual that end the iteration.");
  return p;
}

struct Rule {
  const char* name;
  double low, high;
  const char* text;
};

}  // namespace

RCP<const Teuchos::ParameterList> smalseParameters() {
  static const RCP<const Teuchos::ParameterList> parameters = makeSmalseParameters();
  return parameters;
}

void checkSmalseParameters(const Teuchos::ParameterList& p) {
  const double tiny = std::numeric_limits<double>::min(), huge = std::numeric_limits<double>::max();
  const Rule rules[] = {{"Convergence Tolerance", 0, huge, ">= 0"}, {"Gamma", tiny, huge, "> 0"},
                        {"Alpha Factor", tiny, 2, "in (0, 2]"},     {"Rho Factor", tiny, huge, "> 0"},
                        {"M0", tiny, huge, "> 0"},                  {"M Floor", 0, huge, ">= 0"},
                        {"Beta", 1.0000001, huge, "> 1"},           {"Eta0", tiny, huge, "> 0"},
                        {"Inner Reduction", 0, 0.9999999, "in [0, 1)"}};
  for (const Rule& r : rules) {
    const double value = p.get<double>(r.name);
    std::ostringstream os;
    os << "Haptos SMALSE: parameter \"" << r.name << "\" is " << value << "; it must be " << r.text << ".";
    if (!(value >= r.low && value <= r.high)) throw InputError(os.str());
  }
  for (const char* name :
       {"Maximum Iterations", "Maximum Hessian Multiplications", "Norm Applications", "Stagnation Steps"})
    if (p.get<int>(name) < 1)
      throw InputError("Haptos SMALSE: parameter \"" + std::string(name) + "\" is " +
                       std::to_string(p.get<int>(name)) + "; it must be at least 1.");
  mpgpOptions(p);
}

MpgpOptions mpgpOptions(const Teuchos::ParameterList& p) {
  MpgpOptions o;
  o.gamma = p.get<double>("Gamma");
  o.alphaFactor = p.get<double>("Alpha Factor");
  const auto& name = p.get<std::string>("Expansion");
  if (name == "Fixed")
    o.expansion = Expansion::fixed;
  else if (name == "Projected CG")
    o.expansion = Expansion::projectedCg;
  else if (name == "Automatic")
    o.expansion = Expansion::automatic;
  else
    throw InputError("Haptos SMALSE: parameter \"Expansion\" is \"" + name +
                     "\"; it must be Fixed, Projected CG or Automatic.");
  return o;
}

}  // namespace Details

void registerSmalseSolMgr() {
  using Manager = SmalseSolMgr<double, MultiVector, Operator>;
  // Belos looks names up in capitals
  Belos::Impl::registerSolverSubclassForTypes<Manager, double, MultiVector, Operator>("HAPTOS SMALSE");
}

template class SmalseSolMgr<double, MultiVector, Operator>;

}  // namespace Haptos
