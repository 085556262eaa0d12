// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Simulation.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <array>

#include "Haptos_CommandLine.hpp"
#include "Haptos_DualPreconditioner.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_FetiSystem.hpp"
#include "Haptos_Format.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_ModelSystem.hpp"
#include "Haptos_ParameterValidation.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_RowGram.hpp"
#include "Haptos_Subdomain.hpp"
#include "Haptos_SurfaceOperators.hpp"

namespace Haptos {
namespace {

// SMALSE uses none.
std::optional<PreconditionerKind> preconditionerKind(const RunOptions& options) {
  return options.solver.method == SolverMethod::Smalse ? std::nullopt : options.preconditioner.kind;
}

SystemOptions systemOptions(const RunOptions& options) {
  return {options.localSolver, options.preconditioner, options.coarse, options.solver};
}

// What the scene did not need and was not built.
std::vector<std::string> leftOut(const ModelData& data, long pairs) {
  std::vector<std::string> notes;
  bool coulomb = false, frictional = false;
  for (std::size_t i = 0; i < data.friction.size(); ++i) {
    coulomb = coulomb || data.friction[i].law == FrictionLaw::Coulomb;
    frictional = frictional || data.friction[i].law != FrictionLaw::Frictionless;
    if (data.friction[i].tied)
      notes.push_back("no contact law on '" + data.interfaceNames[i] + "' (tied)");
    else if (data.friction[i].law == FrictionLaw::Frictionless)
      notes.push_back("no tangential multipliers on '" + data.interfaceNames[i] + "' (no friction)");
  }
  if (frictional && !coulomb) notes.push_back("no outer fixed point (Tresca)");
  if (pairs > 0 && std::count(data.isMortar.begin(), data.isMortar.end(), 0) > 0) notes.push_back("no mortar integration (matching meshes or a rigid plane)");
  if (pairs == 0 && data.tiedPairs == 0) notes.push_back(data.friction.empty() ? "no contact (none in the input)" : "no contact (no pair within reach)");
  if (data.unpairedNodes > 0)
    notes.push_back(std::to_string(data.unpairedNodes) + " secondary nodes have nothing opposite and no multiplier");
  return notes;
}

std::string discretizationOf(const ModelData& data) {
  const auto mortar = std::count(data.isMortar.begin(), data.isMortar.end(), 1);
  if (mortar == 0) return nameOf(Discretization::NodeToNode);
  const std::string name = nameOf(Discretization::Mortar);
  return std::size_t(mortar) == data.isMortar.size() ? name : nameOf(Discretization::NodeToNode) + (", " + name);
}

// The largest of the ranks, and sums, in one reduction each, as holders and others do not do the same.
CoarseReport measureCoarse(const CoarsePlacement& placement, int unknowns) {
  const CoarseCosts& c = placement.costs();
  const std::array<double, 11> mine = {double(c.factorEntries), double(c.setUpSent.bytesSent()), double(c.solveSent.bytesSent()),
                                      c.setUpSeconds, c.solveSeconds, double(c.setUpSent.messageBytes), double(c.blocks),
                                      c.flops, c.entriesRead, double(c.between), double(c.last)};
  const auto largest = largestOfAll(placement.comm(), mine), sum = sumOfAll(placement.comm(), mine);
  CoarseReport report;
  report.unknowns = unknowns;
  report.factors = placement.numHolders();
  report.setUps = c.setUps;
  report.solves = c.solves;
  report.setUpReductions = c.setUpSent.reductions;
  report.solveReductions = c.solveSent.reductions;
  report.factorEntries = {largest[0], sum[0]};
  report.flops = {largest[7], sum[7]};
  report.entriesRead = {largest[8], sum[8]};
  report.between = long(largest[9]);
  report.last = long(largest[10]);
  report.setUpBytes = (long long)(largest[1]);
  report.solveBytes = (long long)(largest[2]);
  report.setUpSeconds = largest[3];
  report.solveSeconds = largest[4];
  report.setUpMessageBytes = (long long)(largest[5]);
  report.blocks = long(largest[6]);
  return report;
}

LocalReport measureLocal(const FetiSystem& feti, const std::vector<Subdomain>& subdomains, const Communicator& comm) {
  double elements = 0;
  for (const auto& subdomain : subdomains) elements += double(subdomain.elements.size());
  FactorWork work = feti.systems().work();
  if (!feti.preconditioner().is_null()) work += feti.preconditioner()->surface().work();
  const std::array<double, 4> mine = {elements, work.entries, work.flops, work.bytesRead};
  const auto most = largestOfAll(comm, mine), all = sumOfAll(comm, mine);
  return {{most[0], all[0]}, {most[1], all[1]}, {most[2], all[2]}, {most[3], all[3]}};
}

JumpReport measureJump(const JumpOperator& B, const Communicator& comm) {
  return {B.forward().vectors, B.transposed().vectors, gatherCommunication(comm, B.forward().sent),
          gatherCommunication(comm, B.transposed().sent)};
}

// Before the work, not after it.  Serial.
void requireFilesForResults(const RunOptions& options) {
  std::vector<std::pair<std::string, std::string>> taken;
  if (!options.mesh.file.empty()) taken.emplace_back("Mesh->File", options.mesh.file);
  for (const auto& [what, file] : {std::pair<std::string, std::string>("Output->File", options.output.file), {"Output->Summary", options.output.summary}}) {
    if (file.empty()) continue;
    requireWritableFolder(file, what);
    for (const auto& [otherWhat, other] : taken) requireOtherFile(what, file, otherWhat, other);
    taken.emplace_back(what, file);
  }
}

// Known before the work starts, so said before it.
void requireFittingMethod(const RunOptions& options, long pairs) {
  if (options.solver.method == SolverMethod::Pcpg && pairs > 0)
    throw InputError("Solver->Method: PCPG is for models without contact, and this one has " + std::to_string(pairs) +
                     " contact pairs; use Automatic");
  if (options.solver.method == SolverMethod::SubspaceNewton && !options.preconditioner.kind)
    throw InputError("Preconditioner->Type: Subspace Newton needs a preconditioner; use Dirichlet or Lumped");
}

}  // namespace

Simulation::Simulation(RCP<const Communicator> comm, const Teuchos::ParameterList& parameters, Progress* progress, const SourceMesh* source)
    : comm_(std::move(comm)), options_(runOptions(parameters)), progress_(progress), source_(source) {}

Simulation::~Simulation() = default;

const FetiSystem& Simulation::system() const { return system_->solver().system(); }
const DistributedModel& Simulation::model() const { return *model_; }
const MeshShare& Simulation::mesh() const { return model_->mesh; }

void Simulation::tell(const std::string& text) const {
  if (progress_) progress_->line(text);
}

void Simulation::tell(const HistoryEntry& entry) const {
  if (progress_)
    progress_->update(std::to_string(entry.hessianMultiplications) + " multiplications by F, residual " +
                      formatted("%.1e", entry.residual) + ", stick " + std::to_string(entry.stick) + ", slip " +
                      std::to_string(entry.slip) + ", open " + std::to_string(entry.open));
}

// In the order of cost, so that a mistake is told early: files, the model with its pairs, then stiffnesses and loads.
void Simulation::prepare() {
  runOnRoot(*comm_, [&] { requireFilesForResults(options_); });
  build();
  for (const auto& note : model_->data.notes)
    if (progress_) progress_->warn(note);
}

void Simulation::build() {
  system_.reset();
  model_ = std::make_unique<DistributedModel>(distributeModel(comm_, options_, source_, clock_, late_));
  requireFittingMethod(options_, long(model_->multipliers->numPairs()));
  model_->nodalForces = nodalForces_;
  {
    const auto scope = clock_.time(Phase::Assemble);
    system_ = std::make_unique<ContactSystem>(systemModelOf(*model_, model_->mesh.nodes.size), systemOptions(options_),
                                              StepSolver::Observer{&clock_, [this](const HistoryEntry& entry) { tell(entry); }});
    system_->solver().prepare();
    steps_ = {firstStep(*model_, system())};
    system_->solver().check(steps_.front());
    comm_->barrier();  // waiting for a slower rank belongs to the phase that made it slow
  }
  describeModel();
  tell(modelText(report_.model));
}

void Simulation::describeModel() {
  const MultiplierMap& multipliers = *model_->multipliers;
  report_.version = versionNumber();
  report_.ranks = comm_->getSize();
  report_.title = options_.title;
  report_.tolerance = options_.solver.tolerance;
  ModelReport& m = report_.model;
  m.bodies = int(model_->data.bodyNames.size());
  m.subdomains = model_->numSubdomains;
  m.primalUnknowns = model_->primalUnknowns;
  m.dualUnknowns = long(multipliers.map()->getGlobalNumElements());
  m.kernelDimension = system().kernelDimension();
  m.contactPairs = long(multipliers.numPairs());
  m.pinnedRows = sumOfAll(*comm_, long(std::count(multipliers.pinned().begin(), multipliers.pinned().end(), char(1))));
  m.tiedPairs = model_->data.tiedPairs;
  m.discretization = m.contactPairs + m.tiedPairs > 0 ? discretizationOf(model_->data) : "none";
  FrictionLaw law = FrictionLaw::Frictionless;
  for (const auto& friction : model_->data.friction) law = std::max(law, friction.law);
  m.law = m.contactPairs > 0 ? nameOf(std::optional(law)) : "none";
  m.formulation = model_->data.formulation == Formulation::BBar ? "B-bar" : "standard";
  m.preconditioner = nameOf(preconditionerKind(options_));
  m.leftOut = leftOut(model_->data, m.contactPairs);
  m.notes = model_->data.notes;
  m.notes.insert(m.notes.end(), model_->data.remarks.begin(), model_->data.remarks.end());
  report_.interfaceNames = model_->data.interfaceNames;
  report_.overlaps = model_->data.overlaps;
}

// Known once the factors are made: which way every class took.
void Simulation::describeLocalSystems() {
  const LocalSystems& systems = system().systems();
  ModelReport& m = report_.model;
  m.localSolver = systems.size() > 0 ? systems.methodName() : "";
  const auto all = sumOfAll(*comm_, std::array<double, 3>{double(systems.numCondensed()), systems.denseBytes() / (1 << 20),
                                                          double(systems.numClasses())});
  m.explicitSubdomains = int(all[0]);
  m.explicitMemoryMb = all[1];
  m.congruenceClasses = int(all[2]);
  const long dropped =
      sumOfAll(*comm_, long(system().preconditioner().is_null() ? 0 : system().preconditioner()->gram().pairs().numDropped()));
  if (dropped > 0)
    m.notes.push_back(std::to_string(dropped) + " multipliers of pairs depend on others; the preconditioner leaves them out");
}

// History and counts go on where an earlier system lacked pairs.
StepResult Simulation::solveSteps() {
  StepResult step;
  for (const StepData& data : steps_) step = system_->solver().solve(data);
  for (auto& entry : step.history) entry.hessianMultiplications += earlier_.hessianMultiplications;
  step.history.insert(step.history.begin(), earlier_.history.begin(), earlier_.history.end());
  return step;
}

void Simulation::count(SolverReport& s) const {
  const FetiSystem& feti = system();
  s.hessianMultiplications = earlier_.hessianMultiplications + system_->solver().multiplications();
  s.preconditionerApplications =
      earlier_.preconditionerApplications + (feti.preconditioner().is_null() ? 0 : feti.preconditioner()->applications());
  s.coarseSolves = earlier_.coarseSolves + feti.dual().GGT->placement()->costs().solves;
  s.localSolves = earlier_.localSolves + sumOfAll(*comm_, feti.systems().localSolves());
}

// Pairs that the answer of the present system lacks, by the measure of `penetration`; false: none.
bool Simulation::addLatePairs(const StepResult& step) {
  if (model_->data.unpairedNodes == 0) return false;
  const NodalGather& gather = *system().model().gather;
  bool isAny = false;
  LatePairs found = findLatePairs(*model_, gather, gather.copies(*step.u).mean, options_.solver.tolerance * step.accuracy.scales.uRef, isAny);
  late_.resize(found.size());
  for (std::size_t k = 0; k < found.size(); ++k) late_[k].insert(late_[k].end(), found[k].begin(), found[k].end());
  return isAny;
}

SimulationResult Simulation::solve() {
  constexpr int kMostRounds = 5;
  StepResult step = solveSteps();
  for (int round = 0; step.solved && addLatePairs(step); ++round) {
    if (round == kMostRounds) {
      report_.model.notes.push_back("nodes that nothing lay opposite are still carried into the other body after " + std::to_string(kMostRounds) +
                                    " systems with more pairs; the surfaces slide too far for what lies opposite at the start");
      if (progress_) progress_->warn(report_.model.notes.back());
      break;
    }
    tell("nodes that nothing lay opposite are carried into the other body; they get pairs, and all is solved again");
    count(earlier_);
    earlier_.history = step.history;
    build();
    step = solveSteps();
  }
  describeLocalSystems();
  report_.solver.status = step.solved ? "converged" : "not converged";
  report_.solver.reason = step.reason;
  return collect(step);
}

// Pairs are known on rank 0, what their nodes are called elsewhere.
void Simulation::warnOfLargeSliding(const std::vector<PairResult>& pairs) {
  const auto all = broadcasted(*comm_, findLargeSliding(pairs, report_.interfaceNames.size()));
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (all[k].pairs == 0) continue;
    report_.model.notes.push_back("'" + report_.interfaceNames[k] + "': " + std::to_string(all[k].pairs) +
                                  " closed pairs slide by more than half an element, by up to " + formatted("%g", all[k].farthest) + " at " +
                                  describeNode(*comm_, model_->mesh, all[k].node) + "; what lies opposite is that of the start (small sliding)");
    if (progress_) progress_->warn(report_.model.notes.back());
  }
}

// From u and lambda back to nodes, pairs and elements: every quantity to the rank that will write it.
SimulationResult Simulation::collect(const StepResult& step) {
  const auto scope = clock_.time(Phase::Recover);
  const FetiSystem& feti = system();
  report_.accuracy = step.accuracy;
  SolverReport& s = report_.solver;
  s.method = step.method;
  s.outerIterations = step.outerIterations;
  count(s);
  s.history = step.history;
  s.subspace = step.subspace;
  s.deflation = step.deflation;
  report_.coarse = measureCoarse(*feti.dual().GGT->placement(), feti.kernelDimension());
  report_.jump = measureJump(feti.jump(), *comm_);
  report_.local = measureLocal(feti, model_->subdomains, *comm_);

  SimulationResult result;
  result.solved = step.solved;
  result.dual = step.dual;
  Vector jump(feti.c(), Teuchos::Copy);
  feti.jump().apply(*step.u, jump, Teuchos::NO_TRANS, 1.0, -1.0);
  const StateScales scales{contactForceScale(feti.law(), *result.dual.lambda, step.accuracy.scales.load), options_.solver.tolerance};
  result.pairs = gatherContactResults(*model_->multipliers, feti.law(), *result.dual.lambda, jump, scales);
  const auto tied = gatherTiedResults(*model_->multipliers, *result.dual.lambda);
  result.pairs.insert(result.pairs.end(), tied.begin(), tied.end());
  const NodalGather& gather = *feti.model().gather;
  result.displacement = gather.copies(*step.u).mean;
  setSlip(gather, result.displacement, model_->data.isExchanged, result.pairs);
  warnOfLargeSliding(result.pairs);
  report_.interfaces = summarizeInterfaces(result.pairs, model_->data.isExchanged);
  result.elements = gatherElementResults(*comm_, model_->subdomains, model_->data.materials, feti.jump().primalOffsets(), *step.u,
                                         model_->mesh.elements);
  result.report = report_;
  return result;
}

// Times and messages of writing belong to the report, which is therefore written last.
void Simulation::write(SimulationResult& result) {
  const OutputOptions& output = options_.output;
  {
    const auto scope = clock_.time(Phase::Write);
    if (!output.file.empty()) {
      const RunReport& report = result.report;
      ExodusWriter writer(comm_, output.file, model_->mesh);
      writer.writeStep(1.0, makeResultFields(*comm_, model_->mesh.nodes, {result.displacement, result.pairs, result.elements,
                                                                   report.accuracy.errors.kkt(), report.solver.hessianMultiplications}));
      writer.close();
    }
  }
  result.report.communication = clock_.communication(*comm_);
  result.report.times = clock_.overRanks(*comm_);
  result.report.memory = gatherPeakMemoryMb(*comm_);
  result.report.machine = describeMachine(*comm_);
  runOnRoot(*comm_, [&] {
    if (!output.summary.empty()) writeTextFile(output.summary, summaryJson(result.report));
  });
}

}  // namespace Haptos
