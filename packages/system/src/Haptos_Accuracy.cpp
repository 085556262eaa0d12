// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Accuracy.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "Haptos_LocalSystems.hpp"
#include "Haptos_Reductions.hpp"

namespace Haptos {
namespace {

double ratio(double a, double b) { return a == 0 ? 0 : a / b; }

// Largest difference of copies, where it is, and largest displacement.
struct Continuity {
  double difference = 0, largest = 0;
  std::int64_t node = -1;

  void see(double value, std::int64_t at) {
    if (value <= difference) return;
    difference = value;
    node = at;
  }
};

// Of this rank's nodes.
Continuity measureOwnNodes(const AccuracyInput& model, const NodalGather::Copies& copies) {
  const std::int64_t first = model.gather.firstNode();
  Continuity result;
  for (std::size_t i = 0; i < copies.mean.size(); ++i) result.see(copies.highest[i] - copies.lowest[i], first + std::int64_t(i / 3));
  for (std::size_t i = 0; i < copies.mean.size(); i += 3)
    result.largest = std::max(result.largest, std::hypot(copies.mean[i], copies.mean[i + 1], copies.mean[i + 2]));
  for (const auto& p : model.step.prescribed) {
    const std::size_t at = 3 * std::size_t(p.node - first) + std::size_t(p.component);
    result.see(std::max(std::abs(copies.highest[at] - p.value), std::abs(copies.lowest[at] - p.value)), p.node);
  }
  return result;
}

Continuity measureContinuity(const AccuracyInput& model, const Vector& u) {
  const Continuity mine = measureOwnNodes(model, model.gather.copies(u));
  const auto& comm = *u.getMap()->getComm();
  const auto most = largestOfAll(comm, std::array<double, 2>{mine.difference, mine.largest});
  const bool isMine = mine.difference == most[0] && mine.node >= 0;
  const auto node = leastOfAll(comm, isMine ? mine.node : std::numeric_limits<std::int64_t>::max());
  return {most[0], most[1], most[0] > 0 ? node : -1};
}

// Squared norm of the residual for every body.
std::vector<double> squaresOfBodies(const AccuracyInput& model, const Vector& residual) {
  const auto r = residual.getData(0);
  std::vector<double> mine(std::size_t(model.numBodies), 0.0);
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    for (std::size_t k = model.jump.primalOffsets()[i]; k < model.jump.primalOffsets()[i + 1]; ++k)
      mine[std::size_t(model.bodies[i])] += r[Teuchos::Ordinal(k)] * r[Teuchos::Ordinal(k)];
  return sumOfAll(*residual.getMap()->getComm(), mine);
}

// Largest jump over tied rows.
// u_secondary - u_primary along each axis, which the tied rows of s = B u - c are.
double measureTied(const MultiplierMap& multipliers, const Vector& s) {
  const auto data = s.getData(0);
  double mine = 0;
  for (std::size_t row = 0; row < multipliers.kinds().size(); ++row)
    if (multipliers.kinds()[row] == RowKind::Tied) mine = std::max(mine, std::abs(data[row]));
  return largestOfAll(*s.getMap()->getComm(), mine);
}

}  // namespace

// x -= K u, subdomain by subdomain.
void subtractForces(const AccuracyInput& model, const Vector& u, Vector& x, const StiffnessProduct& multiply) {
  const auto displacement = u.getData(0);
  const auto force = x.getDataNonConst(0);
  const auto& offsets = model.jump.primalOffsets();
  for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
    const Eigen::Index n = Eigen::Index(offsets[i + 1] - offsets[i]);
    Eigen::VectorXd Ku = Eigen::VectorXd::Zero(n);
    const Eigen::Map<const Eigen::VectorXd> local(displacement.getRawPtr() + offsets[i], n);
    if (multiply) multiply(int(i), local, Ku);
    else model.systems.source().multiply(int(i), local, Ku);
    Eigen::Map<Eigen::VectorXd>(force.getRawPtr() + offsets[i], n) -= Ku;
  }
}

// Of nodes, not of copies: how a load is shared among copies must not matter.
LoadScales measureLoads(const NodalGather& gather, const MultiVector& f, const Communicator& comm) {
  const auto nodal = gather.sum(f);
  double squares = 0, largest = 0;
  for (std::size_t i = 0; i < nodal.size(); i += 3) {
    const double load = std::hypot(nodal[i], nodal[i + 1], nodal[i + 2]);
    squares += load * load;
    largest = std::max(largest, load);
  }
  return {std::sqrt(sumOfAll(comm, squares)), largestOfAll(comm, largest)};
}

// The reaction at a node is B^T lambda of its Dirichlet rows, over all its copies.
LocalReactions localReactions(const MultiplierMap& multipliers, const Vector& lambda) {
  const auto data = lambda.getData(0);
  LocalReactions result;
  for (const NodeRows& node : multipliers.nodeRows()) {
    double squared = 0;
    for (int row : node.dirichlet)
      if (row >= 0) squared += double(node.copies) * data[row] * data[row];  // each copy gets lambda / sqrt(copies)
    result.squares += squared;
    result.largest = std::max(result.largest, std::sqrt(squared));
  }
  return result;
}

LoadScales measureReactions(const MultiplierMap& multipliers, const Vector& lambda) {
  const LocalReactions mine = localReactions(multipliers, lambda);
  const auto& comm = *lambda.getMap()->getComm();
  return {std::sqrt(sumOfAll(comm, mine.squares)), largestOfAll(comm, mine.largest)};
}

double externalForce(const LoadScales& loads, double reactions, double contactForces) {
  constexpr double kOwnForces = 1e-3;
  return std::max({loads.norm, reactions, kOwnForces * contactForces});
}

double squaresOfContactForces(const ContactLaw& law, const Vector& lambda) {
  const auto data = lambda.getData(0);
  double squares = 0;
  for (const PairLaw& pair : law.pairs())
    for (const double force : ContactLaw::gather(pair, data.getRawPtr())) squares += force * force;
  return squares;
}

// || |K| |u| || row by row, from the sums over each row's components that were kept when K was there.
double roundOffForce(const LocalSystems& systems, const std::vector<std::size_t>& offsets, const Vector& u) {
  const auto x = u.getData(0);
  double mine = 0;
  for (int i = 0; i < systems.size(); ++i) {
    const auto& magnitude = systems.magnitude(i);
    const double* ui = x.getRawPtr() + offsets[std::size_t(i)];
    for (Eigen::Index row = 0; row < magnitude.rows(); ++row) {
      const double* node = ui + (row - row % 3);
      double sum = 0;  // of |K_ij u_j|, u_j as at the row's own node: neighbours move alike
      for (int d = 0; d < 3; ++d) sum += magnitude(row, d) * std::abs(node[d]);
      mine += sum * sum;
    }
  }
  return std::numeric_limits<double>::epsilon() * std::sqrt(sumOfAll(*u.getMap()->getComm(), mine));
}

RCP<Vector> residualOf(const AccuracyInput& model, const Vector& u, const Vector& lambda) {
  auto residual = Teuchos::rcp(new Vector(*model.step.f, Teuchos::Copy));
  model.jump.apply(lambda, *residual, Teuchos::TRANS, -1.0, 1.0);
  subtractForces(model, u, *residual);
  return residual;
}

// From u and lambda alone: nothing that a method believes of its own convergence goes in.
Accuracy measureAccuracy(const AccuracyInput& model, const Vector& u, const Vector& lambda, const Vector& residual) {
  const Continuity continuity = measureContinuity(model, u);
  const LoadScales reactions = measureReactions(model.jump.multipliers(), lambda);
  const auto squares = squaresOfBodies(model, residual);
  Vector s(*model.step.c, Teuchos::Copy);
  model.jump.apply(u, s, Teuchos::NO_TRANS, 1.0, -1.0);  // s = B u - c

  Accuracy result;
  result.scales = {continuity.largest, std::max(model.loads.largest, reactions.largest)};
  result.ext = externalForce(model.loads, reactions.norm, std::sqrt(sumOfAll(*lambda.getMap()->getComm(), squaresOfContactForces(model.law, lambda))));
  result.errors = measureContact(model.law, lambda, s, result.scales);
  const double imbalance = std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0));
  result.errors.equilibrium = ratio(imbalance, result.ext);
  result.errors.continuity = ratio(std::max(continuity.difference, measureTied(model.jump.multipliers(), s)), continuity.largest);
  const double roundOff = roundOffForce(model.systems, model.jump.primalOffsets(), u);
  result.floor = ratio(roundOff, result.ext);
  const double contact = contactForceScale(model.law, lambda, 0);
  result.withoutForce = isWithoutForce(model.loads, std::max({result.ext, imbalance, contact}), roundOff);
  if (result.withoutForce) {  // nothing to compare with
    KktErrors& e = result.errors;
    e.equilibrium = e.compression = e.complementarity = e.cone = e.slipLaw = result.floor = 0;
  }
  if (!squares.empty()) result.residualBody = int(std::max_element(squares.begin(), squares.end()) - squares.begin());
  result.differenceNode = continuity.node;
  return result;
}

void measureContactOf(const AccuracyInput& model, const Vector& v, const Vector& lambda, Accuracy& result) {
  Vector s(*model.step.c, Teuchos::Copy);
  model.jump.apply(v, s, Teuchos::NO_TRANS, 1.0, -1.0);
  KktErrors errors = measureContact(model.law, lambda, s, result.scales);
  errors.equilibrium = result.errors.equilibrium;
  errors.continuity = std::max(result.errors.continuity, ratio(measureTied(model.jump.multipliers(), s), result.scales.uRef));
  result.errors = errors;
}

}  // namespace Haptos
