// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Accuracy.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "Haptos_StiffnessAssembler.hpp"

namespace Haptos {
namespace {

double ratio(double a, double b) { return a == 0 ? 0 : a / b; }

// Largest difference of copies and largest displacement, found on rank 0 and sent to all.
struct Continuity {
  double difference = 0, largest = 0;
};

Continuity measureContinuity(const AccuracyInput& model, const Vector& u) {
  const auto copies = model.gather.copies(u);
  std::array<double, 2> result{0, 0};
  for (std::size_t i = 0; i < copies.mean.size(); ++i) result[0] = std::max(result[0], copies.highest[i] - copies.lowest[i]);
  for (std::size_t i = 0; i < copies.mean.size(); i += 3)
    result[1] = std::max(result[1], std::hypot(copies.mean[i], copies.mean[i + 1], copies.mean[i + 2]));
  if (!copies.mean.empty())
    for (const auto& p : model.prescribed) {
      const std::size_t at = 3 * std::size_t(p.node) + p.component;
      result[0] = std::max({result[0], std::abs(copies.highest[at] - p.value), std::abs(copies.lowest[at] - p.value)});
    }
  Teuchos::broadcast(*u.getMap()->getComm(), 0, 2, result.data());
  return {result[0], result[1]};
}

// Squared norms of f - K u - B^T lambda and of |K| |u|, over all ranks.
std::array<double, 2> measureResidual(const AccuracyInput& model, const LocalSystems& systems, const Vector& u,
                                      const Vector& lambda) {
  Vector residual(model.f, Teuchos::Copy);
  model.jump.apply(lambda, residual, Teuchos::TRANS, -1.0, 1.0);
  const auto r = residual.getData(0), x = u.getData(0);
  std::array<double, 2> mine{0, 0}, all;
  for (std::size_t i = 0; i < model.subdomains.size(); ++i) {
    const auto offset = model.jump.primalOffsets()[i];
    const Eigen::Index n = model.subdomains[i].numDofs();
    const Eigen::Map<const Eigen::VectorXd> ui(x.getRawPtr() + offset, n), ri(r.getRawPtr() + offset, n);
    Eigen::VectorXd Ku = Eigen::VectorXd::Zero(n);
    applyStiffness(model.subdomains[i].coordinates, model.subdomains[i].groups, model.materials, model.formulation, ui, Ku);
    mine[0] += (ri - Ku).squaredNorm();
    const auto& K = systems.stiffness(int(i));
    for (Eigen::Index column = 0; column < n; ++column) {  // K is symmetric: rows are columns
      double sum = 0;
      for (Eigen::SparseMatrix<double>::InnerIterator it(K, column); it; ++it) sum += std::abs(it.value() * ui[it.row()]);
      mine[1] += sum * sum;
    }
  }
  Teuchos::reduceAll(*u.getMap()->getComm(), Teuchos::REDUCE_SUM, 2, mine.data(), all.data());
  return all;
}

}  // namespace

LoadScales measureLoads(const NodalGather& gather, const MultiVector& f, const Communicator& comm) {
  const auto nodal = gather.sum(f);
  std::array<double, 2> result{0, 0};
  for (std::size_t i = 0; i < nodal.size(); i += 3) {
    const double load = std::hypot(nodal[i], nodal[i + 1], nodal[i + 2]);
    result[0] += load * load;
    result[1] = std::max(result[1], load);
  }
  Teuchos::broadcast(comm, 0, 2, result.data());
  return {std::sqrt(result[0]), result[1]};
}

LoadScales measureReactions(const MultiplierMap& multipliers, const Vector& lambda) {
  const auto data = lambda.getData(0);
  std::map<std::int64_t, double> squared;  // mesh node -> |reaction|^2; all rows of a node lie on one rank
  for (std::size_t row = 0; row < multipliers.kinds().size(); ++row) {
    if (multipliers.kinds()[row] != RowKind::Dirichlet) continue;
    const double copies = double(multipliers.ownedOffsets()[row + 1] - multipliers.ownedOffsets()[row]);
    squared[multipliers.nodes()[row]] += copies * data[row] * data[row];  // each copy gets lambda / sqrt(copies)
  }
  double sum = 0, largest = 0, all[2];
  for (const auto& [node, value] : squared) sum += value, largest = std::max(largest, value);
  const auto& comm = *lambda.getMap()->getComm();
  Teuchos::reduceAll(comm, Teuchos::REDUCE_SUM, sum, Teuchos::outArg(all[0]));
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, largest, Teuchos::outArg(all[1]));
  return {std::sqrt(all[0]), std::sqrt(all[1])};
}

Accuracy measureAccuracy(const AccuracyInput& model, const LocalSystems& systems, const Vector& u, const Vector& lambda) {
  const Continuity continuity = measureContinuity(model, u);
  const LoadScales reactions = measureReactions(model.jump.multipliers(), lambda);
  const auto residual = measureResidual(model, systems, u, lambda);
  Vector s(model.c, Teuchos::Copy);
  model.jump.apply(u, s, Teuchos::NO_TRANS, 1.0, -1.0);  // s = B u - c

  Accuracy result;
  result.scales = {continuity.largest, std::max(model.loads.largest, reactions.largest)};
  result.ext = std::max(model.loads.norm, reactions.norm);
  result.errors = measureContact(model.law, lambda, s, result.scales);
  result.errors.equilibrium = ratio(std::sqrt(residual[0]), result.ext);
  result.errors.continuity = ratio(continuity.difference, continuity.largest);
  result.floor = std::numeric_limits<double>::epsilon() * ratio(std::sqrt(residual[1]), result.ext);
  return result;
}

}  // namespace Haptos
