// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <BelosCustomSolverFactory.hpp>
#include <BelosSolverFactory_Tpetra.hpp>
#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief One solver manager under one name (capitals or not), as Belos' factory takes solvers of others.
template <class Manager>
class NamedSolverFactory final : public Belos::CustomSolverFactory<double, MultiVector, Operator> {
 public:
  using Base = Belos::SolverManager<double, MultiVector, Operator>;
  explicit NamedSolverFactory(std::string name) : name_(std::move(name)) {}

  Teuchos::RCP<Base> getSolver(const std::string& name, const Teuchos::RCP<Teuchos::ParameterList>& parameters) override {
    if (!isSupported(name)) return Teuchos::null;
    const Teuchos::RCP<Base> manager = Teuchos::rcp(new Manager);
    manager->setParameters(parameters);
    return manager;
  }
  int numSupportedSolvers() const override { return 1; }
  std::vector<std::string> supportedSolverNames() const override { return {name_}; }
  bool isSupported(const std::string& name) const override {
    const auto same = [](unsigned char a, unsigned char b) { return std::toupper(a) == std::toupper(b); };
    return std::equal(name.begin(), name.end(), name_.begin(), name_.end(), same);
  }

 private:
  std::string name_;
};

/// \brief Registers with all instances of Belos::SolverFactory, present and future; a second time changes nothing.
template <class Manager>
void registerWithBelos(const std::string& name) {
  Belos::SolverFactory<double, MultiVector, Operator> factory;
  if (!factory.isSupported(name)) factory.addFactory(Teuchos::rcp(new NamedSolverFactory<Manager>(name)));
}

}  // namespace Haptos
