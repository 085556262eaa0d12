// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_QuadraticProgram_def.hpp"

namespace Haptos {
template class QuadraticProgram<double, MultiVector, Operator>;
}  // namespace Haptos
