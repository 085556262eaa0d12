// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Haptos {

/// \brief How an iteration ended.
enum class Outcome {
  Converged,
  MultiplicationLimit,  ///< as many applications of F as were allowed
  IterationLimit,       ///< as many outer steps as were allowed
  RoundOff,             ///< no gain any more at the level of round-off
  Stalled,              ///< the residual is no longer halved
  Stagnated,            ///< many outer steps without gain, far from round-off as far as is known
  NotConverged          ///< conjugate gradients came to their end without success
};

/// \brief The outcome in the user's words.
inline const char* describe(Outcome outcome) {
  switch (outcome) {
    case Outcome::Converged: return "converged";
    case Outcome::MultiplicationLimit: return "Solver->Maximum Hessian Multiplications is reached";
    case Outcome::IterationLimit: return "limit of outer iterations";
    case Outcome::RoundOff: return "stagnation at round-off";
    case Outcome::Stalled: return "the residual was no longer halved";
    case Outcome::Stagnated: return "many outer steps without gain in the residual";
    case Outcome::NotConverged: break;
  }
  return "conjugate gradients did not converge";
}

}  // namespace Haptos
