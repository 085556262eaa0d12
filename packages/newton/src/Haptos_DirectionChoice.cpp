// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DirectionChoice.hpp"

namespace Haptos {

DirectionChoice::DirectionChoice(const ContactOperators& dual, const Eigen::VectorXd& diagonalOfM, const DualVectors& vectors,
                                 const GluingBalance& balance, const SubspaceNewtonOptions& options)
    : dual_(dual),
      balance_(balance),
      diagonalOfMcc_(vectors.contact(diagonalOfM)),
      options_(options.condensed),
      balanced_(dual, diagonalOfM, vectors, balance, options.balanced) {
  mayCondense_ = dual.makeDeflatedM && vectors.sum(double(vectors.numPairs())) > 0;
}

bool DirectionChoice::condense() {
  if (!mayCondense_) return isCondensed();
  mayCondense_ = false;  // M_Z is made at a price, and once: what it cannot do now it cannot do later
  const auto deflated = dual_.makeDeflatedM();
  if (deflated.M.is_null()) return false;
  condensed_ = std::make_unique<CondensedDirection>(deflated, dual_, balance_, diagonalOfMcc_, deflated.stiffness * balanced_.pairStiffness(), options_);
  return true;
}

}  // namespace Haptos
