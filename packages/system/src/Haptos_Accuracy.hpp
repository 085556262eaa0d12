// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <functional>
#include "Haptos_DualProblem.hpp"
#include "Haptos_KktMeasure.hpp"
#include "Haptos_NodalGather.hpp"

namespace Haptos {

/// \brief Sizes of the loads; the same on all ranks.
struct LoadScales {
  double norm = 0;     ///< 2-norm of the applied nodal loads [force]
  double largest = 0;  ///< largest applied nodal load [force]
};

/// Collective.
LoadScales measureLoads(const NodalGather& gather, const MultiVector& f, const Communicator& comm);

/// \brief This rank's part of `measureReactions`: sum of squares [force^2] and largest.
struct LocalReactions {
  double squares = 0, largest = 0;
};
LocalReactions localReactions(const MultiplierMap& multipliers, const Vector& lambda);

/// \brief 2-norm and largest nodal value of the reactions at prescribed displacements.  Collective.
LoadScales measureReactions(const MultiplierMap& multipliers, const Vector& lambda);

/// \brief What equilibrium is measured by: the 2-norm of loads or reactions [force], or a thousandth of that of contact forces.
///
/// These are larger where bodies press each other by their shapes alone, as in shrink fits, where loads and reactions may be 0.
double externalForce(const LoadScales& loads, double reactions, double contactForces);
/// \brief This rank's part of the squares of all contact forces [force^2].
double squaresOfContactForces(const ContactLaw& law, const Vector& lambda);

/// \brief How good (u, lambda) is, from u, lambda and the stiffnesses alone, as their source multiplies by them.
struct Accuracy {
  KktErrors errors;
  KktScales scales;
  double ext = 0;    ///< see externalForce [force]
  double floor = 0;  ///< the equilibrium that round-off allows: eps || |K| |u| || / ext, a bound
  static constexpr double kReached = 0.1;  ///< of the floor: measured errors end at about this
  bool withoutForce = false;  ///< no load and no more than round-off: all errors in force are 0
  int residualBody = -1;              ///< the body with the largest part of the residual
  std::int64_t differenceNode = -1;   ///< mesh node with the largest difference of copies, or to a prescribed value
  std::int64_t imbalanceNode = -1;    ///< mesh node with the largest imbalance of the field that is written
};

/// \brief What the check needs of the model; references are kept.
struct AccuracyInput {
  const LocalSystems& systems;
  const std::vector<int>& bodies;  ///< [local subdomains]
  int numBodies;                   ///< over all ranks
  const JumpOperator& jump;
  const ContactLaw& law;
  const StepData& step;
  const NodalGather& gather;
  LoadScales loads;
};

/// Ku += K u of a local subdomain.
using StiffnessProduct = std::function<void(int i, const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::Ref<Eigen::VectorXd> Ku)>;

/// \brief x -= K u, subdomain by subdomain; without `multiply` by the source of the stiffness.
void subtractForces(const AccuracyInput& model, const Vector& u, Vector& x, const StiffnessProduct& multiply = {});

/// \brief eps || |K| |u| || [force], up to the change of u between neighbours: no smaller residual can be expected.  Collective.
/// \param offsets [local subdomains + 1] in the primal map
double roundOffForce(const LocalSystems& systems, const std::vector<std::size_t>& offsets, const Vector& u);

/// \brief Whether no load acts and prescribed displacements cause no more than round-off: a motion without stress.
/// \param force largest of what is asked [force], \param roundOff see `roundOffForce`
inline bool isWithoutForce(const LoadScales& loads, double force, double roundOff) {
  constexpr double kNoise = 1e3;  // sums over copies and coarse solves
  return loads.norm == 0 && force <= kNoise * roundOff;
}

/// \brief f - K u - B^T lambda [force], on the primal map.  Collective.
RCP<Vector> residualOf(const AccuracyInput& model, const Vector& u, const Vector& lambda);

/// \brief All but `fieldEquilibrium`, see WrittenField.  Collective.
/// \param residual see `residualOf`
Accuracy measureAccuracy(const AccuracyInput& model, const Vector& u, const Vector& lambda, const Vector& residual);

/// \brief Contact and ties measured anew, of other displacements than `result` was measured of.  Collective.
void measureContactOf(const AccuracyInput& model, const Vector& v, const Vector& lambda, Accuracy& result);

}  // namespace Haptos
