// SPDX-License-Identifier: BSD-3-Clause
// Small decomposed scenes; every rank builds the whole, so dense references need no communication.
#pragma once
#include <Eigen/Core>
#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_DefaultSerialComm.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_ContactPairs.hpp"
#include "Haptos_JumpOperator.hpp"
#include "Haptos_Partition.hpp"
#include "Haptos_StiffnessAssembler.hpp"
#include "Haptos_LinearElasticity.hpp"
#include "Haptos_TpetraCompat.hpp"
#include "SerialRows.hpp"

namespace Haptos::Testing {

using Dense = Eigen::MatrixXd;
using Point = std::array<double, 3>;

/// A mesh, its cut and all rows of B.
struct Scene {
  Mesh mesh;
  OwnElements own;
  DualGraph graph;
  Bodies bodies;
  Partition partition;
  std::vector<Subdomain> subdomains;
  std::vector<IsotropicMaterial> materials;
  std::vector<PrescribedDisplacement> prescribed;
  std::vector<ContactInterface> interfaces;
  bool frictional = true;
  ConstraintRows rows;

  std::vector<int> offsets() const {  // first dof of every subdomain, and the total
    std::vector<int> result{0};
    for (const auto& sub : subdomains) result.push_back(result.back() + sub.numDofs());
    return result;
  }
};

struct SceneOptions {
  std::array<int, 3> lower{3, 3, 2}, upper{3, 3, 2};
  bool hasUpper = true;
  double distortion = 0.1;  ///< of the element size, inside the bodies
  int subdomains = 5;
  bool bricks = false;      ///< one part a body instead of METIS' ones
  bool contact = true, frictional = true;
  Point friction{1, 0, 0};  ///< principal direction
  double gap = 0;
  double height = 1;        ///< of each body: 1 / 50 makes plates
  /// Components prescribed at a node of a body (0 lower, 1 upper) and their values; none by default.
  std::function<std::string(int body, const Point& x)> hold = [](int, const Point&) { return std::string(); };
  std::function<Point(const Point& x)> value = [](const Point& x) { return Point{0.1 * x[0], -0.2 * x[1], 0.3 * x[0]}; };
};

inline BoxSpec sceneBox(const std::string& name, const std::array<int, 3>& divisions, double zLow, double distortion) {
  BoxSpec box;
  box.blockName = name;
  box.lower = {0, 0, zLow};
  box.upper = {1.5, 1, zLow + 1};
  box.divisions = divisions;
  box.sideSetNames = {name + "_x0", name + "_x1", "", "", name + "_z0", name + "_z1"};
  box.map = [=](const Point& x) {
    const double bubble = std::sin(M_PI * x[0] / 1.5) * std::sin(M_PI * x[1]) * std::sin(M_PI * (x[2] - zLow));
    Point y = x;
    for (int d = 0; d < 3; ++d) y[d] += distortion / divisions[d] * bubble * std::sin(5.0 * x[0] + 7.0 * x[1] + 3.0 * x[2] + d);
    return y;
  };
  return box;
}

inline Mesh sceneMesh(const SceneOptions& o) {
  std::vector<BoxSpec> boxes{sceneBox("lower", o.lower, -1, o.distortion)};
  if (o.hasUpper) {
    boxes.push_back(sceneBox("upper", o.upper, 0, o.distortion));
    boxes.back().map = [inner = boxes.back().map, gap = o.gap](const Point& x) {
      Point y = inner(x);
      y[2] += gap;
      return y;
    };
  }
  for (auto& box : boxes)
    box.map = [inner = box.map, height = o.height](const Point& x) {
      const Point y = inner(x);
      return Point{y[0], y[1], height * y[2]};
    };
  return makeBoxes(boxes);
}

inline std::vector<PrescribedDisplacement> prescribe(const SceneOptions& o, const Mesh& mesh) {
  std::vector<int> bodyOfNode(mesh.numNodes(), 0);
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b)
    for (auto node : mesh.blocks[b].connectivity) bodyOfNode[node] = int(b);
  std::vector<PrescribedDisplacement> result;
  for (std::size_t node = 0; node < mesh.numNodes(); ++node) {
    const auto& x = mesh.coordinates[node];
    const std::string held = o.hold(bodyOfNode[node], x);
    for (int d = 0; d < 3; ++d)
      if (held.find(char('x' + d)) != std::string::npos) result.push_back({std::int64_t(node), d, o.value(x)[d]});
  }
  return result;
}

inline void buildRows(Scene& scene) {
  scene.rows = buildConstraintRows(scene.mesh, scene.subdomains, scene.prescribed, scene.interfaces,
                                   std::vector<char>(scene.interfaces.size(), char(scene.frictional)), {7.0, 21.0});
}

inline void cutScene(Scene& scene, const PartitionOptions& cut) {
  const Teuchos::SerialComm<int> alone;
  scene.own = wholeMesh(scene.mesh);
  scene.graph = buildDualGraph(alone, scene.own);
  scene.bodies = findBodies(alone, scene.own, scene.graph);
  scene.partition = partitionMesh(alone, scene.own, scene.graph, scene.bodies, cut);
}

inline Scene makeScene(const SceneOptions& o) {
  Scene scene;
  scene.mesh = sceneMesh(o);
  PartitionOptions cut;
  cut.method = o.bricks ? PartitionMethod::Block : PartitionMethod::Metis;
  cut.subdomains = o.bricks ? 0 : o.subdomains;
  cutScene(scene, cut);
  std::vector<int> materialOfBlock;
  for (std::size_t b = 0; b < scene.mesh.blocks.size(); ++b) materialOfBlock.push_back(int(b));
  scene.subdomains = extractSubdomains(scene.mesh, scene.partition, materialOfBlock);
  scene.materials = {{"soft", 7.0, 0.3}, {"hard", 21.0, 0.25}};
  scene.prescribed = prescribe(o, scene.mesh);
  if (o.contact && o.hasUpper) {
    ContactSpec spec;
    spec.name = "interface";
    spec.secondarySideSet = "upper_z0";
    spec.primarySideSet = "lower_z1";
    spec.principalDirection = o.friction;
    scene.interfaces = buildContact(scene.mesh, {spec});
  }
  scene.frictional = o.frictional;
  buildRows(scene);
  return scene;
}

/// Two bodies whose matching nodes are paired anew: lists on both sides whose nodes other pairs use too, with axes of their own;
/// tied pairs, single ones and lists; a rigid obstacle.  Some nodes are prescribed in one component, on one side or on both, and
/// some rows are left out that would reach others.
inline Scene makeListScene(bool frictional = true, int subdomains = 7) {
  SceneOptions o;
  o.lower = o.upper = {5, 4, 2};
  o.subdomains = subdomains;
  o.frictional = frictional;
  o.hold = [](int body, const Point& x) {
    const bool edge = x[0] < 1e-9, middle = std::abs(x[2]) < 1e-9;
    if (body == 0) return std::string(x[2] < -1 + 1e-9 || (edge && x[1] < 1e-9) ? "xyz" : edge && middle ? "x" : "");
    return std::string(x[2] > 1 - 1e-9 ? "z" : edge ? "x" : x[0] > 1.5 - 1e-9 && middle ? "y" : "");
  };
  Scene scene = makeScene(o);
  const auto matching = scene.interfaces.front().pairs;
  const int n = int(matching.size());
  const auto node = [&](int side, int i) {
    const ContactPair& pair = matching[std::size_t(i % n)];
    return side == 0 ? pair.secondary.front().node : pair.primary.front().node;
  };
  scene.interfaces.assign(3, {});
  const char* const names[] = {"lists", "bonded", "plane"};
  for (int k = 0; k < 3; ++k) scene.interfaces[std::size_t(k)].name = names[k];
  scene.interfaces[1].tied = true;
  for (int i = 0; i < n; ++i) {
    const int kind = i < n / 2 ? 0 : i < 4 * n / 5 ? 1 : 2;
    ContactPair pair = matching[std::size_t(i)];
    if (kind == 0) {
      pair.frame = makeFrame({0.1 * i, 0.2, -1.0}, {1, 0.1 * i, 0});
      pair.secondary = {{node(0, i), 0.75}, {node(0, i + 1), 0.25}};
    }
    if (kind == 0 || (kind == 1 && i % 2 == 0)) {
      pair.primary.clear();
      for (int j = 0; j < 7; ++j) pair.primary.push_back({node(1, i + 2 * j), (j + 1) / 25.0});  // they sum to more than 1
    }
    if (kind == 2) pair.primary.clear();
    pair.gap = 0.01 * i;
    if (kind < 2 && i % 3 == 0) pair.isPinned[i % 2 == 0 ? 1 : 2] = 1;
    scene.interfaces[std::size_t(kind)].pairs.push_back(pair);
  }
  buildRows(scene);
  return scene;
}

/// B as a dense matrix; columns are the dofs of subdomain after subdomain.
inline Dense denseB(const Scene& scene) {
  const auto offsets = scene.offsets();
  Dense B = Dense::Zero(scene.rows.numRows(), offsets.back());
  for (GlobalOrdinal row = 0; row < scene.rows.numRows(); ++row)
    for (auto k = scene.rows.offsets[row]; k < scene.rows.offsets[row + 1]; ++k) {
      const RowEntry& entry = scene.rows.entries[k];
      B(row, offsets[entry.subdomain] + entry.dof) += entry.value;
    }
  return B;
}

/// What one rank holds of a scene.
struct Dealt {
  std::vector<int> rankOf;
  std::vector<Subdomain> mine;
  int first = 0;
  RCP<const MultiplierMap> multipliers;
  RCP<const JumpOperator> jump;
};

/// Prescribed values and pairs come from all ranks in turns.
inline RowSources rowSources(const Communicator& comm, const Scene& scene, const std::vector<Subdomain>& mine) {
  RowSources sources;
  for (const auto& sub : mine) sources.subdomains.push_back({sub.id, sub.nodes, nodalStiffness(sub.coordinates, sub.groups, {7.0, 21.0})});
  const auto isMine = [&](std::size_t i) { return int(i) % comm.getSize() == comm.getRank(); };
  for (std::size_t i = 0; i < scene.prescribed.size(); ++i)
    if (isMine(i)) sources.prescribed.push_back(scene.prescribed[i]);
  const auto pairs = placedPairs(scene.interfaces);
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (isMine(i)) sources.pairs.push_back(pairs[i]);
  for (const auto& interface : scene.interfaces) sources.interfaces.push_back({interface.name, interface.tied, scene.frictional});
  return sources;
}

inline Dealt deal(const RCP<const Communicator>& comm, const Scene& scene) {
  Dealt dealt;
  std::vector<double> work;
  for (const auto& sub : scene.subdomains) work.push_back(sub.numNodes());
  dealt.rankOf = dealToRanks(work, comm->getSize());
  std::vector<int> sizes;
  for (const auto& sub : scene.subdomains) {
    if (dealt.rankOf[sub.id] < comm->getRank()) ++dealt.first;
    if (dealt.rankOf[sub.id] != comm->getRank()) continue;
    dealt.mine.push_back(sub);
    sizes.push_back(sub.numDofs());
  }
  dealt.multipliers = Teuchos::rcp(new MultiplierMap(comm, rowSources(*comm, scene, dealt.mine)));
  dealt.jump = Teuchos::rcp(new JumpOperator(dealt.multipliers, dealt.first, sizes));
  return dealt;
}

/// The whole of a vector on all ranks, by global index; 0 where its map has no row.
inline Dense gathered(const MultiVector& v) {
  const auto& map = *v.getMap();
  Dense mine = Dense::Zero(Eigen::Index(map.getMaxAllGlobalIndex()) + 1, Eigen::Index(v.getNumVectors())), all = mine;
  for (std::size_t c = 0; c < v.getNumVectors(); ++c) {
    const auto data = v.getData(c);
    for (int i = 0; i < int(data.size()); ++i) mine(map.getGlobalElement(i), Eigen::Index(c)) = data[i];
  }
  Teuchos::reduceAll(*map.getComm(), Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), all.data());
  return all;
}

inline RCP<Vector> scattered(const RCP<const Map>& map, const Eigen::VectorXd& whole) {
  auto v = Teuchos::rcp(new Vector(map));
  const auto data = v->getDataNonConst(0);
  for (int i = 0; i < int(data.size()); ++i) data[i] = whole[map->getGlobalElement(i)];
  return v;
}

inline RCP<MultiVector> scatteredColumns(const RCP<const Map>& map, const Dense& whole) {
  auto v = Teuchos::rcp(new MultiVector(map, std::size_t(whole.cols())));
  for (Eigen::Index c = 0; c < whole.cols(); ++c) {
    const auto data = v->getDataNonConst(std::size_t(c));
    for (int i = 0; i < int(data.size()); ++i) data[i] = whole(map->getGlobalElement(i), c);
  }
  return v;
}

/// The same on all ranks; values in [-1, 1].
inline Eigen::VectorXd someVector(Eigen::Index n, double seed = 1.0) {
  Eigen::VectorXd v(n);
  for (Eigen::Index i = 0; i < n; ++i) v[i] = std::sin(seed + 7.3 * double(i) * double(i % 17 + 1));
  return v;
}

inline Dense someColumns(Eigen::Index n, Eigen::Index columns) {
  Dense v(n, columns);
  for (Eigen::Index c = 0; c < columns; ++c) v.col(c) = someVector(n, 1.0 + double(c));
  return v;
}

inline double largest(const Dense& a) { return a.size() ? a.cwiseAbs().maxCoeff() : 0.0; }

}  // namespace Haptos::Testing
