// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_HeldCouplings.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>

#include "Haptos_ConstraintRows.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {

std::vector<HeldCoupling> heldCouplings(const MultiplierMap& multipliers, const Vector& values) {
  const Map& map = *multipliers.map();
  std::vector<std::vector<HeldCoupling>> outgoing(std::size_t(map.getComm()->getSize()));
  const auto data = values.getData(0);
  for (const Coupling& coupling : multipliers.couplings()) {
    HeldCoupling item{{-1, -1, -1}, {0, 0, 0}, false, coupling.axes, coupling.nodes};
    for (std::size_t a = 0; a < 3; ++a)
      if (const int row = coupling.rows[a]; row >= 0) {
        item.rows[a] = map.getGlobalElement(row);
        item.values[a] = data[row];
        item.isContact = !isEquality(multipliers.kinds()[std::size_t(row)]);
      }
    outgoing[std::size_t(coupling.holder < 0 ? map.getComm()->getRank() : coupling.holder)].push_back(std::move(item));
  }
  return joined(exchangeValues(*map.getComm(), outgoing));
}

}  // namespace Haptos
