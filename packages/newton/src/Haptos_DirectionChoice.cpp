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
  if (dual.makeDeflatedM && vectors.sum(double(vectors.numPairs())) > 0) offer_ = Offer::Usual;
}

// M_Z is made once: what it cannot do now it cannot do later.
bool DirectionChoice::condense() {
  if (offer_ == Offer::None) return isCondensed();
  const bool isUsual = offer_ == Offer::Usual;
  const auto deflated = dual_.makeDeflatedM(isUsual ? ContactOperators::Price::Usual : ContactOperators::Price::Any);
  offer_ = isUsual && deflated.M.is_null() ? Offer::AnyPrice : Offer::None;
  if (deflated.M.is_null()) return false;
  condensed_ = std::make_unique<CondensedDirection>(deflated, dual_, balance_, diagonalOfMcc_, deflated.stiffness * balanced_.pairStiffness(), options_);
  return true;
}

}  // namespace Haptos
