// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_Communication.hpp"
#include "Haptos_ContactLaw.hpp"
#include "Haptos_SubspaceNewtonOptions.hpp"

namespace Haptos {

/// \brief Coefficients of friction times a factor.
std::vector<PairLaw> scaledCoefficients(std::vector<PairLaw> pairs, double factor);

/// \brief The small coefficient raised to at least `least` times the large one; zeros stay.
std::vector<PairLaw> roundedEllipses(std::vector<PairLaw> pairs, double least);

/// \brief Largest ratio of the two coefficients of a pair, over all ranks; 1 where one of them is 0.  Collective.
double largestAxisRatio(const std::vector<PairLaw>& pairs, const Communicator& comm);

/// \brief Rounded ellipses whose axis ratio is at most start, start x factor, ...; all below `ratio`.
std::vector<std::vector<PairLaw>> axisRatioLevels(const std::vector<PairLaw>& pairs, double ratio, double start, double factor);

/// \brief Levels of friction to go through before the true one.
struct FrictionLevels {
  std::vector<std::vector<PairLaw>> laws;  ///< [levels][pairs]
  double tolerance;  ///< of each, relative to the jumps of the start
  int patience;      ///< F without halving the residual that end each
};

/// \brief Which levels: on the way to the first answer, and after a stall.
class ContinuationPolicy {
 public:
  using Options = SubspaceNewtonOptions::Continuation;
  /// \param pairs are kept by reference.  Collective.
  ContinuationPolicy(const std::vector<PairLaw>& pairs, const Options& options, const Communicator& comm)
      : pairs_(pairs), options_(options), ratio_(largestAxisRatio(pairs, comm)) {}

  /// \brief Larger coefficients, and before them rounder ellipses where `minds` says that directions mind the axis ratio.
  FrictionLevels first(bool mindsAxisRatio) const;
  /// \brief A finer way, the finest after more restarts.
  FrictionLevels detour(int restart) const;

  /// \brief Coefficients of the last level before the true one.
  std::vector<PairLaw> easier() const { return scaledCoefficients(pairs_, options_.firstFactor); }

  /// \brief Whether ellipses are so long that axis ratios matter.
  bool isElongated() const { return ratio_ > options_.firstAxisRatio; }

 private:
  const std::vector<PairLaw>& pairs_;
  Options options_;
  double ratio_;
};

}  // namespace Haptos
