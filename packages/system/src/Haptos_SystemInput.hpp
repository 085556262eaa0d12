// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "Haptos_ContactSystem.hpp"
#include "Haptos_ElementCut.hpp"
#include "Haptos_NodeNumbering.hpp"
#include "Haptos_OwnStiffness.hpp"

namespace Haptos {

/// \brief What callers of a ContactSystem added on this rank, and its way into a SystemModel.
class SystemInput {
 public:
  explicit SystemInput(RCP<const Communicator> comm) : comm_(std::move(comm)) {}

  struct Interface {
    std::string name;
    FrictionSpec friction;

    /// see ByteWriter; without the gaps in memory between them, as they are compared
    auto parts() { return std::tie(name, friction.law, friction.coefficients, friction.slipBound, friction.tied); }
  };
  struct Subdomain {
    int body;
    std::vector<std::int64_t> ids;
    OwnStiffness::Part part;
  };

  std::vector<Interface> interfaces;
  std::vector<Subdomain> subdomains;
  std::vector<ElementMatrix> elements;
  std::map<std::int64_t, std::array<double, 3>> places;  ///< of the elements' nodes, by id
  std::map<std::pair<std::int64_t, int>, double> prescribed;
  std::vector<PairInput> pairs;

  /// \brief Cuts elements, numbers subdomains and nodes, and checks all stiffnesses.  Collective.
  SystemModel deal(const DecompositionOptions& options);
  /// \brief Rows of B for today's pairs and prescribed values.  Collective.
  /// \throws InsufficientModel on all ranks where these make surfaces overlap
  RCP<const MultiplierMap> makeRows();
  /// \brief Takes today's values of matrices or elements, and checks them.  Collective.
  void readStiffness();

  std::shared_ptr<const SubdomainStiffness> stiffness() const { return stiffness_; }
  std::vector<FrictionSpec> friction() const;
  std::vector<std::string> names() const;  ///< of the interfaces
  void checkInterfaces() const;            ///< Collective
  const std::vector<PrescribedDisplacement>& prescribedHere() const { return prescribedHere_; }  ///< see StepData
  const RCP<const Map>& map() const { return map_; }
  std::string nameOfNode(std::int64_t number) const;  ///< its id; Collective
  const std::vector<int>& firstOfInterface() const { return firstOfInterface_; }  ///< [interfaces] of this rank's pairs

  /// \brief Loads on `map` shared by the copies of a node, on the primal map.  Collective.
  RCP<Vector> spread(const Vector& f, const RCP<const Map>& primal) const;
  /// \brief u := mean of the copies.  Collective.
  void average(const Vector& copies, Vector& u) const;

 private:
  void checkKind() const;
  void checkBodiesOfNodes(const std::vector<std::int64_t>& numbers) const;
  std::vector<std::string> nameBodies() const;
  void checkPairs() const;
  void numberNodes();
  void mapNodes(const std::vector<std::int64_t>& ids);
  std::vector<PrescribedDisplacement> collectPrescribed() const;
  std::vector<PlacedPair> placePairs(double size);
  double size() const;  // [length] of the model; Collective

  void dealSubdomains();

  RCP<const Communicator> comm_;
  DecompositionOptions options_;
  std::vector<Subdomain> dealt_;  // this rank's
  int first_ = 0;                 // global number of the first
  NodeNumbering numbering_;
  std::vector<std::vector<std::int64_t>> nodes_;  // [dealt] numbers
  std::shared_ptr<const OwnStiffness> stiffness_;
  RCP<const Map> map_, overlap_;      // 3 x id + component: one to one, and all on this rank
  std::vector<int> overlapOfCopy_;    // [copies of nodes] first row in overlap_
  std::vector<double> copies_;        // [overlap nodes] in how many subdomains of all ranks a node lies
  std::vector<PrescribedDisplacement> prescribedHere_;
  std::shared_ptr<const NodalGather> gather_;
  std::vector<int> firstOfInterface_;
};

}  // namespace Haptos
