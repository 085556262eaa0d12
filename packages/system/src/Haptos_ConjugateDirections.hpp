// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_ColumnBlocks.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief Directions of conjugate gradients with P^T F P = 1, kept with F P.
///
/// The short recurrence forgets where a few eigenvalues lie far from the others, and comes back to what it has done.  With all directions
/// at hand it does not, and what is asked for later begins with what they know [farhat-crivelli-roux-1994].
class ConjugateDirections {
 public:
  /// \param map of p and F p, \param most that are kept
  ConjugateDirections(const Map& map, long most);

  long size() const { return long(P_.cols()); }
  bool isFull() const { return size() >= most_; }

  /// \brief Keeps p, \param pFp = p^T F p > 0
  void append(const Vector& p, const Vector& Fp, double pFp);
  /// \brief z := z - P (F P)^T z.  Collective: one reduction.
  void makeConjugate(Vector& z) const;
  /// \brief lambda := lambda + P P^T r,  r := r - F P P^T r.  Collective: one reduction.
  void step(Vector& lambda, Vector& r) const;

 private:
  long most_;
  ColumnBlocks P_, FP_;
};

}  // namespace Haptos
