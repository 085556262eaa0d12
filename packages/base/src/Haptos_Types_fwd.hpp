// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_RCPDecl.hpp>
#include <Tpetra_CrsMatrix_fwd.hpp>
#include <Tpetra_Details_DefaultTypes.hpp>
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
using LocalOrdinal = Tpetra::Details::DefaultTypes::local_ordinal_type;
using GlobalOrdinal = Tpetra::Details::DefaultTypes::global_ordinal_type;

using Map = Tpetra::Map<>;
using MultiVector = Tpetra::MultiVector<double>;
using Vector = Tpetra::Vector<double>;
using Operator = Tpetra::Operator<double>;
using CrsMatrix = Tpetra::CrsMatrix<double>;

}  // namespace Haptos
