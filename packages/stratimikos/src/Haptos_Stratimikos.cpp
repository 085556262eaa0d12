// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Stratimikos.hpp"

#include <Teuchos_AbstractFactoryStd.hpp>
#include <Thyra_LinearOpWithSolveBase.hpp>
#include <Thyra_TpetraThyraWrappers.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>

#include "Haptos_Error.hpp"
#include "Haptos_OptionTable.hpp"
#include "Haptos_SubdomainMatrix.hpp"

namespace {

using Haptos::ContactSystem;
using Haptos::SubdomainMatrix;
using Haptos::Vector;
using Teuchos::ParameterList;
using Teuchos::RCP;
using Extract = Thyra::TpetraOperatorVectorExtraction<double, Haptos::LocalOrdinal, Haptos::GlobalOrdinal, Haptos::Map::node_type>;

constexpr const char* kVerbose = "VerboseObject";  // a sublist that Stratimikos' solvers may have

// Stratimikos wraps a Tpetra operator for Thyra; null where another operator is inside.
RCP<const SubdomainMatrix> matrixOf(const RCP<const Thyra::LinearOpBase<double>>& op) {
  using Wrapped = Thyra::TpetraLinearOp<double, Haptos::LocalOrdinal, Haptos::GlobalOrdinal, Haptos::Map::node_type>;
  const auto wrapped = Teuchos::rcp_dynamic_cast<const Wrapped>(op);
  return wrapped.is_null() ? Teuchos::null : Teuchos::rcp_dynamic_cast<const SubdomainMatrix>(wrapped->getConstTpetraOperator());
}

// x of A x = b, with the system that A's subdomains and supports make.
class HaptosSolve final : public Thyra::LinearOpWithSolveBase<double> {
 public:
  using Source = RCP<const Thyra::LinearOpSourceBase<double>>;

  // Not initialised where something goes wrong.
  void initialize(const Source& source, const ParameterList& parameters) {
    const auto matrix = matrixOf(source->getOp());
    // The same matrix object again means new values in the same subdomains: factors are made anew, rows and maps stay.
    const bool isSame = !system_.is_null() && matrix == matrix_ && parameters == parameters_;
    const auto system = isSame ? system_ : Teuchos::rcp(new ContactSystem(matrix->getDomainMap()->getComm(), Teuchos::rcpFromRef(parameters)));
    // Where making or renewing it throws, nothing half made is left to solve with.
    system_ = Teuchos::null;
    if (isSame) system->updateStiffness();
    else matrix->addTo(*system);
    system->setUp();
    matrix_ = matrix;
    parameters_ = parameters;
    source_ = source;
    op_ = source->getOp();
    in_ = Teuchos::rcp(new Tpetra::Import<>(matrix->getDomainMap(), system->map()));
    system_ = system;
  }
  Source takeSource() { return std::exchange(source_, Teuchos::null); }

  RCP<const Thyra::VectorSpaceBase<double>> range() const override { return op_.is_null() ? Teuchos::null : op_->range(); }
  RCP<const Thyra::VectorSpaceBase<double>> domain() const override { return op_.is_null() ? Teuchos::null : op_->domain(); }

 private:
  bool opSupportedImpl(Thyra::EOpTransp mode) const override { return Thyra::opSupported(*op_, mode); }
  void applyImpl(const Thyra::EOpTransp mode, const Thyra::MultiVectorBase<double>& X, const Teuchos::Ptr<Thyra::MultiVectorBase<double>>& Y,
                 const double alpha, const double beta) const override {
    Thyra::apply(*op_, mode, X, Y, alpha, beta);
  }
  bool solveSupportsImpl(Thyra::EOpTransp) const override { return true; }  // A is symmetric
  bool solveSupportsNewImpl(Thyra::EOpTransp, const Teuchos::Ptr<const Thyra::SolveCriteria<double>> criteria) const override {
    return criteria.is_null() || isMeasured(*criteria);
  }
  bool solveSupportsSolveMeasureTypeImpl(Thyra::EOpTransp, const Thyra::SolveMeasureType& measure) const override {
    return measure.useDefault() || measure(Thyra::SOLVE_MEASURE_NORM_RESIDUAL, Thyra::SOLVE_MEASURE_NORM_RHS);
  }
  static bool isMeasured(const Thyra::SolveCriteria<double>& criteria) {
    const auto& measure = criteria.solveMeasureType;
    return measure.useDefault() || measure(Thyra::SOLVE_MEASURE_NORM_RESIDUAL, Thyra::SOLVE_MEASURE_NORM_RHS);
  }
  Thyra::SolveStatus<double> solveImpl(Thyra::EOpTransp, const Thyra::MultiVectorBase<double>& B, const Teuchos::Ptr<Thyra::MultiVectorBase<double>>& X,
                                       const Teuchos::Ptr<const Thyra::SolveCriteria<double>> criteria) const override;
  void solveColumn(const Vector& b, Vector& x, double wanted, Thyra::SolveStatus<double>& status) const;
  double solveOnce(const Vector& b, Vector& x, Thyra::SolveStatus<double>& status) const;

  Source source_;
  RCP<const Thyra::LinearOpBase<double>> op_;
  RCP<const SubdomainMatrix> matrix_;
  ParameterList parameters_;
  RCP<ContactSystem> system_;
  RCP<const Tpetra::Import<>> in_;  // from the matrix' map to the system's
};

Thyra::SolveStatus<double> HaptosSolve::solveImpl(Thyra::EOpTransp, const Thyra::MultiVectorBase<double>& B,
                                                  const Teuchos::Ptr<Thyra::MultiVectorBase<double>>& X,
                                                  const Teuchos::Ptr<const Thyra::SolveCriteria<double>> criteria) const {
  TEUCHOS_TEST_FOR_EXCEPTION(system_.is_null(), std::logic_error, "HaptosSolverFactory: the solver is not initialised");
  // A criterion without a number leaves the tolerance to the parameters.
  const bool asks = !criteria.is_null() && isMeasured(*criteria) && !criteria->solveMeasureType.useDefault() &&
                    criteria->requestedTol != Thyra::SolveCriteria<double>::unspecifiedTolerance();
  const auto b = Extract::getConstTpetraMultiVector(Teuchos::rcpFromRef(B));
  const auto x = Extract::getTpetraMultiVector(Teuchos::rcpFromPtr(X));
  Thyra::SolveStatus<double> status;
  status.solveStatus = Thyra::SOLVE_STATUS_CONVERGED;
  status.achievedTol = 0;
  status.extraParameters = Teuchos::parameterList();
  status.extraParameters->set("Iteration Count", 0);
  for (std::size_t v = 0; v < b->getNumVectors(); ++v)
    solveColumn(*b->getVector(v), *x->getVectorNonConst(v), asks ? criteria->requestedTol : 0, status);
  return status;
}

// The system measures against reactions too, which mostly are larger than b, a few times: it is asked for a little more from the start, as
// another attempt costs what six multiplications cost.  Where that is not enough it goes on.
void HaptosSolve::solveColumn(const Vector& b, Vector& x, double wanted, Thyra::SolveStatus<double>& status) const {
  constexpr int kAttempts = 4;
  constexpr double kFirst = 0.25, kRoom = 1e-10;  // what is asked for first, of what is wanted, where round-off is far away
  const double own = Haptos::readOptions<Haptos::SolverOptions>(parameters_.isSublist("Solver") ? parameters_.sublist("Solver") : ParameterList(), "Solver").tolerance;
  double tolerance = wanted > kRoom ? kFirst * wanted : wanted > 0 ? wanted : own, achieved = 0;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    system_->setTolerance(tolerance);
    achieved = solveOnce(b, x, status);
    if (wanted == 0 || achieved <= wanted || status.solveStatus != Thyra::SOLVE_STATUS_CONVERGED) break;
    // A quarter of what the two measures differ by, in steps that neither crawl nor run into round-off.
    tolerance *= std::clamp(0.25 * wanted / achieved, 0.01, 0.5);
  }
  if (wanted > 0 && achieved > wanted) status.solveStatus = Thyra::SOLVE_STATUS_UNCONVERGED;
  status.achievedTol = std::max(status.achievedTol, achieved);
}

// Returns || b - A x || / || b ||.
double HaptosSolve::solveOnce(const Vector& b, Vector& x, Thyra::SolveStatus<double>& status) const {
  Vector free(b, Teuchos::Copy), f(system_->map()), u(system_->map());
  {
    const auto data = free.getDataNonConst(0);
    for (auto row : matrix_->held()) data[row] = 0;  // loads on supports are no business of the others
  }
  f.doImport(free, *in_, Tpetra::INSERT);
  const auto outcome = system_->solve(f, u);
  x.doExport(u, *in_, Tpetra::INSERT);
  {
    const auto from = b.getData(0);
    const auto to = x.getDataNonConst(0);
    // Held rows of A are those of the identity: there x is what b asks for.
    for (auto row : matrix_->held()) to[row] = from[row];
  }
  if (!outcome.solved) status.solveStatus = Thyra::SOLVE_STATUS_UNCONVERGED;
  status.message = outcome.reason;
  // Stratimikos reports one number a solve: multiplications by F of all columns and attempts together.
  status.extraParameters->set("Iteration Count", status.extraParameters->get<int>("Iteration Count") + int(outcome.multiplications));
  Vector r(b, Teuchos::Copy);
  matrix_->apply(x, r, Teuchos::NO_TRANS, -1.0, 1.0);
  const double reference = b.norm2();
  return reference > 0 ? r.norm2() / reference : 0.0;
}

template <class Options>
void addSublist(ParameterList& list, const std::string& name) {
  list.sublist(name).setParameters(Haptos::listOf(Options{}, name));
}

}  // namespace

namespace Thyra {

bool HaptosSolverFactory::isCompatible(const LinearOpSourceBase<double>& source) const { return !matrixOf(source.getOp()).is_null(); }

RCP<LinearOpWithSolveBase<double>> HaptosSolverFactory::createOp() const { return Teuchos::rcp(new HaptosSolve); }

void HaptosSolverFactory::initializeOp(const RCP<const LinearOpSourceBase<double>>& source, LinearOpWithSolveBase<double>* op, ESupportSolveUse) const {
  if (!isCompatible(*source))
    throw Haptos::InputError("Haptos solves with a Haptos::SubdomainMatrix and was given " + source->getOp()->description() +
                             ": a merged matrix has lost those of its subdomains.  Give the subdomains, or take FROSch, which needs none "
                             "(Linear Solver Type: Belos, Preconditioner Type: FROSch).");
  ParameterList parameters = list_.is_null() ? ParameterList() : *list_;
  parameters.remove(kVerbose, false);
  Teuchos::dyn_cast<HaptosSolve>(*op).initialize(source, parameters);
}

void HaptosSolverFactory::uninitializeOp(LinearOpWithSolveBase<double>* op, RCP<const LinearOpSourceBase<double>>* source,
                                         RCP<const PreconditionerBase<double>>* preconditioner, RCP<const LinearOpSourceBase<double>>* approximate,
                                         ESupportSolveUse*) const {
  const auto own = Teuchos::dyn_cast<HaptosSolve>(*op).takeSource();
  // Whoever takes the operator apart asks for some of its pieces; there never is a preconditioner.
  if (source != nullptr) *source = own;
  if (preconditioner != nullptr) *preconditioner = Teuchos::null;
  if (approximate != nullptr) *approximate = Teuchos::null;
}

RCP<const ParameterList> HaptosSolverFactory::getValidParameters() const {
  const auto list = Teuchos::parameterList("Haptos");
  addSublist<Haptos::SolverOptions>(*list, "Solver");
  addSublist<Haptos::SmalseOptions>(list->sublist("Solver"), "SMALSE");
  addSublist<Haptos::LocalSolverOptions>(*list, "Local Solver");
  addSublist<Haptos::PreconditionerOptions>(*list, "Preconditioner");
  addSublist<Haptos::CoarseOptions>(*list, "Coarse Problem");
  addSublist<Haptos::DecompositionOptions>(*list, "Decomposition");
  // Its entries are Teuchos' own and differ from version to version.
  list->sublist(kVerbose).disableRecursiveValidation();
  return list;
}

}  // namespace Thyra

namespace Haptos {

void enableStratimikos(Stratimikos::DefaultLinearSolverBuilder& builder, const std::string& name) {
  builder.setLinearSolveStrategyFactory(Teuchos::abstractFactoryStd<Thyra::LinearOpWithSolveFactoryBase<double>, Thyra::HaptosSolverFactory>(), name);
}

}  // namespace Haptos
