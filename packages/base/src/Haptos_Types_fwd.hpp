// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_RCPDecl.hpp>
#include <Tpetra_CrsMatrix_fwd.hpp>
#include <Tpetra_Export_fwd.hpp>
#include <Tpetra_Import_fwd.hpp>
#include <Tpetra_Map_fwd.hpp>
#include <Tpetra_MultiVector_fwd.hpp>
#include <Tpetra_Operator_fwd.hpp>
#include <Tpetra_Vector_fwd.hpp>

#include "Haptos_Communication.hpp"

namespace Teuchos {
class ParameterList;
}  // namespace Teuchos

namespace Haptos {

using Teuchos::RCP;
using Map = Tpetra::Map<>;

/// \brief Ordinals of a map that is declared and not defined: Map::local_ordinal_type would want Tpetra_Map.hpp here, a second a unit.
template <class M>
struct OrdinalsOf;
template <class Local, class Global, class Node>
struct OrdinalsOf<Tpetra::Map<Local, Global, Node>> {
  using LocalOrdinal = Local;
  using GlobalOrdinal = Global;
};

using LocalOrdinal = OrdinalsOf<Map>::LocalOrdinal;
using GlobalOrdinal = OrdinalsOf<Map>::GlobalOrdinal;
using MultiVector = Tpetra::MultiVector<double>;
using Vector = Tpetra::Vector<double>;
using Operator = Tpetra::Operator<double>;
using CrsMatrix = Tpetra::CrsMatrix<double>;

}  // namespace Haptos
