// SPDX-License-Identifier: BSD-3-Clause
// The table of the scenes: what each one changes on the benchmark, and how it must end.
#include "Scenes.hpp"

#include <cmath>
#include <stdexcept>
#include <tuple>

namespace Haptos::Scenes {
namespace {

using Loads = std::vector<SceneLoad>;

const std::vector<SceneHold> onlyLowerClamped{{"lower_clamp", "xyz"}};

// The upper body is held at x = 2 and moved by `value`.
std::vector<SceneHold> heldAtOtherEnd(std::array<double, 3> value) {
  return {{"lower_clamp", "xyz"}, {"upper_end", "xyz", value}};
}

// Both bodies are squeezed together near the clamps and pulled apart at the free ends.
Loads squeeze() {
  return {{"upper_top", true, {100, 0, 0}, true}, {"lower_bottom", true, {100, 0, 0}, true}, {"upper_end", false, {10, 10, 10}}};
}

// Pressed together everywhere with 200 in all, pulled sideways at the end face (area 1).
Loads pushed(std::array<double, 3> traction) {
  return {{"upper_top", true, {100, 0, 0}}, {"lower_bottom", true, {100, 0, 0}}, {"upper_end", false, traction}};
}

class Table {
 public:
  template <class Change>
  void add(const std::string& name, const std::string& what, Change&& change) {
    Scene scene;
    scene.name = name;
    scene.group = group_;
    scene.what = what;
    scene.loads = squeeze();
    change(scene);
    scenes_.push_back(std::move(scene));
  }
  void group(const std::string& name) { group_ = name; }
  std::vector<Scene> take() { return std::move(scenes_); }

 private:
  std::string group_;
  std::vector<Scene> scenes_;
};

void addGeometry(Table& table) {
  table.group("Contact that may or may not be there");
  table.add("base", "the benchmark itself: stick, slip and open pairs, clamped pairs pinned", [](Scene& s) {
    s.p = 3;
    s.atLeast = {10, 10, 10};
  });
  table.add("base-small", "the same with the smallest bricks, k = 1", [](Scene& s) {
    s.k = 1;
    s.atLeast = {1, 1, 1};
  });
  table.add("touching-at-zero-force", "both bodies stretched alike (nu = 0): surfaces touch, nothing presses", [](Scene& s) {
    s.young = {6.9e4, 6.9e4};
    s.poisson = {0, 0};
    s.loads = {{"upper_end", false, {100, 0, 0}}, {"lower_end", false, {100, 0, 0}}};
    s.onlyState = "open";
  });
  table.add("no-contact-in-reach", "the upper body stands beside the lower one: no pair", [](Scene& s) {
    s.shift = 5;
    s.status = 1;
    s.says = {"lower_contact", "lies opposite", "upper_contact"};
  });
  table.add("no-contact-section", "no contact in the input: two cantilevers", [](Scene& s) { s.contact = false; });
  table.add("separating", "the upper body is pulled off", [](Scene& s) {
    s.loads = {{"upper_top", true, {-100, 0, 0}}};
    s.onlyState = "open";
  });
  table.add("penetration", "the bodies start 1e-3 inside each other, the upper one held at its other end", [](Scene& s) {
    s.gap = -1e-3;
    s.holds = heldAtOtherEnd({0, 0, 0});
    s.loads.clear();
    s.atLeast = {0, 30, 5};
  });
  table.add("gap-1e-12", "a gap of 1e-12", [](Scene& s) {
    s.gap = 1e-12;
    s.atLeast = {5, 5, 5};
  });
  table.add("gap-1e-4", "a gap that the load closes in part", [](Scene& s) {
    s.gap = 1e-4;
    s.atLeast = {1, 1, 5};
  });
  table.add("gap-1e+3", "a gap of 1000, never closed", [](Scene& s) {
    s.gap = 1e3;
    s.onlyState = "open";
  });
  table.add("no-loads", "nothing acts", [](Scene& s) {
    s.loads.clear();
    s.onlyState = "open";
  });
}

void addFriction(Table& table) {
  table.group("Friction");
  const auto add = [&](const std::string& name, const std::string& what, std::array<double, 2> F, double angle, std::array<int, 3> least) {
    table.add(name, what, [=](Scene& s) {
      s.friction = F;
      s.direction = {std::cos(angle * M_PI / 180), std::sin(angle * M_PI / 180), 0};
      s.atLeast = least;
    });
  };
  table.add("frictionless", "no friction law: no tangential rows", [](Scene& s) {
    s.law = "Frictionless";
    s.atLeast = {0, 10, 5};
  });
  add("coefficients-0", "Coulomb with the coefficients 0, 0", {0, 0}, 0, {0, 10, 5});
  add("coefficients-0.3-0", "friction along x only", {0.3, 0}, 0, {1, 5, 5});
  add("coefficients-0-0.3-rotated", "friction along one axis at 30 degrees only", {0, 0.3}, 30, {1, 5, 5});
  add("coefficients-1", "coefficient 1", {1, 1}, 0, {5, 1, 5});
  add("coefficients-2", "coefficient 2", {2, 2}, 0, {5, 0, 5});
  add("coefficients-5", "coefficient 5", {5, 5}, 0, {5, 0, 5});
  add("ratio-10-rotated", "axis ratio 10 at 30 degrees", {0.5, 0.05}, 30, {1, 5, 5});
  add("ratio-1e2-rotated", "axis ratio 1e2 at 30 degrees", {0.5, 5e-3}, 30, {0, 10, 5});
  add("ratio-1e3-rotated", "axis ratio 1e3 at 30 degrees", {0.5, 5e-4}, 30, {0, 10, 5});
  add("ratio-1e6-rotated", "axis ratio 1e6 at 30 degrees", {0.5, 5e-7}, 30, {0, 10, 5});
  add("ratio-1e3-large", "axis ratio 1e3, the larger coefficient 5", {5, 5e-3}, 30, {0, 5, 5});
  table.add("direction-along-normal", "principal direction along the normal: the x axis takes its place", [](Scene& s) {
    s.friction = {0.5, 0.1};
    s.direction = {0, 0, 1};
    s.atLeast = {1, 5, 5};
  });
  table.add("tresca", "Tresca's law, slip bound 20, also on open nodes", [](Scene& s) {
    s.law = "Tresca";
    s.slipBound = 20;
    s.friction = {0.5, 0.1};
    s.atLeast = {1, 1, 5};
  });
}

void addConstraints(Table& table) {
  table.group("Contact nodes that are held as well");
  table.add("half-clamped-pairs", "the upper body is held by contact alone: pairs at x = 0 have one clamped side", [](Scene& s) {
    s.holds = onlyLowerClamped;
    s.loads = pushed({8, 5, 0});
    s.atLeast = {5, 1, 0};
  });
  table.add("rigid-foundation", "all contact nodes of the lower body are clamped", [](Scene& s) {
    s.holds.push_back({"lower_contact", "xyz"});
    s.atLeast = {1, 10, 5};
  });
  table.add("roller-on-contact", "contact nodes of the upper body held along y: one direction of friction is pinned", [](Scene& s) {
    s.holds = {{"lower_clamp", "xyz"}, {"upper_contact", "y"}};
    s.loads = pushed({8, 0, 0});
    s.atLeast = {5, 5, 0};
  });
  table.add("dragged-across", "contact nodes held along y on one body and moved along it on the other, an axis of friction: all slide, and x is free", [](Scene& s) {
    s.holds = {{"lower_clamp", "xyz"}, {"lower_contact", "y"}, {"upper_contact", "y", {0, 2e-3, 0}}};
    s.friction = {0.3, 0.1};
    s.loads = pushed({8, 0, 0});
    s.atLeast = {0, 10, 0};
  });
  table.add("rollers-along-normal", "contact nodes of both bodies held along z: every normal row is pinned", [](Scene& s) {
    s.holds.push_back({"lower_contact", "z"});
    s.holds.push_back({"upper_contact", "z"});
    s.onlyState = "open";
  });
  table.add("moved-clamp", "the upper body is held at its other end, which moves: no loads but displacements", [](Scene& s) {
    s.loads.clear();
    s.holds = heldAtOtherEnd({1e-4, 5e-5, -2e-3});
    s.friction = {1, 1};
    s.atLeast = {1, 10, 0};
  });
  table.add("clamps-overlap", "clamped pairs that penetrate: no solution", [](Scene& s) {
    s.holds[1].value = {0, 0, -1e-3};
    s.status = 3;
    s.says = {"no solution", "overlap"};
  });
}

void addMaterials(Table& table) {
  table.group("Materials");
  const auto contrast = [&](const std::string& name, const std::string& what, std::array<double, 2> young) {
    table.add(name, what, [=](Scene& s) {
      s.young = young;
      s.atLeast = {1, 10, 5};
    });
  };
  contrast("upper-stiffer-1e6", "upper body 1e6 times stiffer", {6.9e4, 6.9e10});
  contrast("lower-stiffer-1e6", "lower body 1e6 times stiffer", {6.9e10, 6.9e4});
  table.add("upper-stiffer-1e6-floating", "the same, the stiff body held by contact alone", [](Scene& s) {
    s.young = {6.9e4, 6.9e10};
    s.holds = onlyLowerClamped;
    s.loads = pushed({8, 5, 0});
    s.tolerance = 1e-8;  // a nearly degenerate solution: amplification 1e6
    s.atLeast = {5, 5, 0};
  });
  table.add("lower-stiffer-1e6-floating", "the soft body held by contact alone", [](Scene& s) {
    s.young = {6.9e10, 6.9e4};
    s.holds = onlyLowerClamped;
    s.loads = pushed({8, 5, 0});
    s.atLeast = {5, 5, 0};
  });
  for (const auto& [name, nu] : {std::pair{"nu-0.49", 0.49}, {"nu-0.499", 0.499}, {"nu-0.4999", 0.4999}})
    table.add(name, std::string("both bodies nearly incompressible"), [nu = nu](Scene& s) {
      s.poisson = {nu, nu};
      s.atLeast = {1, 10, 5};
    });
  table.add("nu-0.4999-lower", "one body nearly incompressible", [](Scene& s) { s.poisson = {0.4999, 0.277}; });
}

void addFloating(Table& table) {
  table.group("Upper body held by contact and friction alone");
  const auto add = [&](const std::string& name, const std::string& what, std::array<double, 3> traction, auto change) {
    table.add(name, what, [=](Scene& s) {
      s.holds = onlyLowerClamped;
      s.loads = pushed(traction);
      change(s);
    });
  };
  add("floating-stuck", "all closed pairs stick", {4, 2, 0}, [](Scene& s) {
    s.friction = {2, 2};
    s.atLeast = {40, 0, 0};
  });
  add("floating-partly-slipping", "about half of them slip", {25, 15, 0}, [](Scene& s) {
    s.friction = {0.6, 0.3};
    s.direction = {std::cos(20 * M_PI / 180), std::sin(20 * M_PI / 180), 0};
    s.atLeast = {5, 5, 0};
  });
  add("floating-0.98-of-limit", "pulled with 0.98 of 0.3 times the normal force 200", {58.8, 0, 0}, [](Scene& s) { s.atLeast = {1, 30, 0}; });
  add("floating-0.999-of-limit", "pulled with 0.999 of it", {59.94, 0, 0}, [](Scene& s) { s.atLeast = {0, 35, 0}; });
  add("floating-beyond-limit", "pulled with 1.01 of it", {60.6, 0, 0}, [](Scene& s) {
    s.status = 3;
    s.says = {"upper", "translation along (0.96, 0, 0.29)", "no solution"};
  });
  add("floating-frictionless-pushed", "pushed sideways without friction", {5, 0, 0}, [](Scene& s) {
    s.law = "Frictionless";
    s.status = 3;
    s.says = {"upper", "translation along (1, 0, 0)", "no solution"};
  });
  add("floating-frictionless-pressed", "pressed without friction: displacements in the plane are free, forces are not", {0, 0, 0}, [](Scene& s) {
    s.law = "Frictionless";
    s.displacementsAreUnique = false;
    s.atLeast = {0, 40, 0};
  });
  add("floating-gap", "a gap that the body must cross as a rigid one", {4, 2, 0}, [](Scene& s) {
    s.gap = 0.01;
    s.friction = {0.6, 0.6};
    s.atLeast = {5, 0, 0};
  });
  add("floating-no-loads", "nothing acts on a body that only touches", {0, 0, 0}, [](Scene& s) {
    s.loads.clear();
    s.onlyState = "open";
    s.displacementsAreUnique = false;
  });
  add("floating-pulled-off", "the loads pull it away from its only support", {0, 0, 0}, [](Scene& s) {
    s.loads = {{"upper_top", true, {-100, 0, 0}}};
    s.status = 3;
    s.says = {"upper", "translation along (0, 0, 1)", "no solution"};
  });
  add("nothing-holds", "no contact and no clamp on the loaded upper body", {0, 0, 0}, [](Scene& s) {
    s.contact = false;
    s.status = 3;
    s.says = {"upper", "translation along (0, 0, 1)", "held by nothing"};
  });
  add("floating-in-two", "the upper block is two bodies, both held by friction", {8, 5, 0}, [](Scene& s) {
    s.upperInTwo = true;
    s.decomposition = "METIS";
    s.subdomains = 12;
    s.atLeast = {5, 1, 0};
  });
}

void addDecompositions(Table& table) {
  table.group("Decompositions and meshes");
  table.add("jagged-parts", "METIS, 13 parts", [](Scene& s) {
    s.decomposition = "METIS";
    s.subdomains = 13;
    s.atLeast = {5, 5, 5};
  });
  table.add("one-element-each", "METIS, one element per subdomain", [](Scene& s) {
    s.k = 1;
    s.decomposition = "METIS";
    s.subdomains = 32;
    s.atLeast = {1, 1, 1};
  });
  table.add("one-subdomain-each", "one subdomain per body", [](Scene& s) {
    s.decomposition = "Block";
    s.atLeast = {5, 5, 5};
  });
  table.add("disconnected-parts", "the upper block is two bodies, clamped at both ends", [](Scene& s) {
    s.upperInTwo = true;
    s.decomposition = "METIS";
    s.subdomains = 9;
    s.holds.push_back({"upper_end", "xyz"});
    s.loads = {{"upper_top", true, {100, 0, 0}, true}, {"lower_bottom", true, {100, 0, 0}, true}, {"lower_end", false, {10, 10, -10}}};
    s.atLeast = {1, 1, 1};
  });
  table.add("skewed", "distorted elements", [](Scene& s) {
    s.skew = true;
    s.atLeast = {5, 5, 5};
  });
  for (const auto& [name, what, cut] :
       {std::tuple{"needles-standing", "needle elements of aspect 100 across the contact, one subdomain per body", "Block"},
        {"needles-standing-bricks", "the same, cut into bricks that are needles themselves", "Bricks"}})
    table.add(name, what, [cut = cut](Scene& s) {
      s.decomposition = cut;
      s.stretch = {0.01, 0.01, 1};
      s.holds = {{"lower_bottom", "xyz"}, {"upper_top", "xyz", {1e-4, 5e-5, -1e-3}}};
      s.loads.clear();
      s.atLeast = {1, 10, 0};
      s.tolerance = 1e-7;  // amplification 2e4: kkt 1e-6 would allow forces that are wrong by 2 %
    });
  table.add("needles-lying", "needle elements of aspect 100 along the beam", [](Scene& s) {
    s.stretch = {100, 1, 1};
    s.atLeast = {5, 1, 5};
  });
  table.add("needles-no-contact", "the same beams without contact", [](Scene& s) {
    s.stretch = {100, 1, 1};
    s.contact = false;
  });
  table.add("plates-lying", "flat elements of aspect 100 on the contact", [](Scene& s) {
    s.stretch = {1, 1, 0.01};
    s.atLeast = {10, 0, 5};
  });
  table.add("plates-no-contact", "the same plates without contact", [](Scene& s) {
    s.stretch = {1, 1, 0.01};
    s.contact = false;
  });
  for (const auto& [name, what, element] : {std::tuple{"inverted-element", "one element turned inside out", 49},
                                            {"inverted-at-contact", "the same, at the contact surface", 100}})
    table.add(name, what, [element = element](Scene& s) {
      s.invertedElement = element;
      s.status = 1;
      s.says = {"element " + std::to_string(element + 1), "inverted"};
    });
  table.group("Units");
  table.add("units-mm-N", "millimetres and newtons", [](Scene& s) { s.p = 3; });
  table.add("units-m-Pa", "the same body in metres and pascals", [](Scene& s) {
    s.p = 3;
    s.length = 1e-3;
    s.twin = "units-mm-N";
  });
  table.add("units-tiny", "lengths in 1e-9, forces in 1e6 of that", [](Scene& s) {
    s.p = 3;
    s.length = 1e-9;
    s.force = 1e6;
    s.twin = "units-mm-N";
  });
}

std::vector<Scene> makeTable() {
  Table table;
  addGeometry(table);
  addFriction(table);
  addConstraints(table);
  addMaterials(table);
  addFloating(table);
  addDecompositions(table);
  return table.take();
}

}  // namespace

const std::vector<Scene>& allScenes() {
  static const std::vector<Scene> scenes = makeTable();
  return scenes;
}

const Scene& findScene(const std::string& name) {
  for (const auto& scene : allScenes())
    if (scene.name == name) return scene;
  throw std::invalid_argument("no scene is called '" + name + "'");
}

}  // namespace Haptos::Scenes
