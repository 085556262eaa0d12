// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RunReport.hpp"

#include <array>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace Haptos {
namespace {

using Json = nlohmann::ordered_json;

// Names are those of doc/input.md and CHANGELOG.md: what is once written goes on being written under its name.
Json headerJson(const RunReport& report) { return {{"version", report.version}, {"build", report.build}, {"ranks", report.ranks}, {"title", report.title}}; }

Json modelBlock(const ModelReport& model) {
  return {{"bodies", model.bodies},
          {"subdomains", model.subdomains},
          {"congruence_classes", model.congruenceClasses},
          {"primal_unknowns", model.primalUnknowns},
          {"dual_unknowns", model.dualUnknowns},
          {"kernel_dimension", model.kernelDimension},
          {"contact_pairs", model.contactPairs},
          {"pinned_rows", model.pinnedRows},
          {"tied_pairs", model.tiedPairs},
          {"discretization", model.discretization},
          {"law", model.law},
          {"formulation", model.formulation},
          {"local_solver", model.localSolver},
          {"explicit_subdomains", model.explicitSubdomains},
          {"explicit_memory_mb", model.explicitMemoryMb},
          {"preconditioner", model.preconditioner},
          {"left_out", model.leftOut},
          {"notes", model.notes}};
}

// The history has an entry a step; what each sent is in it where it is counted.
Json solverBlock(const SolverReport& solver) {
  Json history = Json::array();
  for (const auto& entry : solver.history) {
    history.push_back({{"hessian_multiplications", entry.hessianMultiplications},
                       {"residual", entry.residual},
                       {"stick", entry.stick},
                       {"slip", entry.slip},
                       {"open", entry.open}});
    if (isCommunicationCounted())
      history.back().update({{"reductions", entry.sent.reductions}, {"bytes_sent", entry.sent.bytesSent()}});
  }
  return {{"method", solver.method},
          {"status", solver.status},
          {"reason", solver.reason},
          {"outer_iterations", solver.outerIterations},
          {"hessian_multiplications", solver.hessianMultiplications},
          {"preconditioner_applications", solver.preconditionerApplications},
          {"coarse_solves", solver.coarseSolves},
          {"local_solves", solver.localSolves},
          {"deflation", {{"motions", solver.deflation.motions}, {"applications", solver.deflation.applications}}},
          {"subspace",
           {{"pairs", solver.subspace.pairs},
            {"compressions", solver.subspace.compressions},
            {"memory_mb", solver.subspace.memoryMb}}},
          {"history", history}};
}

// All parts of kkt, so that the largest can be told from the others.
Json accuracyBlock(const RunReport& report) {
  const KktErrors& e = report.accuracy.errors;
  return {{"equilibrium", e.equilibrium}, {"field_equilibrium", e.fieldEquilibrium}, {"continuity", e.continuity},
          {"penetration", e.penetration}, {"compression", e.compression},
          {"complementarity", e.complementarity}, {"cone", e.cone},
          {"slip_law", e.slipLaw}, {"kkt", e.kkt()},
          {"tolerance", report.tolerance}, {"round_off_floor", report.accuracy.floor}};
}

Json contactBlock(const RunReport& report) {
  Json block = Json::object();
  for (std::size_t i = 0; i < report.interfaces.size(); ++i) {
    const InterfaceResult& r = report.interfaces[i];
    Json& entry = block[report.interfaceNames[i]];
    entry = {{"normal_force", r.normalForce}, {"tangential_force", r.tangentialForce},
                                       {"stick", r.stick}, {"slip", r.slip}, {"open", r.open},
                                       {"max_pressure", r.maxPressure}};
    if (i >= report.overlaps.size()) continue;
    const InitialOverlap& overlap = report.overlaps[i];
    entry["initial_penetration"] = {{"depth", overlap.depth}};
    if (overlap.depth > 0) entry["initial_penetration"].update({{"node", overlap.nodeNumber}, {"place", overlap.place}});
  }
  return block;
}

// Of the slowest rank in each phase: they may add up to more than the total.
Json timeBlock(const PhaseTimes& times) {
  Json block;
  for (std::size_t i = 0; i < numPhases; ++i) block[phaseName(Phase(i))] = times.seconds[i].most;
  block["total"] = times.total.most;
  return block;
}

Json overRanksJson(const OverRanks& number) { return {{"min", number.least}, {"mean", number.mean}, {"max", number.most}}; }

// A rank that waits for another in a phase spends that time in it.
Json timeOverRanksBlock(const PhaseTimes& times) {
  Json block;
  for (std::size_t i = 0; i < numPhases; ++i) block[phaseName(Phase(i))] = overRanksJson(times.seconds[i]);
  block["total"] = overRanksJson(times.total);
  return block;
}

Json memoryBlock(const MemoryReport& memory) {
  Json block = Json::object();
  if (!memory.ofRank.empty()) block["peak_rss_mb"] = memory.ofRank;
  block["over_ranks"] = {{"peak_rss_mb", overRanksJson(memory.peak)}};
  return block;
}

Json machineBlock(const Machine& machine) {
  return {{"host", machine.host}, {"hosts", machine.hosts}, {"processors", machine.processors}, {"processor", machine.processor},
          {"mpi", machine.mpi}, {"blas", machine.blas}, {"trilinos", machine.trilinos}, {"compiler", machine.compiler}};
}

// Bytes of right-hand sides, stiffnesses and rows are not in it.
Json localBlock(const LocalReport& local) {
  return {{"elements", (long long)(local.elements.most)},
          {"elements_all", (long long)(local.elements.all)},
          {"factor_entries", (long long)(local.factorEntries.most)},
          {"factor_entries_all", (long long)(local.factorEntries.all)},
          {"flops", local.flops.most},
          {"flops_all", local.flops.all},
          {"bytes_read", local.bytesRead.most},
          {"bytes_read_all", local.bytesRead.all}};
}

// Set-up apart from solves: the one is paid once a matrix, the other in every iteration.
Json coarseBlock(const CoarseReport& coarse) {
  return {{"unknowns", coarse.unknowns},
          {"factors", coarse.factors},
          {"blocks", coarse.blocks},
          {"factor_entries", (long long)(coarse.factorEntries.most)},
          {"factor_entries_all", (long long)(coarse.factorEntries.all)},
          {"flops", coarse.flops.most},
          {"flops_all", coarse.flops.all},
          {"between", coarse.between},
          {"last", coarse.last},
          {"entries_read", coarse.entriesRead.most},
          {"entries_read_all", coarse.entriesRead.all},
          {"set_ups", coarse.setUps},
          {"set_up_seconds", coarse.setUpSeconds},
          {"set_up_reductions", coarse.setUpReductions},
          {"set_up_bytes", coarse.setUpBytes},
          {"set_up_message_bytes", coarse.setUpMessageBytes},
          {"solves", coarse.solves},
          {"solve_seconds", coarse.solveSeconds},
          {"solve_reductions", coarse.solveReductions},
          {"solve_bytes", coarse.solveBytes}};
}

constexpr std::array<const char*, 6> kCountNames = {"reductions", "other_collectives", "messages", "message_bytes", "collective_bytes", "bytes_sent"};

Json countsJson(const CommunicationCounts& counts) {
  Json block;
  const auto numbers = numbersOf(counts);
  for (std::size_t i = 0; i < numbers.size(); ++i) block[kCountNames[i]] = numbers[i];
  return block;
}

// An array over the ranks for every number, where they are listed; least, mean and most always.
Json countsJson(const CountsOverRanks& counts) {
  Json block = Json::object();
  for (const auto& ofRank : counts.ofRank) {
    const auto numbers = numbersOf(ofRank);
    for (std::size_t i = 0; i < numbers.size(); ++i) block[kCountNames[i]].push_back(numbers[i]);
  }
  for (std::size_t i = 0; i < counts.numbers.size(); ++i) block["over_ranks"][kCountNames[i]] = overRanksJson(counts.numbers[i]);
  return block;
}

Json jumpBlock(long vectors, const CountsOverRanks& counts) {
  Json block = countsJson(counts);
  for (const char* name : {"reductions", "other_collectives", "collective_bytes", "bytes_sent"}) block.erase(name), block["over_ranks"].erase(name);
  block["vectors"] = vectors;
  return block;
}

// Of the whole run; by phase the largest of the ranks.
Json communicationBlock(const RunReport& report) {
  Json block = countsJson(report.communication.run);
  Json phases = Json::object();
  for (std::size_t i = 0; i < numPhases; ++i) phases[phaseName(Phase(i))] = countsJson(report.communication.largestOfPhase[i]);
  block["largest_of_phase"] = phases;
  block["jump"] = jumpBlock(report.jump.forwardVectors, report.jump.forward);
  block["jump_transposed"] = jumpBlock(report.jump.transposedVectors, report.jump.transposed);
  return block;
}

// Names come from files as they are: what is not UTF-8 in them is replaced, not thrown.
std::string textOf(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace

// The first line of a run.
std::string modelText(const ModelReport& model) {
  std::ostringstream out;
  out << model.bodies << (model.bodies == 1 ? " body, " : " bodies, ") << model.subdomains << " subdomains, "
      << model.primalUnknowns << " primal and " << model.dualUnknowns << " dual unknowns, kernel " << model.kernelDimension
      << "; " << model.contactPairs << " contact pairs (" << model.discretization << ", " << model.law << ")";
  if (model.tiedPairs > 0) out << ", " << model.tiedPairs << " tied pairs";
  return out.str();
}

std::string modelJson(const RunReport& report) {
  return textOf({{"haptos", headerJson(report)}, {"model", modelBlock(report.model)}});
}

std::string summaryJson(const RunReport& report) {
  Json summary = {{"haptos", headerJson(report)},
                  {"model", modelBlock(report.model)},
                  {"solver", solverBlock(report.solver)},
                  {"accuracy", accuracyBlock(report)},
                  {"contact", contactBlock(report)},
                  {"time", timeBlock(report.times)},
                  {"time_over_ranks", timeOverRanksBlock(report.times)},
                  {"memory", memoryBlock(report.memory)},
                  {"machine", machineBlock(report.machine)},
                  {"local", localBlock(report.local)},
                  {"coarse", coarseBlock(report.coarse)}};
  if (report.communication.isCounted) summary["communication"] = communicationBlock(report);
  return textOf(summary);
}

// Under another name first: nobody reads half a summary, and a failure leaves the old one.
void writeTextFile(const std::string& path, const std::string& text) {
  const std::string temporary = path + ".part";
  std::ofstream out(temporary);
  out << text;
  out.close();
  if (out && std::rename(temporary.c_str(), path.c_str()) == 0) return;
  std::remove(temporary.c_str());
  throw std::runtime_error("cannot write '" + path + "'");
}

}  // namespace Haptos
