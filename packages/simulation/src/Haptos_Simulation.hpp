// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_ParameterList.hpp>
#include <memory>
#include <string>
#include <vector>

#include "Haptos_ContactSystem.hpp"
#include "Haptos_DistributedModel.hpp"
#include "Haptos_FieldOutput.hpp"
#include "Haptos_MeshShare.hpp"
#include "Haptos_Progress.hpp"
#include "Haptos_RunOptions.hpp"
#include "Haptos_RunReport.hpp"

namespace Haptos {

/// \brief What one run leaves; of fields of the mesh every rank has its ranges (MeshShare, `wholeOnRoot`).
struct SimulationResult {
  bool solved = false;  ///< kkt <= Relative Tolerance
  RunReport report;
  std::vector<double> displacement;  ///< [3 x nodes of this rank's range], mean of the copies
  std::vector<PairResult> pairs;     ///< rank 0
  ElementResults elements;           ///< of this rank's range
  DualSolution dual;                 ///< this rank's part
};

/// \brief One run from parameters to results: model, decomposition, dual problem, solve, check, recovery.
///
///   Simulation run(comm, parameters);      reads or generates the mesh
///   run.prepare();                         all that can be checked without a factorisation
///   auto result = run.solve();
///   run.write(result);
///
/// Where displacements carry secondary nodes into the other body that nothing lay opposite at the start, they get pairs and all is solved
/// again, a few times at most.
///
/// All methods are Collective.  The accuracy of the result is measured from u and lambda by the element
/// matrices; where a method's own test passed and that measure did not, the method goes on with a tighter one.
class Simulation {
 public:
  /// \param parameters validated, with all defaults (readParameters, validatedParameters)
  /// \param source rank 0: a mesh in memory to use instead of Mesh->File; may be null; must outlive `solve`
  Simulation(RCP<const Communicator> comm, const Teuchos::ParameterList& parameters, Progress* progress = nullptr,
             const SourceMesh* source = nullptr);
  ~Simulation();

  /// \brief Adds forces on single nodes, beside the loads of the parameters; before `prepare`, the same on all ranks.
  void addNodalForces(NodalForces forces) { nodalForces_.push_back(std::move(forces)); }

  /// \brief What the summary says of the program: commit and flags.
  void setBuild(std::string build) { report_.build = std::move(build); }

  /// \throws InputError, InsufficientModel on all ranks
  void prepare();
  SimulationResult solve();
  /// \brief Writes Output->File and Output->Summary where they are named.
  void write(SimulationResult& result);

  /// \brief The model as `prepare` found it.
  const RunReport& report() const { return report_; }
  const FetiSystem& system() const;
  const DistributedModel& model() const;
  const MeshShare& mesh() const;  ///< from `prepare` on

 private:
  void build();
  StepResult solveSteps();
  bool addLatePairs(const StepResult& step);
  void count(SolverReport& s) const;
  void describeModel();
  void warnOfLargeSliding(const std::vector<PairResult>& pairs);
  void describeLocalSystems();
  void tell(const std::string& text) const;
  void tell(const HistoryEntry& entry) const;
  SimulationResult collect(const StepResult& step);

  RCP<const Communicator> comm_;
  RunOptions options_;
  Progress* progress_;
  const SourceMesh* source_;
  std::vector<NodalForces> nodalForces_;
  RunClock clock_;
  std::unique_ptr<DistributedModel> model_;
  std::unique_ptr<ContactSystem> system_;
  std::vector<StepData> steps_;
  LatePairs late_;         // rank 0
  SolverReport earlier_;   // of systems that lacked pairs
  RunReport report_;
};

}  // namespace Haptos
