// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NearestName.hpp"

#include <algorithm>
#include <cctype>
#include <limits>

namespace Haptos {

namespace {

/// Without what is easily mistaken: blanks, dashes, apostrophes, capitals.
std::string plainName(const std::string& name) {
  std::string plain;
  for (const unsigned char c : name)
    if (!std::isspace(c) && c != '\'' && c != '-' && c != '_') plain += char(std::tolower(c));
  return plain;
}

/// One name is a part of the other one, as "Tolerance" of "Relative Tolerance".
bool isPartOf(const std::string& a, const std::string& b) {
  const std::string s = plainName(a), t = plainName(b);
  if (std::min(s.size(), t.size()) < 4) return false;
  return s.find(t) != std::string::npos || t.find(s) != std::string::npos;
}

// A part of a name is as good as two mistakes: "Tolerance" is nearer to "Relative Tolerance" than letters tell.
int mistakes(const std::string& name, const std::string& candidate) {
  return isPartOf(name, candidate) ? std::min(2, nameDistance(name, candidate)) : nameDistance(name, candidate);
}

}  // namespace

// Letters to insert, leave out, exchange or swap with their neighbour.
int nameDistance(const std::string& a, const std::string& b) {
  const std::string s = plainName(a), t = plainName(b);
  // Optimal string alignment: d[i][j] is the distance of the first i and j characters; three rows suffice.
  std::vector<int> beforeLast(t.size() + 1), last(t.size() + 1), row(t.size() + 1);
  for (std::size_t j = 0; j <= t.size(); ++j) row[j] = int(j);
  for (std::size_t i = 1; i <= s.size(); ++i) {
    beforeLast.swap(last);
    last.swap(row);
    row[0] = int(i);
    for (std::size_t j = 1; j <= t.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (s[i - 1] == t[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && s[i - 1] == t[j - 2] && s[i - 2] == t[j - 1])
        row[j] = std::min(row[j], beforeLast[j - 2] + 1);
    }
  }
  return row[t.size()];
}

std::string suggestion(const std::string& name, const std::vector<std::string>& candidates) {
  const std::string nearest = nearestName(name, candidates);
  const auto longest = std::max(plainName(name).size(), plainName(nearest).size());
  return nearest.empty() || 2 * std::size_t(mistakes(name, nearest)) >= longest ? "." : "; did you mean '" + nearest + "'?";
}

std::string nearestName(const std::string& name, const std::vector<std::string>& candidates) {
  std::string nearest;
  int smallest = std::numeric_limits<int>::max();
  for (const auto& candidate : candidates) {
    const int distance = mistakes(name, candidate);
    if (distance >= smallest) continue;
    smallest = distance;
    nearest = candidate;
  }
  return nearest;
}

std::string joinNames(const std::vector<std::string>& names, const std::string& separator,
                      const std::string& quote) {
  std::string joined;
  for (const auto& name : names) joined += (joined.empty() ? "" : separator) + quote + name + quote;
  return joined;
}

}  // namespace Haptos
