// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Tpetra_CrsMatrix_fwd.hpp>
#include <Tpetra_Export_fwd.hpp>
#include <Tpetra_Import_fwd.hpp>
#include <Tpetra_Map_fwd.hpp>
#include <Tpetra_MultiVector_fwd.hpp>
#include <Tpetra_Operator_fwd.hpp>
#include <Tpetra_Vector_fwd.hpp>
#include <type_traits>

#include "Haptos_PlainTypes.hpp"

namespace Teuchos {
class ParameterList;
}  // namespace Teuchos

namespace Haptos {

using Map = Tpetra::Map<>;

/// \brief Ordinals of a map that is declared and not defined: Map::local_ordinal_type would want Tpetra_Map.hpp here, a second a unit.
template <class M>
struct OrdinalsOf;
template <class Local, class Global, class Node>
struct OrdinalsOf<Tpetra::Map<Local, Global, Node>> {
  using LocalOrdinal = Local;
  using GlobalOrdinal = Global;
};

static_assert(std::is_same_v<LocalOrdinal, OrdinalsOf<Map>::LocalOrdinal> && std::is_same_v<GlobalOrdinal, OrdinalsOf<Map>::GlobalOrdinal>,
              "Haptos_PlainTypes.hpp takes other ordinals than Tpetra's maps");

using MultiVector = Tpetra::MultiVector<double>;
using Vector = Tpetra::Vector<double>;
using Operator = Tpetra::Operator<double>;
using CrsMatrix = Tpetra::CrsMatrix<double>;

}  // namespace Haptos
