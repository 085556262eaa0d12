// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Stratimikos_DefaultLinearSolverBuilder.hpp>
#include <Thyra_LinearOpWithSolveFactoryBase.hpp>
#include <string>

namespace Thyra {

/// \brief Total FETI as a solver of Thyra, for tied bodies: no contact.
///
/// Takes a Haptos::SubdomainMatrix (in a Thyra::TpetraLinearOp) and nothing else: a merged matrix has lost those of its
/// subdomains.  Initialised once more with the same matrix it takes its new values.  Parameters are those of Haptos::ContactSystem:
/// sublists Solver, Local Solver, Preconditioner, Coarse Problem.  `Solver->Relative Tolerance` holds where the caller asks for none;
/// || b - A x || <= tolerance || b || is what callers may ask for.  A solve goes on from the one before, whatever x is.
class HaptosSolverFactory : public LinearOpWithSolveFactoryBase<double> {
 public:
  bool isCompatible(const LinearOpSourceBase<double>& source) const override;
  Teuchos::RCP<LinearOpWithSolveBase<double>> createOp() const override;
  /// \throws Haptos::InputError for another operator, Haptos::InsufficientModel where a body is not held.  Collective.
  void initializeOp(const Teuchos::RCP<const LinearOpSourceBase<double>>& source, LinearOpWithSolveBase<double>* op,
                    ESupportSolveUse use) const override;
  void uninitializeOp(LinearOpWithSolveBase<double>* op, Teuchos::RCP<const LinearOpSourceBase<double>>* source,
                      Teuchos::RCP<const PreconditionerBase<double>>* preconditioner,
                      Teuchos::RCP<const LinearOpSourceBase<double>>* approximate, ESupportSolveUse* use) const override;

  void setParameterList(const Teuchos::RCP<Teuchos::ParameterList>& list) override { list_ = list; }
  Teuchos::RCP<Teuchos::ParameterList> getNonconstParameterList() override { return list_; }
  Teuchos::RCP<Teuchos::ParameterList> unsetParameterList() override { return std::exchange(list_, Teuchos::null); }
  Teuchos::RCP<const Teuchos::ParameterList> getParameterList() const override { return list_; }
  Teuchos::RCP<const Teuchos::ParameterList> getValidParameters() const override;

 private:
  Teuchos::RCP<Teuchos::ParameterList> list_;
};

}  // namespace Thyra

namespace Haptos {

/// \brief After this a `Linear Solver Type` may be `name`; its parameters are in `Linear Solver Types->name`.
void enableStratimikos(Stratimikos::DefaultLinearSolverBuilder& builder, const std::string& name = "Haptos");

}  // namespace Haptos

namespace Stratimikos {

/// \brief The same, where other packages have theirs.
inline void enableHaptos(DefaultLinearSolverBuilder& builder, const std::string& name = "Haptos") { Haptos::enableStratimikos(builder, name); }

}  // namespace Stratimikos
