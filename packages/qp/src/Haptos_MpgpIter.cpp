// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_MpgpIter_def.hpp"

namespace Haptos {
template class MpgpIter<double, MultiVector, Operator>;
}  // namespace Haptos
