// SPDX-License-Identifier: BSD-3-Clause
// Coarse matrices of a decomposed scene and of a chain, the same as dense ones, and every way to place their factors.
#pragma once
#include <Tpetra_Core.hpp>

#include <Eigen/Core>

#include "../../feti/tests/FetiScene.hpp"
#include "DenseAlgebra.hpp"
#include "Haptos_CoarseProblem.hpp"

namespace Haptos::Testing {

struct Case {
  const char* name;
  CoarseOptions options;
  int holders;  // expected
};

inline std::vector<Case> allCases(int ranks) {
  return {{"every rank", {1 << 20, 0}, ranks},
          {"every rank, as groups of one", {0, 1}, ranks},
          {"groups of two", {0, 2}, (ranks + 1) / 2},
          {"groups of three", {0, 3}, (ranks + 2) / 3},
          {"shared by all", {0, 0}, 1}};  // without CHOLMOD one a node: all ranks of a test share one memory
}

inline bool ranksShare(const Case& c, const Communicator& comm) {
  return hasCholmod() && comm.getSize() > 1 && c.options.replicatedUpTo == 0 && c.options.ranksPerFactor == 0;
}

struct Model {
  Scene scene = makeScene(heldScene(7));
  Feti feti = makeFeti(Tpetra::getDefaultComm(), scene);
  std::vector<double> q;

  Model() {
    for (std::size_t i = 0; i < localNumElements(*feti.map()); ++i)
      q.push_back(1.5 + std::sin(double(feti.map()->getGlobalElement(LocalOrdinal(i)))));
  }
  CoarseProblem::Placement place(const CoarseOptions& options) const {
    return std::make_shared<CoarsePlacement>(feti.comm, feti.G->dimension(), options);
  }
};

// C^T diag(q) C b, summed over the ranks
inline Dense gathered(const CoarseRows& C, const Dense& b, const std::vector<double>& q) {
  const Dense mine = C.transpose() * (Eigen::Map<const Eigen::VectorXd>(q.data(), Eigen::Index(q.size())).asDiagonal() * Dense(C * b));
  Dense sum(mine.rows(), mine.cols());
  Teuchos::reduceAll(*Tpetra::getDefaultComm(), Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), sum.data());
  return sum;
}

// b as a sum of different parts of the ranks.
inline Dense partOf(const Dense& b, const Communicator& comm) {
  const double ranks = comm.getSize(), mine = comm.getRank() + 1;
  return b * (2 * mine / (ranks * (ranks + 1)));
}

// A chain of subdomains; rows over the first few links change, each of them is a row of another rank.
struct Chain {
  static constexpr int kSubdomains = 40;
  RCP<const Communicator> comm = Tpetra::getDefaultComm();
  CoarseRows fixed, changing;
  std::vector<double> q;

  explicit Chain(int touched, int subdomains = kSubdomains) : fixed(12 * subdomains, 6 * subdomains), changing(fixed) {
    std::vector<Eigen::Triplet<double>> stays, changes;
    for (int row = comm->getRank(); row < fixed.rows(); row += comm->getSize()) {
      const int s = row / 12, first = std::max(0, 6 * (s - 1));
      const bool isChanging = s < touched && row % 12 >= 6;
      for (int j = first; j < 6 * (s + 1); ++j) (isChanging ? changes : stays).emplace_back(row, j, std::sin(1.7 * (row + 1) * (j + 1)) + (j == 6 * s + row % 6 ? 4 : 0));
    }
    fixed.setFromTriplets(stays.begin(), stays.end());
    changing.setFromTriplets(changes.begin(), changes.end());
    for (int row = 0; row < fixed.rows(); ++row) q.push_back(1.5 + std::sin(row));
  }
  CoarseProblem::Placement place(const CoarseOptions& options) const {
    return std::make_shared<CoarsePlacement>(comm, fixed.cols(), options);
  }
};

// C^T diag(q) C of all ranks' rows
inline Dense denseGram(const CoarseRows& C, const std::vector<double>& q) { return gathered(C, Dense::Identity(C.cols(), C.cols()), q); }

inline CoarseProblem::Holds twoHolds(Eigen::Index size) {
  CoarseProblem::Holds holds(2, Eigen::SparseVector<double>(size));
  for (int i = 0; i < 6; ++i) {
    holds[0].insert(i) = 0.3 + i;            // a subdomain that changes
    holds[1].insert(size - 6 + i) = 1 - 0.4 * i;  // and one that does not
  }
  return holds;
}

inline bool isSmall(const Dense& error, const Dense& wanted, double tolerance = 1e-11) {
  return error.allFinite() && largest(error) <= tolerance * largest(wanted);
}

}  // namespace Haptos::Testing
