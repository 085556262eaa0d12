// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_AssembledPreconditioner.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <limits>

#include "Haptos_AssemblyOnRoot.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_RowGram.hpp"

namespace Haptos {
namespace {

// Of both triangles, and of what each is gathered from.
double bytesOfStiffness(const LocalSystems& systems) {
  constexpr double kBytes = 64;
  double entries = 0;
  for (int s = 0; s < systems.size(); ++s) entries += double(systems.stiffness(systems[s].congruenceClass).nonZeros());
  return kBytes * entries;
}

constexpr double kDenseFaster = 4;  // a dense factor, and products with its matrix, in the same time

// The bodies are factored once with pairs closed, and some thirty times by contact models, where these are not dense.
bool isWithin(const AssembledPreconditioner::Limits& limits, const FactorWork& work) {
  constexpr double kModels = 30, kFactors = 2;
  const double flops = kFactors * work.flops + kModels * std::min(work.flops, limits.denseModel / kDenseFaster);
  return work.flops > 0 && flops <= limits.flops && kFactors * work.entries * double(sizeof(double)) <= limits.bytes;
}

// Whether work ends with a factor that is one.
template <class Work>
bool isUseful(Work&& work) try {
  work();
  return true;
} catch (const UselessFactor&) {
  return false;
}

}  // namespace

AssembledPreconditioner::AssembledPreconditioner(RCP<const DualPreconditioner> scaling, RCP<const LocalSystems> systems)
    : scaling_(std::move(scaling)), systems_(std::move(systems)) {}

const Communicator& AssembledPreconditioner::comm() const { return *getDomainMap()->getComm(); }

// Forces of rows that depend on each other are not told by displacements.
RCP<const AssembledPreconditioner> AssembledPreconditioner::make(const RCP<const DualPreconditioner>& scaling, const RCP<const LocalSystems>& systems,
                                                                 const Limits& limits) {
  const auto made = Teuchos::rcp(new AssembledPreconditioner(scaling, systems));
  if (anyOfAll(made->comm(), !scaling->gram().pairs().dependent().empty())) return {};
  if (sumOfAll(made->comm(), bytesOfStiffness(*systems)) > limits.bytes) return {};
  if (!made->assemble(limits)) return {};
  return made;
}

// What rank 0 finds all ranks are told.
bool AssembledPreconditioner::assemble(const Limits& limits) {
  AssembledStiffness::Parts parts = assembleOnRoot(scaling_->jump(), *systems_);
  struct Found {
    int size = 0;
    bool isDenseCheaper = false;
  } found;
  runOnAllRanks(comm(), [&] {
    if (comm().getRank() != 0) return;
    bodies_ = std::make_unique<AssembledStiffness>(std::move(parts));
    if (!isWithin(limits, bodies_->work())) return;
    if (isUseful([this] { bodies_->factor(); })) found = {int(bodies_->size()), limits.denseModel <= kDenseFaster * bodies_->work().flops};
  });
  found = broadcasted(comm(), found);
  numContinuous_ = found.size, isDenseCheaper_ = found.isDenseCheaper;
  return numContinuous_ > 0;
}

// Values of all ranks, rank after rank, become others in the same places.
Eigen::VectorXd AssembledPreconditioner::onRoot(const Eigen::VectorXd& mine, const ContactMap& map) const {
  const auto sizes = gatheredOnRoot(comm(), std::vector<std::int64_t>{mine.size()});
  const auto all = gatheredOnRoot(comm(), std::vector<double>(mine.data(), mine.data() + mine.size()));
  std::vector<std::vector<double>> parts;
  if (comm().getRank() == 0) {
    const Eigen::VectorXd values = map(Eigen::Map<const Eigen::VectorXd>(all.data(), Eigen::Index(all.size())));
    const double* at = values.data();
    for (const auto size : sizes) parts.emplace_back(at, at + size), at += size;
  }
  const auto result = scattered(comm(), parts);
  return Eigen::Map<const Eigen::VectorXd>(result.data(), mine.size());
}

void AssembledPreconditioner::multiplyByK(MultiVector& t) const {
  const auto& offsets = scaling_->jump().primalOffsets();
  const auto data = t.getDataNonConst(0);
  for (int s = 0; s < systems_->size(); ++s) {
    const auto& K = systems_->stiffness((*systems_)[s].congruenceClass);
    Eigen::Map<Eigen::VectorXd> part(data.getRawPtr() + offsets[std::size_t(s)], K.rows());
    part = (K * part).eval();
  }
}

// B_D K (t + w), t = B_D^T x
void AssembledPreconditioner::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const {
  MultiVector t(scaling_->jump().getDomainMap(), 1, false), f(t.getMap(), 1, false), z(x.getMap(), 1, false);
  const auto column = [](const MultiVector& v) {
    const auto data = v.getData(0);
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(data.getRawPtr(), Eigen::Index(data.size())));
  };
  for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
    scaling_->spread(*x.getVector(v), t);
    f.update(1.0, t, 0.0);
    multiplyByK(f);
    const Eigen::VectorXd w = onRoot(column(f), [this](const Eigen::VectorXd& forces) { return bodies_->relax(forces); });
    {
      const auto data = t.getDataNonConst(0);
      Eigen::Map<Eigen::VectorXd>(data.getRawPtr(), Eigen::Index(data.size())) += w;
    }
    multiplyByK(t);
    scaling_->collect(t, z);
    y.getVectorNonConst(v)->update(alpha, z, beta);
    ++applications_;
  }
}

Eigen::VectorXd AssembledPreconditioner::onContact(const Eigen::VectorXd& jumps) const {
  return onRoot(jumps, [this](const Eigen::VectorXd& all) { return bodies_->forcesOf(all); });
}

Eigen::MatrixXd AssembledPreconditioner::contactMatrix() const {
  Eigen::MatrixXd M;
  runOnAllRanks(comm(), [&] {
    if (comm().getRank() == 0) M = bodies_->contactMatrix();
  });
  const auto rows = broadcasted(comm(), M.rows());
  if (comm().getRank() != 0) M = Eigen::MatrixXd::Zero(rows, rows);
  return sumOfAll(comm(), M);
}

AssembledPreconditioner::ContactMap AssembledPreconditioner::solverWith(const std::vector<Eigen::Matrix3d>& D) const {
  constexpr int kEntries = 9;
  std::vector<double> mine;
  for (const Eigen::Matrix3d& block : D) mine.insert(mine.end(), block.data(), block.data() + kEntries);
  const auto all = gatheredOnRoot(comm(), mine);
  bool isFactored = true;  // of use on rank 0
  runOnAllRanks(comm(), [&] {
    if (comm().getRank() != 0) return;
    std::vector<Eigen::Matrix3d> blocks;
    for (std::size_t at = 0; at < all.size(); at += kEntries) blocks.emplace_back(Eigen::Map<const Eigen::Matrix3d>(all.data() + at));
    isFactored = isUseful([&] { bodies_->setD(blocks); });
  });
  return [this, isFactored](const Eigen::VectorXd& y) {
    return onRoot(y, [&](const Eigen::VectorXd& values) -> Eigen::VectorXd {
      if (!isFactored) return Eigen::VectorXd::Constant(values.size(), std::numeric_limits<double>::quiet_NaN());
      return bodies_->solveWithD(values);
    });
  };
}

}  // namespace Haptos
