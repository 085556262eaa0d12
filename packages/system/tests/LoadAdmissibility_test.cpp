// SPDX-License-Identifier: BSD-3-Clause
// A block on a clamped one, held by contact and friction alone: which loads can it carry?
#include "Haptos_LoadAdmissibility.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>

#include "../../feti/tests/FetiScene.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_PairLaws.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

using Force = std::function<Point(const Point&)>;  // on one node of the upper block, by its place

class Block {
 public:
  Block(const FrictionSpec& friction, int subdomains = 4) : scene_(makeScene(options(friction, subdomains))) {
    feti_ = makeFeti(Tpetra::getDefaultComm(), scene_);
    law_ = std::make_unique<ContactLaw>(makeContactLaw(*feti_.dealt.multipliers, {friction}));
    bodies_ = std::make_unique<BodyMotions>(bodyMotions(feti_, scene_));
    std::vector<char> holds;
    for (const RowKind kind : feti_.dealt.multipliers->kinds()) holds.push_back(isEquality(kind));
    floating_ = findUnheldMotions(*feti_.comm, feti_.G->rows(), bodies_->Z(), holds);
    std::map<std::int64_t, int> copies;
    for (const auto& sub : scene_.subdomains)
      for (auto node : sub.nodes) ++copies[node];
    copies_ = copies;
  }

  /// What the check says to these nodal forces; "" if it lets them pass.
  std::string refusal(const Force& force) const {
    const auto offsets = scene_.offsets();
    Eigen::VectorXd f = Eigen::VectorXd::Zero(offsets.back());
    for (const auto& sub : scene_.subdomains)
      for (int i = 0; i < sub.numNodes() && sub.body == 1; ++i)
        for (int d = 0; d < 3; ++d)
          f[offsets[sub.id] + 3 * i + d] = force(sub.coordinates[i])[d] / copies_.at(sub.nodes[i]);
    const auto load = scattered(feti_.dealt.jump->getDomainMap(), f);
    try {
      requireAdmissibleLoads(*law_, floating_, *feti_.G, feti_.G->restrictLoad(*load, *feti_.systems), *bodies_, load->norm2());
    } catch (const InsufficientModel& e) {
      return e.what();
    }
    return "";
  }

 private:
  static SceneOptions options(const FrictionSpec& friction, int subdomains) {
    SceneOptions o;
    o.lower = {3, 2, 1};
    o.upper = {3, 2, 2};
    o.subdomains = subdomains;
    o.frictional = friction.law != FrictionLaw::Frictionless;
    o.hold = [](int body, const Point& x) { return std::string(body == 0 && x[2] < -1 + 1e-9 ? "xyz" : ""); };
    return o;
  }

  Scene scene_;
  Feti feti_;
  std::unique_ptr<ContactLaw> law_;
  std::unique_ptr<BodyMotions> bodies_;
  UnheldMotions floating_;
  std::map<std::int64_t, int> copies_;
};

// The same force on every node of the foot, so that no moment turns the block.
Force onFoot(const Point& force) {
  return [=](const Point& x) { return x[2] < 1e-9 ? force : Point{0, 0, 0}; };
}

// On the top: a moment of force times height 1 about the foot.
Force onTop(const Point& force) {
  return [=](const Point& x) { return x[2] > 1 - 1e-9 ? force : Point{0, 0, 0}; };
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

// ANALYTIC: under the weight N a force along t is carried up to N / || F^-1 t ||.
TEUCHOS_UNIT_TEST(LoadAdmissibility, SlidingLimitOfAnOrthotropicBlock) {
  const std::array<double, 2> F{0.3, 0.15};
  const Block block({FrictionLaw::Coulomb, F, 0});
  for (double degrees : {0.0, 30.0, 45.0, 77.0, 90.0}) {
    const double a = degrees * M_PI / 180, t[2] = {std::cos(a), std::sin(a)};
    const double limit = 1.0 / std::hypot(t[0] / F[0], t[1] / F[1]);
    TEST_EQUALITY(block.refusal(onFoot({0.98 * limit * t[0], 0.98 * limit * t[1], -1})), "");
    const std::string message = block.refusal(onFoot({1.02 * limit * t[0], 1.02 * limit * t[1], -1}));
    out << message << "\n";
    TEST_ASSERT(contains(message, "body 'upper'") && contains(message, "translation along"));
  }
}

// ANALYTIC, the same with a coefficient next to nothing: the other direction still carries what it carries.
TEUCHOS_UNIT_TEST(LoadAdmissibility, SlidingLimitOfAFlatCone) {
  for (const std::array<double, 2> F : {std::array<double, 2>{1.3e-4, 0.38}, {0.17, 8e-5}, {2.4e-5, 0.18}, {0.3, 0.0}}) {
    const Block block({FrictionLaw::Coulomb, F, 0});
    for (double degrees : {0.0, 2.0, 30.0, 80.0, 90.0}) {
      const double a = degrees * M_PI / 180, t[2] = {std::cos(a), F[1] > 0 ? std::sin(a) : 0};
      const double limit = 1.0 / std::hypot(t[0] / F[0], F[1] > 0 ? t[1] / F[1] : 0);
      for (double part : {0.06, 0.26, 0.5, 0.98}) TEST_EQUALITY(block.refusal(onTop({part * limit * t[0], part * limit * t[1], -1})), "");
      if (limit * t[0] > 0) TEST_INEQUALITY(block.refusal(onFoot({2 * limit * t[0], 2 * limit * t[1], -1})), "");
    }
  }
}

// The motion that is named slides along the force (and lifts: the law is associated).
TEUCHOS_UNIT_TEST(LoadAdmissibility, NamesTheDirectionOfSlip) {
  const Block block({FrictionLaw::Coulomb, {0.3, 0.15}, 0});
  const std::string alongX = block.refusal(onFoot({0.5, 0, -1})), alongY = block.refusal(onFoot({0, -0.5, -1}));
  out << alongX << "\n" << alongY << "\n";
  TEST_ASSERT(contains(alongX, "translation along (0.96, 0, 0.29)"));
  TEST_ASSERT(contains(alongY, "translation along (0, -0.99, 0.15)"));
}

// ANALYTIC: with friction enough a force at height 1 tips the block over its front edge at 0.75 N.
TEUCHOS_UNIT_TEST(LoadAdmissibility, TippingLimit) {
  const Block block({FrictionLaw::Coulomb, {2.0, 2.0}, 0});
  TEST_EQUALITY(block.refusal(onTop({0.98 * 0.75, 0, -1})), "");
  const std::string message = block.refusal(onTop({1.02 * 0.75, 0, -1}));
  out << message << "\n";
  TEST_ASSERT(contains(message, "body 'upper'") && contains(message, "rotation"));
}

TEUCHOS_UNIT_TEST(LoadAdmissibility, LiftedOrPushedWithoutFriction) {
  const Block frictionless({FrictionLaw::Frictionless, {0, 0}, 0});
  TEST_EQUALITY(frictionless.refusal(onFoot({0, 0, -1})), "");
  TEST_ASSERT(contains(frictionless.refusal(onFoot({0, 0, 1})), "translation along (0, 0, 1)"));
  const Block coulomb({FrictionLaw::Coulomb, {0.3, 0.3}, 0});
  TEST_ASSERT(contains(coulomb.refusal(onFoot({0, 0, 0.01})), "body 'upper'"));
  TEST_EQUALITY(coulomb.refusal(onFoot({0, 0, 0})), "");
}

// One coefficient 0: nothing is carried in its direction, all of the other one along it.
TEUCHOS_UNIT_TEST(LoadAdmissibility, CoefficientZero) {
  const Block block({FrictionLaw::Coulomb, {0.3, 0.0}, 0});
  TEST_EQUALITY(block.refusal(onFoot({0.98 * 0.3, 0, -1})), "");
  TEST_ASSERT(block.refusal(onFoot({0.1, 0.01, -1})) != "");
}

// ANALYTIC: Tresca carries slip bound x F x area whatever the weight; the foot has the area 1.5.
TEUCHOS_UNIT_TEST(LoadAdmissibility, TrescaLimit) {
  const Block block({FrictionLaw::Tresca, {0.3, 0.2}, 4.0});
  const double perNode = 4.0 * 0.2 * 1.5 / 12;
  TEST_EQUALITY(block.refusal(onFoot({0, 0.98 * perNode, -1})), "");
  TEST_ASSERT(block.refusal(onFoot({0, 1.02 * perNode, -1})) != "");
}

TEUCHOS_UNIT_TEST(LoadAdmissibility, UnitsAndCutDoNotMatter) {
  for (double unit : {1e-6, 1e9})
    for (int subdomains : {2, 7}) {
      const Block block({FrictionLaw::Coulomb, {0.3, 0.15}, 0}, subdomains);
      TEST_EQUALITY(block.refusal(onFoot({0.98 * 0.3 * unit, 0, -unit})), "");
      TEST_ASSERT(block.refusal(onFoot({1.02 * 0.3 * unit, 0, -unit})) != "");
    }
}
