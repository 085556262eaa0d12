// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

namespace Haptos {

/// \brief Number of single-character edits (insert, delete, replace, swap of neighbours) that turn `a` into
/// `b`.
///
/// Letter case and the characters space, apostrophe, '-' and '_' do not count: "youngs_modulus" and
/// "Young's Modulus" have distance 0.
int nameDistance(const std::string& a, const std::string& b);

/// \brief The candidate nearest to `name` (the first of equals); empty only if there is no candidate.
///
/// A name that is a part of the other counts as two edits: "Tolerance" is near "Relative Tolerance".
std::string nearestName(const std::string& name, const std::vector<std::string>& candidates);

/// \brief "; did you mean 'Output'?" for the nearest candidate, or "." where half of the letters of the longer name would be mistakes.
std::string suggestion(const std::string& name, const std::vector<std::string>& candidates);

/// \brief "a, b, c"; with quotes "'a', 'b', 'c'".
std::string joinNames(const std::vector<std::string>& names, const std::string& separator = ", ",
                      const std::string& quote = "");

}  // namespace Haptos
