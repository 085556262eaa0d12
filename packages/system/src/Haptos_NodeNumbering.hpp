// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "Haptos_EvenRanges.hpp"
#include "Haptos_PlainTypes.hpp"

namespace Haptos {

/// \brief Numbers 0 .. size - 1 for nodes that have any ids, in the order of the ids.
///
/// Every rank keeps about as many ids, between two values, whoever brought them.
class NodeNumbering {
 public:
  NodeNumbering() = default;
  /// \param ids >= 0 that this rank brings, with repetitions.  Collective.
  NodeNumbering(RCP<const Communicator> comm, const std::vector<std::int64_t>& ids);

  /// \brief Numbers of ids; -1 where nobody brought one.  Collective.
  std::vector<std::int64_t> find(const std::vector<std::int64_t>& ids) const;
  std::int64_t size() const { return size_; }  ///< over all ranks

 private:
  int rankOf(std::int64_t id) const;
  std::int64_t numberOf(std::int64_t id) const;  // of one that this rank keeps, or -1

  RCP<const Communicator> comm_;
  std::vector<std::int64_t> cuts_;  // [ranks - 1] the lowest ids of all ranks but the first
  std::int64_t first_ = 0, size_ = 0;
  std::vector<std::int64_t> own_;  // ascending
};

}  // namespace Haptos
