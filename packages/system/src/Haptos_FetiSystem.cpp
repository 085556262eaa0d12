// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_FetiSystem.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

#include "Haptos_ContradictingRows.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Exchange.hpp"
#include "Haptos_LoadAdmissibility.hpp"
#include "Haptos_LocalSolverFactor.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_PairLaws.hpp"
#include "Haptos_ParameterValue.hpp"
#include "Haptos_PartShape.hpp"
#include "Haptos_PolynomialMotions.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_RunClock.hpp"
#include "Haptos_SurfaceOperators.hpp"

namespace Haptos {
namespace {

std::vector<int> sizesOf(const SubdomainStiffness& stiffness) {
  std::vector<int> sizes;
  for (int i = 0; i < stiffness.size(); ++i) sizes.push_back(3 * int(stiffness.coordinates(i).size()));
  return sizes;
}

// Not by all ranks: what is dense would then depend on how they are spread over machines.  Collective.
double ranksOfMachine(const Communicator& comm) {
  std::vector<int> ranks(std::size_t(comm.getSize()), 0);
  const auto machine = std::size_t(lowestRankOfNode(comm));
  ranks[machine] = 1;
  return sumOfAll(comm, ranks)[machine];
}

// The longest edge of the box around all nodes.  Collective.
double extentOf(const Communicator& comm, const SubdomainStiffness& stiffness) {
  Eigen::Matrix<double, 6, 1> ends = Eigen::Matrix<double, 6, 1>::Constant(-std::numeric_limits<double>::max());  // of x and of -x
  for (int i = 0; i < stiffness.size(); ++i)
    for (const auto& x : stiffness.coordinates(i))
      for (int d = 0; d < 3; ++d) ends[d] = std::max(ends[d], x[std::size_t(d)]), ends[3 + d] = std::max(ends[3 + d], -x[std::size_t(d)]);
  ends = largestOfAll(comm, ends);
  return (ends.head<3>() + ends.tail<3>()).maxCoeff();
}

}  // namespace

FetiSystem::FetiSystem(SystemModel model)
    : model_(std::move(model)),
      law_(makeContactLaw(*model_.multipliers, model_.friction)),
      systems_(Teuchos::rcp(new LocalSystems(model_.stiffness))) {}

// K and R of every subdomain; then B, which needs sizes only.  Systems of before may have been factored half way.
void FetiSystem::assemble() {
  systems_ = Teuchos::rcp(new LocalSystems(model_.stiffness));
  runOnAllRanks(*model_.comm, [&] { systems_->assemble(); });
  useRows();
}

// B, G and what depends on these alone.
void FetiSystem::useRows() {
  jump_ = Teuchos::rcp(new JumpOperator(model_.multipliers, model_.firstSubdomain, sizesOf(*model_.stiffness)));
  touched_ = std::make_unique<TouchedUnknowns>(*systems_, *jump_);
  G_ = Teuchos::rcp(new NaturalCoarseSpace(jump_, *systems_));
  bodies_ = std::make_unique<BodyMotions>(*G_, *systems_, model_.pieces, model_.pieceNames);
  const bool isHinged = model_.pieceNames.size() > model_.bodyNames.size();  // else gluing rows feel no motion
  unheld_ = motionsUnheldBy([&](RowKind kind) { return isHinged || kind != RowKind::Gluing; });
  floating_ = motionsUnheldBy([&](RowKind kind) { return isEquality(kind) && (isHinged || kind != RowKind::Gluing); });
}

template <class Holds>
UnheldMotions FetiSystem::motionsUnheldBy(Holds&& holds) const {
  std::vector<char> counts;
  for (const RowKind kind : model_.multipliers->kinds()) counts.push_back(holds(kind));
  return findUnheldMotions(*model_.comm, G_->rows(), bodies_->Z(), counts);
}

UnheldMotions FetiSystem::motionsUnheldAt(const Vector& lambda, const StateScales& scales) const {
  std::vector<char> counts;
  for (const RowKind kind : model_.multipliers->kinds()) counts.push_back(isEquality(kind));
  const auto data = lambda.getData(0);
  for (const PairLaw& pair : law_.pairs()) {
    const ContactStatus status = contactStatus(pair, ContactLaw::gather(pair, data.getRawPtr()), scales);
    if (pair.normal >= 0) counts[std::size_t(pair.normal)] = status != ContactStatus::Open;
    for (const int row : pair.tangential)
      if (row >= 0) counts[std::size_t(row)] = status == ContactStatus::Stick;
  }
  return findUnheldMotions(*model_.comm, G_->rows(), bodies_->Z(), counts);
}

// Contacts whose gaps and normals leave a node no room; u = 0 obeys all where no sides overlap.
void FetiSystem::requireRoom(const Vector& c) const {
  constexpr double kRoundOff = 1e-9;  // of the model
  const auto data = c.getData(0);
  bool isAnyClosed = false;
  for (const PairLaw& pair : law_.pairs()) isAnyClosed = isAnyClosed || (pair.normal >= 0 && data[pair.normal] < 0);
  if (!anyOfAll(*model_.comm, isAnyClosed)) return;
  const auto found = findContradiction(*model_.multipliers, c, kRoundOff * extentOf(*model_.comm, *model_.stiffness));
  if (!found) return;
  throw InsufficientModel("The model has no solution: gaps of contact contradict each other, no displacements obey all of them. At node " +
                          model_.nameOfNode(found->node) + " they overlap by " + numberText(found->depth) +
                          " or more. Look for bodies or nodes between two obstacles that are nearer to each other than they are thick.");
}

// All checks know e = R^T f and gaps alone, so a step is refused before anything is factored.
void FetiSystem::setStep(StepData step) {
  const Eigen::VectorXd e = G_->restrictLoad(*step.f, *systems_);
  const double loadScale = step.f->getVector(0)->norm2();
  requireBalance(unheld_, *bodies_, e, loadScale);
  requireAdmissibleLoads(law_, floating_, *G_, e, *bodies_, loadScale);
  requireRoom(*step.c);
  step_ = std::move(step);
  if (isFormed()) dual_.setStep(step_);
}

// Before the rows of new interfaces are there the pairs are those of the others.
void FetiSystem::setFriction(std::vector<std::string> names, std::vector<FrictionSpec> friction) {
  model_.interfaceNames = std::move(names);
  law_ = makeContactLaw(*model_.multipliers, friction);
  model_.friction = std::move(friction);
}

// Half of what a rank may call its own of the machine is left to sparse factors and vectors.
void FetiSystem::factor(const LocalSolverOptions& options, std::optional<PreconditionerKind> preconditioner) {
  kind_ = preconditioner;
  localMethod_ = options.method;
  SurfaceOperators surface(kind_.value_or(PreconditionerKind::Dirichlet), localMethod_);
  mayUse_ = leastOfAll(*model_.comm, 0.5 * physicalMemoryBytes() / ranksOfMachine(*model_.comm));
  runOnAllRanks(*model_.comm, [&] {
    systems_->factor(*touched_, localMethod_, options.dual, mayUse_, [&](int) {
      if (kind_ && !model_.softened) surface.add(*systems_, *touched_);
    });
  });
  makePreconditioner(std::move(surface));
}

// From the surfaces of the systems, or of softened ones, which are made here.
void FetiSystem::makePreconditioner(SurfaceOperators surface) {
  if (!kind_) return;
  findSlender();
  findLargestBoundary();
  RCP<const LocalSystems> systems = systems_;
  if (model_.softened) systems = assembleAgain(model_.softened, surface, kind_ == PreconditionerKind::Dirichlet);
  preconditioner_ = Teuchos::rcp(new DualPreconditioner(jump_, systems, std::move(surface)));
}

// K once more, each class as long as the preconditioner's part of it is made.
RCP<const LocalSystems> FetiSystem::assembleAgain(const std::shared_ptr<const SubdomainStiffness>& stiffness, SurfaceOperators& surface, bool dense,
                                                  const std::function<void(const LocalSystems&, int)>& use) const {
  const auto systems = Teuchos::rcp(new LocalSystems(stiffness));
  runOnAllRanks(*model_.comm, [&] {
    systems->assemble();
    if (dense) systems->condenseLike(*systems_);
    else systems->findClasses();
    for (int c = 0; c < systems->numClasses(); ++c) {
      surface.add(*systems, *touched_);
      if (use) use(*systems, c);
      systems->releaseStiffness(c);
    }
  });
  return systems;
}

// G G^T of gluing and of contact rows apart: Newton takes contact rows out and in again.
void FetiSystem::formDual(const CoarseOptions& coarse) {
  coarse_ = coarse;
  const auto F = Teuchos::rcp(new DualOperator(jump_, systems_));
  const auto placement = std::make_shared<CoarsePlacement>(model_.comm, G_->dimension(), coarse);
  std::vector<double> isGluing, isContact;
  for (const auto kind : model_.multipliers->kinds()) {
    isGluing.push_back(isEquality(kind));
    isContact.push_back(!isEquality(kind));
  }
  RCP<CoarseProblem> GGT;
  try {
    GGT = Teuchos::rcp(new CoarseProblem(placement, {G_->rows(), isGluing}, {G_->rows(), isContact}, holdsFor(unheld_, *bodies_),
                                         CoarseProblem::Factor::Now));
  } catch (const UselessFactor&) {  // thrown on all ranks
    if (model_.isOwn)
      throw InsufficientModel("The model has no solution: a motion that costs no energy in the kernels given with the stiffnesses, and is "
                              "not a rigid one, is held by nothing. Prescribe displacements against it.");
    throw InsufficientModel(kLooseModel);
  }
  dual_ = DualProblem(F, G_, GGT);
  if (!step_.f.is_null()) dual_.setStep(step_);
}

// Factors of K do not know B; dense surface matrices do, where rows touch other unknowns than before.
void FetiSystem::renewRows(RCP<const MultiplierMap> multipliers) {
  model_.multipliers = std::move(multipliers);
  law_ = makeContactLaw(*model_.multipliers, model_.friction);
  step_ = {};
  useRows();
  if (!isFormed()) return;
  dual_ = {};
  SurfaceOperators surface(kind_.value_or(PreconditionerKind::Dirichlet), localMethod_);
  runOnAllRanks(*model_.comm, [&] {
    systems_->renewSurfaces(*touched_, localMethod_, [&](int) {
      if (kind_ && !model_.softened) surface.add(*systems_, *touched_);
    });
  });
  makePreconditioner(std::move(surface));
  formDual(coarse_);
}

// All ranks must know: a deflated preconditioner is built together or not at all.
void FetiSystem::findSlender() {
  constexpr double kFlat = 3;
  const bool isDirichlet = kind_ == PreconditionerKind::Dirichlet;
  Eigen::VectorXd flatAndAll = Eigen::Vector2d(0.0, double(systems_->size()));
  slender_.clear();
  for (int i = 0; i < systems_->size(); ++i) {
    const double aspect = model_.aspects[std::size_t(i)];
    slender_.push_back(isDirichlet && isSlender(aspect) && int(touched_->of(i).size()) <= DeflatedMotions::kLargestSpectrum);
    flatAndAll[0] += aspect > kFlat;
  }
  flatAndAll = sumOfAll(*model_.comm, flatAndAll);
  areFlat_ = 2 * flatAndAll[0] > flatAndAll[1];
  anySlender_ = anyOfAll(*model_.comm, std::count(slender_.begin(), slender_.end(), char(1)) > 0);
}

void FetiSystem::findLargestBoundary() {
  int mine = 0;
  for (int i = 0; i < systems_->size(); ++i) mine = std::max(mine, int(touched_->of(i).size()));
  largestBoundary_ = largestOfAll(*model_.comm, mine);
}

// Of unknowns of boundaries: whole numbers, whose sum is the same on any number of ranks.
double FetiSystem::sumOfCubes() const {
  double cubes = 0;
  for (int i = 0; i < systems_->size(); ++i) cubes += std::pow(double(touched_->of(i).size()), 3);
  return sumOfAll(*model_.comm, cubes);
}

// Operations of dense S and eigenproblems, 3 to 4 n^3 a subdomain, beside those of ten more directions: with n rows of contact a model of one takes some
// eighty products, an entry of a matrix that is read counting as twenty (decisions/042).  Near incompressibility nothing leads past them.
bool FetiSystem::isDeflationDear() const {
  constexpr double kOfSpectra = 3.3, kOfModels = 10 * 80 * 20;
  if (anySlender_ || model_.isHardlyCompressible || hasSpectra(kCheapSpectrum)) return false;
  const double rows = 3 * double(model_.multipliers->numPairs());
  return kOfSpectra * sumOfCubes() > kOfModels * rows * rows;
}

// Whether spectral modes of all subdomains are looked for: where their boundaries are not larger, and where there are few subdomains, as the factor of K is
// dense.
bool FetiSystem::hasSpectra(int largestSpectrum) const {
  return kind_ == PreconditionerKind::Dirichlet && largestBoundary_ <= largestSpectrum && G_->dimension() <= DeflatedMotions::kMostRigid;
}

// M between contact rows is dense where subdomains are slender (decisions/016), the same on all ranks, with its factor and its inverse.
bool FetiSystem::mayContactBeDense() const {
  constexpr double kBytes = 4 * sizeof(double);
  const double rows = 3 * double(model_.multipliers->numPairs());
  return kBytes * rows * rows <= mayUse_;
}

// Where that has no place slender subdomains have the spectral modes of others.  Of the true K where spectral modes take up what a capped
// Poisson's ratio is for: motions whose copies cannot be moved apart without a change of volume.
RCP<const DeflatedPreconditioner> FetiSystem::makeDeflated(const DeflatedMotions::Spectra& spectra) const {
  if (kind_ != PreconditionerKind::Dirichlet) return {};
  // Soft motions live in the last digits of S, and G M = 0 asks for all of them.
  SurfaceOperators surface(*kind_, localMethod_, std::vector<char>(slender_.size(), 1));
  const bool areSlender = anySlender_ && mayContactBeDense();
  const bool isSoftened = model_.softened && (areSlender || !hasSpectra(spectra.largestBoundary));
  const auto systems = assembleAgain(isSoftened ? model_.softened : model_.stiffness, surface, false);
  const std::vector<char> none(slender_.size(), 0);
  return DeflatedPreconditioner::make(Teuchos::rcp(new DualPreconditioner(jump_, systems, std::move(surface))), areSlender ? slender_ : none, spectra);
}

// Beside 10 n^3 operations for soft motions of a subdomain and, where there is contact, some fifty factors of 3 x pairs rows (decisions/059).
RCP<const AssembledPreconditioner> FetiSystem::makeAssembled() const {
  constexpr double kOfMotions = 10, kOfFactor = 0.5, kModels = 50;
  if (!anySlender_ || localMethod_ == LocalSolverMethod::Klu2) return {};
  const double denseModel = kOfFactor * std::pow(3 * double(model_.multipliers->numPairs()), 3);
  const double most = kOfMotions * sumOfCubes() + kModels * denseModel;
  const auto systems = Teuchos::rcp(new LocalSystems(model_.stiffness));
  runOnAllRanks(*model_.comm, [&] {
    systems->assemble();
    systems->findClasses();
  });
  return AssembledPreconditioner::make(preconditioner_, systems, {most, denseModel, mayUse_});
}

// Of the stiffness that M has.
RCP<const DeflatedPreconditioner> FetiSystem::makeDeflatedByPolynomials() const {
  if (!mayDeflateByPolynomials()) return {};
  SurfaceOperators surface(*kind_, localMethod_, std::vector<char>(slender_.size(), 1));
  std::vector<Eigen::MatrixXd> motions;
  const auto systems = assembleAgain(model_.softened ? model_.softened : model_.stiffness, surface, false, [&](const LocalSystems& all, int c) {
    const int member = all.members()[std::size_t(c)].front();
    motions.push_back(polynomialMotions({all.source().coordinates(member), all.stiffness(c), all[member].R(), surface.boundary(c)}));
  });
  return DeflatedPreconditioner::make(Teuchos::rcp(new DualPreconditioner(jump_, systems, std::move(surface))), motions);
}

}  // namespace Haptos
