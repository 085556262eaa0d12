// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

namespace Haptos {

struct ContactSurface;

/// \brief Tree of axis-parallel boxes over the faces of a surface, asked with infinite straight lines.
///
/// A line query finds what lies opposite a node at whatever distance, which a tree of nearest points does
/// not: with a gap of many element sizes the nearest point need not be the one opposite.  Building costs O(n
/// log n) for n faces, a query about O(log n) where the line crosses the surface steeply.
class FacetTree {
 public:
  explicit FacetTree(const ContactSurface& surface);

  /// \brief Faces whose box, grown by a quarter of the face's diameter and by `margin`, meets the line; replaces `facets`.
  /// \param direction need not be of length 1
  /// \return how many boxes were compared with the line, which is what a query costs
  int facetsNearLine(const std::array<double, 3>& origin, const std::array<double, 3>& direction,
                     std::vector<int>& facets, double margin = 0) const;

 private:
  struct Box {
    std::array<double, 3> centre;
    std::array<double, 3> half;
  };
  struct Node {
    Box box;
    int begin, end;   ///< range in order_ (leaves)
    int left, right;  ///< positions in nodes_, -1: leaf
  };

  int build(int begin, int end);
  static Box unite(const Box& a, const Box& b);
  static bool meets(const Box& box, const std::array<double, 3>& origin,
                    const std::array<double, 3>& direction, double margin);

  std::vector<Box> boxes_;   ///< [numFacets]
  std::vector<int> order_;   ///< facets, grouped by leaf
  std::vector<Node> nodes_;  ///< [0] is the root
};

}  // namespace Haptos
