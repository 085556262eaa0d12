// SPDX-License-Identifier: BSD-3-Clause
#include "SceneRun.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "Haptos_Error.hpp"

namespace Haptos::Scenes {
namespace {

// Contact forces and displacements agree to this many tolerances, or to as many as the dense solution's own
// amplification: kkt bounds jumps in parts of u_ref, and where a stiff contact turns such a part into large forces
// no method can do better than that.  A tolerance of 1e-6 amplified by a million would allow everything: three digits
// agree in any case.
constexpr double kForceFactor = 30, kDisplacementFactor = 100, kMostByAmplification = 1e-3;

template <class... Args>
std::string formatted(const char* format, Args... args) {
  char text[256];
  std::snprintf(text, sizeof text, format, args...);
  return text;
}

void expect(SceneOutcome& outcome, bool holds, const std::string& otherwise) {
  if (!holds) outcome.failures.push_back(otherwise);
}

// Largest difference of the force on a secondary node, over l_ref of the reference.
double forceDifference(const ReferenceProblem& problem, const ReferenceSolution& reference, const std::vector<PairResult>& pairs) {
  std::map<std::int64_t, Eigen::Vector3d> wanted;
  for (std::size_t i = 0; i < problem.pairs.size(); ++i)
    wanted[problem.pairs[i].secondary] = reference.force(problem.pairs[i], Eigen::Index(i));
  if (pairs.size() != wanted.size()) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (const auto& pair : pairs) {
    const auto it = wanted.find(pair.secondaryNode);
    if (it == wanted.end()) return std::numeric_limits<double>::infinity();
    largest = std::max(largest, (Eigen::Vector3d(pair.force.data()) - it->second).norm());
  }
  return largest > 0 ? largest / reference.lRef : 0;
}

double displacementDifference(const ReferenceSolution& reference, const std::vector<double>& u) {
  const Eigen::Map<const Eigen::VectorXd> mine(u.data(), Eigen::Index(u.size()));
  const double largest = (mine - reference.u).cwiseAbs().maxCoeff();
  return largest > 0 ? largest / reference.uRef : 0;
}

// The scene must be what its name says, or the comparison shows nothing.
void checkHardness(const Scene& scene, SceneOutcome& outcome) {
  const auto& states = outcome.reference.states;
  const char* names[3] = {"stick", "slip", "open"};
  for (int i = 0; i < 3; ++i) {
    expect(outcome, states[i] >= scene.atLeast[i],
           formatted("the scene is too easy: %d pairs %s, at least %d were meant", states[i], names[i], scene.atLeast[i]));
    if (!scene.onlyState.empty() && scene.onlyState != names[i])
      expect(outcome, states[i] == 0, formatted("%d pairs %s, none should", states[i], names[i]));
  }
}

void compareWithReference(const Scene& scene, Formulation formulation, SceneOutcome& outcome) {
  DenseReference dense(makeReferenceProblem(scene, formulation));
  outcome.reference = dense.solve();
  outcome.compared = true;
  const auto& reference = outcome.reference;
  expect(outcome, reference.converged,
         formatted("the dense reference did not converge (%s: kkt %.1e, equilibrium %.1e)", reference.how.c_str(), reference.kkt,
                   reference.equilibrium));
  if (!reference.converged) return;
  checkHardness(scene, outcome);
  outcome.forceError = forceDifference(dense.problem(), reference, outcome.result.pairs);
  outcome.displacementError = displacementDifference(reference, outcome.result.displacement);
  const auto compare = [&](const char* what, double error, double factor) {
    const double allowed = std::max(outcome.tolerance * factor, std::min(outcome.tolerance * reference.amplification, kMostByAmplification));
    expect(outcome, error <= allowed, formatted("%s differ from the dense solution by %.1e, allowed %.1e", what, error, allowed));
  };
  compare("contact forces", outcome.forceError, kForceFactor);
  if (scene.displacementsAreUnique) compare("displacements", outcome.displacementError, kDisplacementFactor);
}

// The method that was asked for keeps its promise, whatever methods it handed over to.
void checkReport(const std::string& asked, SceneOutcome& outcome) {
  const RunReport& report = outcome.result.report;
  const double kkt = report.accuracy.errors.kkt();
  expect(outcome, std::isfinite(kkt) && kkt <= outcome.tolerance,
         formatted("kkt %.1e is above the tolerance %.1e", kkt, outcome.tolerance));
  const long promised = promisedMultiplications(asked), used = report.solver.hessianMultiplications;
  expect(outcome, used <= promised,
         formatted("%ld multiplications by F (%s), %s promises %ld", used, report.solver.method.c_str(), asked.c_str(), promised));
}

// Runs the program's chain; its exceptions become its exit statuses.
Formulation simulate(const RCP<const Communicator>& comm, const Scene& scene, const SceneOptions& options, SceneOutcome& outcome) {
  Formulation formulation = Formulation::Standard;
  try {
    const SourceMesh source = makeSceneMesh(scene);
    Simulation run(comm, makeSceneParameters(scene, options.method, outcome.tolerance), nullptr, &source);
    run.prepare();
    formulation = run.model().data.formulation;
    const long mine[2] = {long(run.model().multipliers->pairs().size()), long(run.model().subdomains.size())};
    Teuchos::reduceAll(*comm, Teuchos::REDUCE_MIN, mine[0], Teuchos::outArg(outcome.fewestPairs));
    Teuchos::reduceAll(*comm, Teuchos::REDUCE_MIN, mine[1], Teuchos::outArg(outcome.fewestSubdomains));
    outcome.result = run.solve();
    outcome.result.displacement = wholeOnRoot(*comm, outcome.result.displacement);
    outcome.status = outcome.result.solved ? 0 : 2;
    outcome.message = outcome.result.report.solver.reason;
  } catch (const InputError& e) {
    outcome.status = 1;
    outcome.message = e.what();
  } catch (const InsufficientModel& e) {
    outcome.status = 3;
    outcome.message = e.what();
  } catch (const std::exception& e) {
    outcome.status = 70;
    outcome.message = e.what();
  }
  return formulation;
}

std::string statesText(const ReferenceSolution& reference) {
  return formatted("%d/%d/%d", reference.states[0], reference.states[1], reference.states[2]);
}

}  // namespace

long promisedMultiplications(const std::string& method) { return method == "SMALSE" ? 5000 : 150; }

SceneOutcome runScene(const RCP<const Communicator>& comm, const Scene& scene, const SceneOptions& options) {
  SceneOutcome outcome;
  outcome.tolerance = options.tolerance > 0 ? options.tolerance : scene.tolerance;
  const Formulation formulation = simulate(comm, scene, options, outcome);
  if (commRank(*comm) != 0) return outcome;
  expect(outcome, outcome.status == scene.status,
         formatted("exit status %d instead of %d", outcome.status, scene.status) + (outcome.message.empty() ? "" : ": " + outcome.message));
  if (scene.status != 0)
    for (const auto& part : scene.says)
      expect(outcome, outcome.message.find(part) != std::string::npos, "the message does not say '" + part + "': " + outcome.message);
  if (options.idleContact) expect(outcome, outcome.fewestPairs == 0, "every rank has contact pairs");
  if (options.idleSubdomains) expect(outcome, outcome.fewestSubdomains == 0, "every rank has subdomains");
  if (scene.status == 0 && (outcome.status == 0 || outcome.status == 2)) {
    checkReport(options.method, outcome);
    compareWithReference(scene, formulation, outcome);
  }
  return outcome;
}

void compareWithTwin(const Scene& scene, SceneOutcome& outcome, const Scene& twin, const SceneOutcome& other) {
  const auto& mine = outcome.result;
  const auto& theirs = other.result;
  const long counts[2] = {mine.report.solver.hessianMultiplications, theirs.report.solver.hessianMultiplications};
  expect(outcome, std::labs(counts[0] - counts[1]) <= 2,
         formatted("%ld multiplications by F, but %ld in the units of '%s'", counts[0], counts[1], twin.name.c_str()));
  double largest = 0, difference = 0;
  expect(outcome, mine.pairs.size() == theirs.pairs.size(), "other pairs than '" + twin.name + "'");
  for (std::size_t i = 0; i < std::min(mine.pairs.size(), theirs.pairs.size()); ++i)
    for (int d = 0; d < 3; ++d) {
      const double a = mine.pairs[i].force[d] / scene.force, b = theirs.pairs[i].force[d] / twin.force;
      largest = std::max(largest, std::abs(b));
      difference = std::max(difference, std::abs(a - b));
    }
  expect(outcome, difference <= 1e-9 * largest, formatted("forces differ by %.1e from those in other units", difference / largest));
}

std::string summaryLine(const Scene& scene, const SceneOutcome& outcome) {
  const auto& report = outcome.result.report;
  std::string line = formatted("%-32s exit %d", scene.name.c_str(), outcome.status);
  if (outcome.compared)
    line += formatted("  %s %ld  kkt %.1e (%s)  forces %.1e  u %.1e  dense %s %s (%s, %d steps, kkt %.0e, amplification %.0e)", report.solver.method.c_str(),
                      report.solver.hessianMultiplications, report.accuracy.errors.kkt(), report.accuracy.errors.worst().c_str(),
                      outcome.forceError, outcome.displacementError, statesText(outcome.reference).c_str(),
                      outcome.reference.converged ? "" : "NOT CONVERGED", outcome.reference.how.c_str(), outcome.reference.newtonSteps,
                      outcome.reference.kkt, outcome.reference.amplification);
  else line += "  " + outcome.message;
  for (const auto& failure : outcome.failures) line += "\n    FAILED " + failure;
  return line;
}

std::string markdownTable(const std::vector<Scene>& scenes, const std::vector<SceneOutcome>& outcomes) {
  std::string text, group;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Scene& scene = scenes[i];
    const SceneOutcome& o = outcomes[i];
    if (scene.group != group) {
      group = scene.group;
      text += "\n### " + group + "\n\n| scene | what | stick/slip/open | method | multiplications | kkt | error of forces | exit | holds |\n"
              "|---|---|---|---|---|---|---|---|---|\n";
    }
    text += "| `" + scene.name + "` | " + scene.what + " | ";
    if (o.compared)
      text += statesText(o.reference) + " | " + o.result.report.solver.method + " | " +
              std::to_string(o.result.report.solver.hessianMultiplications) + " | " +
              formatted("%.1e | %.1e", o.result.report.accuracy.errors.kkt(), o.forceError);
    else text += "| | | | ";
    text += formatted(" | %d | ", o.status);
    text += o.failures.empty() ? "yes |\n" : "no: " + o.failures.front().substr(0, 90) + " |\n";
  }
  return text;
}

}  // namespace Haptos::Scenes
