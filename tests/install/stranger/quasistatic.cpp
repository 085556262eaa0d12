// SPDX-License-Identifier: BSD-3-Clause
// A stranger's nonlinear program on an installed Haptos: two blocks whose material softens with its shear strain are pressed on each
// other and sheared in steps.  Its own Newton loop,
//
//   K(u_k) u_k+1 = f - r(u_k) + K(u_k) u_k   with contact and friction,   r internal forces, K = dr/du,
//
// calls Haptos in every iteration with new matrices: their factors are made anew, the multipliers of the last iteration are where the next
// one starts.  The sum of what Haptos counted is compared with what systems made anew for every iteration would take.
#include <Haptos_ContactSystem.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <vector>

namespace {

using Haptos::GlobalOrdinal;
using Haptos::Vector;
using Teuchos::RCP;
using Point = std::array<double, 3>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector24 = Eigen::Matrix<double, 24, 1>;
using Matrix24 = Eigen::Matrix<double, 24, 24>;

constexpr int kSteps = 3, kAlong = 6, kAcross = 3, kUp = 3;  // load steps, elements of a block
constexpr double kFriction[2] = {0.3, 0.2};

// Stress = bulk part + 2 G(e) x deviator, G = G0 (0.3 + 0.7 / sqrt(1 + (e / e0)^2)), e^2 = 2/3 deviator : deviator; strains xx, yy, zz,
// 2 yz, 2 zx, 2 xy.
struct Response {
  Vector6 stress;
  Matrix6 tangent;
};

Response respond(const Vector6& strain) {
  constexpr double kBulk = 80, kShear = 40, kStrain = 2e-3;
  Vector6 one, weights;  // weights: shear strains are doubled
  one << 1, 1, 1, 0, 0, 0;
  weights << 1, 1, 1, 0.5, 0.5, 0.5;
  const double volume = one.dot(strain);
  const Vector6 deviator = weights.cwiseProduct(strain - volume / 3 * one);  // a tensor's entries
  const double e2 = 2.0 / 3 * (deviator.head<3>().squaredNorm() + 2 * deviator.tail<3>().squaredNorm());
  const double ratio = 1 + e2 / (kStrain * kStrain), G = kShear * (0.3 + 0.7 / std::sqrt(ratio));
  const double dG = -0.35 * kShear / std::pow(ratio, 1.5) / (kStrain * kStrain);  // / de2
  Response r;
  r.stress = kBulk * volume * one + 2 * G * deviator;
  r.tangent = kBulk * one * one.transpose() + 2 * G * Matrix6(weights.asDiagonal());
  r.tangent -= 2 * G / 3 * one * one.transpose();
  r.tangent += 2 * dG * (4.0 / 3) * deviator * deviator.transpose();  // de2 = 4/3 deviator : dstrain
  return r;
}

// Strains of a brick of the size h at a Gauss point, from its nodes by bits of x, y, z.
Eigen::Matrix<double, 6, 24> strainsAt(int p, const Point& h) {
  const double g = 1 / std::sqrt(3.0);
  const auto sign = [](int bits, int k) { return bits >> k & 1 ? 1.0 : -1.0; };
  Eigen::Matrix<double, 6, 24> B = Eigen::Matrix<double, 6, 24>::Zero();
  for (int i = 0; i < 8; ++i) {
    Point d;
    for (int k = 0; k < 3; ++k) {
      d[k] = sign(i, k) / (4 * h[k]);
      for (int l = 0; l < 3; ++l) d[k] *= l == k ? 1.0 : 1 + sign(i, l) * sign(p, l) * g;
    }
    B.block<6, 3>(0, 3 * i) << d[0], 0, 0, 0, d[1], 0, 0, 0, d[2], 0, d[2], d[1], d[2], 0, d[0], d[1], d[0], 0;
  }
  return B;
}

const Point kSize = {2.0 / kAlong, 1.0 / kAcross, 1.0 / kUp};
constexpr int kNodes = (kAlong + 1) * (kAcross + 1) * (kUp + 1);

GlobalOrdinal idOf(int body, int i, int j, int k) { return body * kNodes + (k * (kAcross + 1) + j) * (kAlong + 1) + i; }

// Half of a block: its elements, and its matrix, whose values change.
struct Part {
  int body;
  std::vector<GlobalOrdinal> nodes;
  std::vector<double> places;
  std::vector<std::array<int, 8>> elements;  // local nodes
  RCP<Haptos::CrsMatrix> K;
};

Part makePart(int body, int half) {
  Part part{body, {}, {}, {}, {}};
  std::map<GlobalOrdinal, int> local;
  const int first = half * kAlong / 2, last = (half + 1) * kAlong / 2;
  for (int k = 0; k <= kUp; ++k)
    for (int j = 0; j <= kAcross; ++j)
      for (int i = first; i <= last; ++i) {
        local[idOf(body, i, j, k)] = int(part.nodes.size());
        part.nodes.push_back(idOf(body, i, j, k));
        for (double x : {i * kSize[0], j * kSize[1], k * kSize[2] + body}) part.places.push_back(x);
      }
  for (int k = 0; k < kUp; ++k)
    for (int j = 0; j < kAcross; ++j)
      for (int i = first; i < last; ++i) {
        part.elements.emplace_back();
        for (int n = 0; n < 8; ++n) part.elements.back()[n] = local[idOf(body, i + (n & 1), j + (n >> 1 & 1), k + (n >> 2))];
      }
  const auto self = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
  part.K = Teuchos::rcp(new Haptos::CrsMatrix(Teuchos::rcp(new Haptos::Map(Tpetra::global_size_t(3 * part.nodes.size()), 0, self)), 192));
  return part;
}

class Blocks {
 public:
  explicit Blocks(const RCP<const Haptos::Communicator>& comm) : comm_(comm), u_(Eigen::VectorXd::Zero(6 * kNodes)) {
    for (int p = 0; p < 8; ++p) B_.push_back(strainsAt(p, kSize));
    for (int i = 0; i < 4; ++i)
      if (i % comm->getSize() == comm->getRank()) parts_.push_back(makePart(i / 2, i % 2));
  }

  // K at u, and f - r + K u on all ranks' nodes.
  Eigen::VectorXd linearize(double load) {
    Eigen::VectorXd mine = Eigen::VectorXd::Zero(u_.size()), all(mine.size());
    for (auto& part : parts_) {
      if (part.K->isFillComplete()) {
        part.K->resumeFill();
        part.K->setAllToScalar(0.0);
      }
      for (const auto& element : part.elements) addElement(part, element, mine);
      part.K->fillComplete();
    }
    Teuchos::reduceAll(*comm_, Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), all.data());
    return all + loads(load);
  }

  std::unique_ptr<Haptos::ContactSystem> makeSystem() const {
    const auto parameters = Teuchos::rcp(new Teuchos::ParameterList);
    parameters->sublist("Solver").set("Relative Tolerance", 1e-10);
    auto system = std::make_unique<Haptos::ContactSystem>(comm_, parameters);
    for (const auto& part : parts_)
      system->addSubdomain({part.body, Teuchos::arrayViewFromVector(part.nodes), Teuchos::arrayViewFromVector(part.places), part.K});
    Haptos::FrictionSpec friction;
    friction.law = Haptos::FrictionLaw::Coulomb;
    friction.coefficients = {kFriction[0], kFriction[1]};
    const int joint = system->addInterface("joint", friction);
    if (comm_->getRank() != 0) return system;
    for (int j = 0; j <= kAcross; ++j) {
      for (int i = 1; i <= kAlong; ++i)
        system->addPair({joint, idOf(1, i, j, 0), {{idOf(0, i, j, kUp), 1.0}}, {0, 0, -1}, {1, 0, 0}});
      for (int body = 0; body < 2; ++body)
        for (int k = 0; k <= kUp; ++k)
          for (int d = 0; d < 3; ++d) system->prescribe(idOf(body, 0, j, k), d, 0.0);
    }
    return system;
  }

  // u_k+1 on all ranks.
  Eigen::VectorXd solve(Haptos::ContactSystem& system, const Eigen::VectorXd& right) {
    system.setUp();
    Vector f(system.map()), u(system.map());
    for (int i = 0; i < int(f.getLocalLength()); ++i) f.replaceLocalValue(i, right[system.map()->getGlobalElement(i)]);
    outcome = system.solve(f, u);
    Eigen::VectorXd mine = Eigen::VectorXd::Zero(u_.size()), all(mine.size());
    const auto data = u.getData(0);
    for (int i = 0; i < int(data.size()); ++i) mine[system.map()->getGlobalElement(i)] = data[i];
    Teuchos::reduceAll(*comm_, Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), all.data());
    return all;
  }

  const Eigen::VectorXd& u() const { return u_; }
  void moveTo(const Eigen::VectorXd& u) { u_ = u; }
  long parts() const {
    long mine = long(parts_.size()), all = 0;
    Teuchos::reduceAll(*comm_, Teuchos::REDUCE_SUM, mine, Teuchos::outArg(all));
    return all;
  }

  // Forces that nothing of the program's own accounts for: f - r(u), 0 where nothing touches and nothing is held.
  Eigen::VectorXd unbalanced(double load) const {
    Eigen::VectorXd mine = Eigen::VectorXd::Zero(u_.size()), all(mine.size());
    for (const auto& part : parts_)
      for (const auto& element : part.elements) {
        const Vector24 ue = displacementsOf(part, element);
        for (const auto& B : B_) add(part, element, -kSize[0] * kSize[1] * kSize[2] / 8 * B.transpose() * respond(B * ue).stress, mine);
      }
    Teuchos::reduceAll(*comm_, Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), all.data());
    return all + loads(load);
  }

  Haptos::ContactSystem::Outcome outcome;

 private:
  Vector24 displacementsOf(const Part& part, const std::array<int, 8>& element) const {
    Vector24 ue;
    for (int i = 0; i < 24; ++i) ue[i] = u_[3 * part.nodes[std::size_t(element[i / 3])] + i % 3];
    return ue;
  }

  static void add(const Part& part, const std::array<int, 8>& element, const Vector24& fe, Eigen::VectorXd& f) {
    for (int i = 0; i < 24; ++i) f[3 * part.nodes[std::size_t(element[i / 3])] + i % 3] += fe[i];
  }

  void addElement(Part& part, const std::array<int, 8>& element, Eigen::VectorXd& right) const {
    const Vector24 ue = displacementsOf(part, element);
    Matrix24 Ke = Matrix24::Zero();
    Vector24 re = Vector24::Zero();
    for (const auto& B : B_) {
      const Response response = respond(B * ue);
      const double weight = kSize[0] * kSize[1] * kSize[2] / 8;
      Ke += weight * B.transpose() * response.tangent * B;
      re += weight * B.transpose() * response.stress;
    }
    add(part, element, Ke * ue - re, right);
    std::array<GlobalOrdinal, 24> rows;
    for (int i = 0; i < 24; ++i) rows[i] = 3 * element[i / 3] + i % 3;
    for (int i = 0; i < 24; ++i) {
      if (part.K->hasColMap()) part.K->sumIntoGlobalValues(rows[i], 24, Ke.col(i).data(), rows.data());
      else part.K->insertGlobalValues(rows[i], 24, Ke.col(i).data(), rows.data());
    }
  }

  static Eigen::VectorXd loads(double load) {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(6 * kNodes);
    for (int j = 0; j <= kAcross; ++j)
      for (int i = 0; i <= kAlong; ++i)
        for (int d = 0; d < 3; ++d) f[3 * idOf(1, i, j, kUp) + d] = load * std::array<double, 3>{0.006, 0.003, -0.01}[std::size_t(d)];
    return f;
  }

  RCP<const Haptos::Communicator> comm_;
  std::vector<Eigen::Matrix<double, 6, 24>> B_;
  std::vector<Part> parts_;
  Eigen::VectorXd u_;
};

struct Totals {
  int iterations = 0;
  long factoredFirst = 0;     // at u = 0 parts are alike and share factors
  long warm = 0, cold = 0;  // multiplications
  bool solved = true;
};

// Newton until u stays; every iteration is also solved by a system made anew.
void solveStep(Blocks& blocks, std::unique_ptr<Haptos::ContactSystem>& system, double load, Totals& totals) {
  constexpr int kMost = 12;
  for (int k = 0; k < kMost; ++k) {
    const Eigen::VectorXd right = blocks.linearize(load);
    const bool isFirst = !system;
    if (isFirst) system = blocks.makeSystem();
    else system->updateStiffness();
    const auto fresh = blocks.makeSystem();
    const Eigen::VectorXd alone = blocks.solve(*fresh, right);
    totals.cold += blocks.outcome.multiplications;
    const Eigen::VectorXd next = blocks.solve(*system, right);
    totals.warm += blocks.outcome.multiplications;
    totals.solved = totals.solved && blocks.outcome.solved && (next - alone).lpNorm<Eigen::Infinity>() < 1e-8 * next.lpNorm<Eigen::Infinity>();
    if (isFirst) totals.factoredFirst = system->counters().factorizations;
    ++totals.iterations;
    const double change = (next - blocks.u()).lpNorm<Eigen::Infinity>() / next.lpNorm<Eigen::Infinity>();
    blocks.moveTo(next);
    if (change < 1e-9) return;
  }
  totals.solved = false;
}

// Equilibrium by the program's own integrals: what is unbalanced on contact nodes is opposite on both sides and within the cone.
double examine(const Blocks& blocks, double load, int& slipping) {
  Eigen::VectorXd g = blocks.unbalanced(load);
  const double scale = g.lpNorm<Eigen::Infinity>();
  double worst = 0;
  for (int j = 0; j <= kAcross; ++j)
    for (int i = 1; i <= kAlong; ++i) {
      const GlobalOrdinal upper = 3 * idOf(1, i, j, 0), lower = 3 * idOf(0, i, j, kUp);
      for (int d = 0; d < 3; ++d) {
        worst = std::max(worst, std::abs(g[upper + d] + g[lower + d]));
        g[lower + d] = 0;
      }
      const double N = -g[upper + 2], level = std::hypot(g[upper] / kFriction[0], g[upper + 1] / kFriction[1]);
      worst = std::max({worst, -N, kFriction[0] * (level - N)});
      slipping += N > 1e-6 * scale && level > (1 - 1e-6) * N;
      g.segment<3>(upper).setZero();
    }
  for (int body = 0; body < 2; ++body)
    for (int k = 0; k <= kUp; ++k)
      for (int j = 0; j <= kAcross; ++j) g.segment<3>(3 * idOf(body, 0, j, k)).setZero();  // reactions
  return std::max(worst, g.lpNorm<Eigen::Infinity>()) / scale;
}

bool run(const RCP<const Haptos::Communicator>& comm) {
  Blocks blocks(comm);
  std::unique_ptr<Haptos::ContactSystem> system;
  Totals totals;
  double worst = 0;
  int slipping = 0;
  for (int step = 1; step <= kSteps; ++step) {
    solveStep(blocks, system, double(step) / kSteps, totals);
    worst = std::max(worst, examine(blocks, double(step) / kSteps, slipping));
  }
  const auto counters = system->counters();
  const bool counted = totals.factoredFirst > 0 &&
                       counters.factorizations == totals.factoredFirst + (totals.iterations - 1) * blocks.parts() && counters.rows == totals.iterations &&
                       counters.multiplications == totals.warm && blocks.outcome.multiplications <= 5;
  const Eigen::Vector3d tip = blocks.u().segment<3>(3 * idOf(1, kAlong, kAcross, kUp));
  if (comm->getRank() == 0)
    std::printf("tip %.6e %.6e %.6e; %d iterations, %ld multiplications, %ld by systems made anew, %ld at last; %d slip; unbalanced %.1e; counted: %s; solved: %s\n",
                tip[0], tip[1], tip[2], totals.iterations, totals.warm, totals.cold, blocks.outcome.multiplications, slipping, worst,
                counted ? "yes" : "no", totals.solved ? "yes" : "no");
  return totals.solved && counted && worst < 1e-8 && slipping > 3 && 4 * totals.warm <= 3 * totals.cold && totals.iterations > 3 * kSteps;
}

}  // namespace

int main(int argc, char* argv[]) {
  Tpetra::ScopeGuard scope(&argc, &argv);
  return run(Tpetra::getDefaultComm()) ? 0 : 1;
}
