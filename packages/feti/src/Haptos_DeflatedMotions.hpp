// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "Haptos_DualPreconditioner.hpp"

namespace Haptos {

/// \brief What Z of `DeflatedPreconditioner` is made of, on the boundary unknowns of each subdomain, and what was made of S to find it.
struct DeflatedMotions {
  static constexpr long kLargest = 5000;  ///< columns of Z
  /// Unknowns of a subdomain's boundary up to which its spectral modes are had for as much as some tens of iterations, and up to which its
  /// dense matrices are made at all, and slender ones have soft motions: an eigenproblem takes 2 s at 2600 of them (decisions/016, 042).
  static constexpr int kUsualSpectrum = 1000, kLargestSpectrum = 5000;
  static constexpr long kMostRigid = 2000;  ///< columns that are rigid motions, for spectral modes to come beside them

  /// \brief Which spectral modes are looked for: by default as many as are likely to pay for themselves.
  struct Spectra {
    int largestBoundary = kUsualSpectrum;  ///< in subdomains with so many unknowns that rows touch, or fewer
    long most = 2000;                      ///< of all subdomains, the stiffest ones
    /// If that leaves out stiffer ones there are none: what is left is as bad as S of a capped Poisson's ratio, which is cheap (decisions/050).
    double stiffestLeft = 8;
    long columns = kLargest;  ///< of Z; where there are more soft motions than that, the softest are taken
    static Spectra none() { return {0}; }  ///< rigid motions, and soft ones of slender subdomains, alone
    /// \brief As many as Z can have, however stiff those are that it cannot: where nothing else leads to an answer.
    static Spectra atAnyPrice() { return {kLargestSpectrum, kLargest, std::numeric_limits<double>::infinity()}; }
  };

  std::vector<Eigen::MatrixXd> ofSubdomains;  ///< [local subdomains] boundary unknowns x motions: rigid ones, then others
  std::vector<Eigen::MatrixXd> L;             ///< [classes] S = L^T L where subdomains are slender; empty elsewhere
  std::vector<Eigen::MatrixXd> S;             ///< [classes] empty, or of those whose spectra were looked for

  long count(const Communicator& comm) const;  ///< over all ranks.  Collective.

  /// \brief Rigid ones, soft ones of slender subdomains (`SoftSpectrum`) and those that cutting makes stiff of others (`SpectralModes`).
  ///
  /// S of slender subdomains is taken apart into L^T L for good, as S itself has lost the energies of soft motions to round-off, L has not.
  /// \param slender [local subdomains] those whose soft motions are looked for
  /// \return none where more spectral modes are needed than are wanted, the same on all ranks.  Collective.
  static std::optional<DeflatedMotions> find(const DualPreconditioner& base, const std::vector<char>& slender, const Spectra& wanted);

  /// \brief Rigid ones and those that are given.  \param soft [classes] on the boundary, [unknowns x any]
  static DeflatedMotions given(const DualPreconditioner& base, const std::vector<Eigen::MatrixXd>& soft);
};

}  // namespace Haptos
