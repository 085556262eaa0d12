// SPDX-License-Identifier: BSD-3-Clause
// A stranger's own elements on an installed Haptos: two blocks of a layered (transversely isotropic) material that Haptos does
// not know, pressed on each other and heated in ten steps.  Contact with friction, one factorisation, half of the ranks.
#include <Haptos_ContactSystem.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

namespace {

using Haptos::GlobalOrdinal;
using Haptos::Vector;
using Teuchos::RCP;
using Point = std::array<double, 3>;

constexpr int kSteps = 10, kAlong = 6, kAcross = 3, kUp = 3;  // elements of a block
constexpr double kLength = 2, kFriction[2] = {0.3, 0.2};

// Stresses by strains (xx, yy, zz, yz, zx, xy) of a material that is the same in all directions of the xy plane.
Eigen::Matrix<double, 6, 6> layered() {
  const double Ep = 100, Et = 30, nup = 0.3, nut = 0.1, Gt = 12;  // in the plane, across it
  Eigen::Matrix<double, 6, 6> S = Eigen::Matrix<double, 6, 6>::Zero();
  S.topLeftCorner<3, 3>() << 1 / Ep, -nup / Ep, -nut / Et, -nup / Ep, 1 / Ep, -nut / Et, -nut / Et, -nut / Et, 1 / Et;
  S.diagonal().tail<3>() << 1 / Gt, 1 / Gt, 2 * (1 + nup) / Ep;
  return S.inverse();
}

// Stretch for a degree: layers swell across themselves.
Eigen::Matrix<double, 6, 1> swelling() {
  Eigen::Matrix<double, 6, 1> a;
  a << 1e-4, 1e-4, 5e-4, 0, 0, 0;
  return a;
}

struct Brick {
  Eigen::Matrix<double, 24, 24> K = Eigen::Matrix<double, 24, 24>::Zero();
  Eigen::Matrix<double, 24, 1> heat = Eigen::Matrix<double, 24, 1>::Zero();  // forces for a degree
};

// All elements are alike: a brick of the size h, 2 x 2 x 2 Gauss points.
Brick makeBrick(const Point& h) {
  Brick brick;
  const auto C = layered();
  const double g = 1 / std::sqrt(3.0), volume = h[0] * h[1] * h[2] / 8;
  for (int p = 0; p < 8; ++p) {
    const Point xi = {p & 1 ? g : -g, p & 2 ? g : -g, p & 4 ? g : -g};
    Eigen::Matrix<double, 6, 24> B = Eigen::Matrix<double, 6, 24>::Zero();
    for (int i = 0; i < 8; ++i) {
      const Point s = {i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0};
      Point d;  // derivatives of shape function i
      for (int k = 0; k < 3; ++k) d[k] = s[k] / 4 / h[k] * (1 + s[(k + 1) % 3] * xi[(k + 1) % 3]) * (1 + s[(k + 2) % 3] * xi[(k + 2) % 3]);
      B.block<6, 3>(0, 3 * i) << d[0], 0, 0, 0, d[1], 0, 0, 0, d[2], 0, d[2], d[1], d[2], 0, d[0], d[1], d[0], 0;
    }
    brick.K += volume * B.transpose() * C * B;
    brick.heat += volume * B.transpose() * C * swelling();
  }
  return brick;
}

// The blocks' grids: nodes are numbered by body and place.
struct Grid {
  Point h = {kLength / kAlong, 1.0 / kAcross, 1.0 / kUp};
  static GlobalOrdinal id(int body, int i, int j, int k) { return ((GlobalOrdinal(body) * (kUp + 1) + k) * (kAcross + 1) + j) * (kAlong + 1) + i; }
  Point place(int body, int i, int j, int k) const { return {i * h[0], j * h[1], k * h[2] + body}; }
};

struct Loads {
  RCP<Vector> heat, press;  // for a degree, for full pressure and shear on top
};

class Layers {
 public:
  explicit Layers(const RCP<const Haptos::Communicator>& comm) : comm_(comm), brick_(makeBrick(grid_.h)) {
    const auto parameters = Teuchos::rcp(new Teuchos::ParameterList);
    parameters->sublist("Solver").set("Relative Tolerance", 1e-8);
    parameters->sublist("Decomposition").set("Subdomains", 6);
    system_ = std::make_unique<Haptos::ContactSystem>(comm, parameters);
    addElements();
    addContact();
    system_->setUp();
    makeLoads();
  }

  // Displacement of the far end of the upper block; the state is kept from step to step.
  Point solve(int step) {
    const double t = double(step) / kSteps;
    Vector f(system_->map()), u(system_->map());
    f.update(20 * t * t, *loads_.heat, t, *loads_.press, 0.0);
    outcome = system_->solve(f, u);
    Point mine = {0, 0, 0}, all;
    for (int d = 0; d < 3; ++d) {
      const auto row = system_->map()->getLocalElement(3 * Grid::id(1, kAlong, kAcross, kUp) + d);
      if (row != Teuchos::OrdinalTraits<Haptos::LocalOrdinal>::invalid()) mine[d] = u.getData(0)[row];
    }
    Teuchos::reduceAll(*comm_, Teuchos::REDUCE_SUM, 3, mine.data(), all.data());
    return all;
  }

  long factorizations() const { return system_->counters().factorizations; }
  Haptos::ContactSystem::Outcome outcome;

 private:
  // Elements are dealt to the ranks in turn; the system cuts them.
  template <class Visit>
  void forMyElements(Visit&& visit) const {
    int count = 0;
    for (int body = 0; body < 2; ++body)
      for (int k = 0; k < kUp; ++k)
        for (int j = 0; j < kAcross; ++j)
          for (int i = 0; i < kAlong; ++i) {
            if (count++ % comm_->getSize() != comm_->getRank()) continue;
            std::array<GlobalOrdinal, 8> nodes;
            std::array<double, 24> places;
            for (int n = 0; n < 8; ++n) {
              nodes[n] = Grid::id(body, i + (n & 1), j + (n >> 1 & 1), k + (n >> 2 & 1));
              const Point x = grid_.place(body, i + (n & 1), j + (n >> 1 & 1), k + (n >> 2 & 1));
              for (int d = 0; d < 3; ++d) places[3 * n + d] = x[d];
            }
            visit(body, nodes, places);
          }
  }

  void addElements() {
    forMyElements([&](int body, const auto& nodes, const auto& places) {
      const Teuchos::ArrayView<const GlobalOrdinal> ids(nodes.data(), 8);
      system_->addNodes(ids, Teuchos::ArrayView<const double>(places.data(), 24));
      system_->addElement(body, ids, Teuchos::ArrayView<const double>(brick_.K.data(), 576));
    });
  }

  void addContact() {
    Haptos::FrictionSpec friction;
    friction.law = Haptos::FrictionLaw::Coulomb;
    friction.coefficients = {kFriction[0], kFriction[1]};
    const int interface = system_->addInterface("joint", friction);
    if (comm_->getRank() != 0) return;
    for (int j = 0; j <= kAcross; ++j) {
      for (int i = 1; i <= kAlong; ++i)
        system_->addPair({interface, Grid::id(1, i, j, 0), {{Grid::id(0, i, j, kUp), 1.0}}, {0, 0, -1}, {1, 0, 0}});
      for (int body = 0; body < 2; ++body)
        for (int k = 0; k <= kUp; ++k)
          for (int d = 0; d < 3; ++d) system_->prescribe(Grid::id(body, 0, j, k), d, 0.0);
    }
  }

  void makeLoads() {
    loads_ = {Teuchos::rcp(new Vector(system_->map())), Teuchos::rcp(new Vector(system_->map()))};
    Haptos::MultiVector unused(system_->map(), 1);
    std::vector<double> heat(3 * 2 * std::size_t(Grid::id(1, 0, 0, 0)), 0.0), sum(heat);
    forMyElements([&](int, const auto& nodes, const auto&) {
      for (int n = 0; n < 8; ++n)
        for (int d = 0; d < 3; ++d) heat[std::size_t(3 * nodes[n] + d)] += brick_.heat[3 * n + d];
    });
    Teuchos::reduceAll(*comm_, Teuchos::REDUCE_SUM, int(heat.size()), heat.data(), sum.data());
    const auto h = loads_.heat->getDataNonConst(0), p = loads_.press->getDataNonConst(0);
    for (int row = 0; row < int(h.size()); ++row) {
      const GlobalOrdinal unknown = system_->map()->getGlobalElement(row);
      h[row] = sum[std::size_t(unknown)];
      const bool isTop = unknown / 3 >= Grid::id(1, 0, 0, kUp);
      if (isTop) p[row] = std::array<double, 3>{0.05, 0.02, -0.15}[std::size_t(unknown % 3)];
    }
  }

  RCP<const Haptos::Communicator> comm_;
  Grid grid_;
  Brick brick_;
  std::unique_ptr<Haptos::ContactSystem> system_;
  Loads loads_;
};

bool run(const RCP<const Haptos::Communicator>& comm) {
  Layers layers(comm);
  long warm = 0, cold = 0, factored = 0;
  double worst = 0;
  bool solved = true;
  Point tip{};
  for (int step = 1; step <= kSteps; ++step) {
    tip = layers.solve(step);
    warm += layers.outcome.multiplications;
    solved = solved && layers.outcome.solved;
    if (step == 1) factored = layers.factorizations();
    Layers fresh(comm);  // the same step by itself
    const Point alone = fresh.solve(step);
    cold += fresh.outcome.multiplications;
    for (int d = 0; d < 3; ++d) worst = std::max(worst, std::abs(tip[d] - alone[d]) / std::hypot(tip[0], tip[1], tip[2]));
  }
  const bool once = factored > 0 && layers.factorizations() == factored;
  if (comm->getRank() == 0)
    std::printf("tip %.4e %.4e %.4e; multiplications %ld in a row, %ld one by one; difference %.1e; factored once: %s; solved: %s\n", tip[0],
                tip[1], tip[2], warm, cold, worst, once ? "yes" : "no", solved ? "yes" : "no");
  return solved && once && worst < 1e-5 && 3 * warm <= 2 * cold;
}

}  // namespace

int main(int argc, char* argv[]) {
  Tpetra::ScopeGuard scope(&argc, &argv);
  const auto world = Tpetra::getDefaultComm();
  const int half = (world->getSize() + 1) / 2;
  const auto mine = world->split(world->getRank() < half ? 0 : -1, world->getRank());  // the others have something else to do
  int good = mine.is_null() || run(mine), all = 0;
  Teuchos::reduceAll(*world, Teuchos::REDUCE_MIN, good, Teuchos::outArg(all));
  return all ? 0 : 1;
}
