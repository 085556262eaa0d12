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

bool DirectionChoice::take(ContactOperators::Price price) {
  const auto deflated = dual_.makeDeflatedM(price);
  if (deflated.M.is_null()) return false;
  condensed_ = std::make_unique<CondensedDirection>(deflated, dual_, balance_, diagonalOfMcc_, deflated.stiffness * balanced_.pairStiffness(), options_);
  return true;
}

// M_Z at a price is made once: what it cannot do now it cannot do later.
bool DirectionChoice::condense() {
  if (offer_ == Offer::None) return isCondensed();
  const bool isUsual = offer_ == Offer::Usual, isTaken = take(isUsual ? ContactOperators::Price::Usual : ContactOperators::Price::Any);
  offer_ = isUsual && !isTaken ? Offer::AnyPrice : Offer::None;
  return isCondensed();
}

bool DirectionChoice::condenseForLaw() {
  if (offer_ == Offer::Usual && dual_.isDeflatedMDear && take(ContactOperators::Price::Little)) return true;
  return condense();
}

}  // namespace Haptos
