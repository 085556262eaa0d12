// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "Haptos_Error.hpp"
#include "Haptos_FrictionFields.hpp"
#include "Haptos_ModelBuilder.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_Subdomain.hpp"
#include "Haptos_UnpairedNodes.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

// Throws the message of the first bad element, if there is one.
void checkElements(const Mesh& mesh) {
  std::int64_t first = 0;
  for (const auto& block : mesh.blocks) {
    ElementGroup group;
    group.topology = block.topology;
    group.blockName = block.name.empty() ? std::to_string(block.id) : block.name;
    group.connectivity.assign(block.connectivity.begin(), block.connectivity.end());
    group.elementNumbers.assign(mesh.elementNumbers.begin() + first, mesh.elementNumbers.begin() + first + group.numElements());
    first += group.numElements();
    checkElements(mesh.coordinates, group);
  }
}

// Sides of these sets, by element, or none.
std::vector<char> elementsAt(const Mesh& mesh, const std::vector<ContactSpec>& contacts) {
  std::vector<char> isAt(mesh.numElements(), 0);
  for (const auto& contact : contacts)
    for (const auto& name : {contact.secondarySideSet, contact.primarySideSet}) {
      int set = -1;
      try {
        set = findSideSet(mesh, name);
      } catch (const InputError&) {  // of several sets of that name; the pairing refuses it
      }
      if (set < 0) continue;
      for (const auto& side : mesh.sideSets[std::size_t(set)].sides) isAt[std::size_t(side.element)] = 1;
    }
  return isAt;
}

void renumber(const std::function<std::int64_t(std::int64_t)>& numberOf, ContactPair& pair) {
  pair.secondaryNode = numberOf(pair.secondaryNode);
  for (auto* side : {&pair.secondary, &pair.primary})
    for (auto& item : *side) item.node = numberOf(item.node);
}

// Pairs beside those of the geometry, from numbers of the whole mesh; their axes are those of their nodes.
void addLatePairs(const std::vector<ContactPair>& late, const std::vector<std::int64_t>& nodes, const ContactSpec& spec, ContactInterface& interface) {
  const auto hereOf = [&](std::int64_t node) { return std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin(); };
  for (ContactPair pair : late) {
    renumber(hereOf, pair);
    pair.frame = spec.frameAt(pair.secondaryNode, pair.frame.normal);
    interface.pairs.push_back(std::move(pair));
  }
  if (late.empty()) return;
  const auto before = [](const ContactPair& a, const ContactPair& b) { return a.secondaryNode < b.secondaryNode; };
  std::stable_sort(interface.pairs.begin(), interface.pairs.end(), before);
  interface.unpairedNodes -= late.size();
  interface.unpaired->drop([&](const ContactPair& open) { return std::binary_search(interface.pairs.begin(), interface.pairs.end(), open, before); });
  interface.remarks.push_back("'" + interface.name + "': " + std::to_string(late.size()) +
                              " nodes that nothing lies opposite at the start are carried into the other body; they have pairs with what they meet there");
}

// What all ranks report of the pairs.
void shareNotes(const Communicator& comm, const std::vector<ContactInterface>& interfaces, const std::vector<ContactOptions>& options,
                ModelData& data) {
  struct Told {
    std::size_t unpairedNodes;
    long tiedPairs;
    bool isMortar, isExchanged;
    std::array<double, 2> coefficients;  // largest, of pairs that have their own
    InitialOverlap overlap;
    std::vector<std::string> notes, remarks;

    auto parts() { return std::tie(unpairedNodes, tiedPairs, isMortar, isExchanged, coefficients, overlap, notes, remarks); }  // see ByteWriter
  };
  std::vector<Told> mine;
  for (const auto& interface : interfaces)
    mine.push_back({interface.unpairedNodes, long(interface.tied ? interface.pairs.size() : 0), interface.isMortar, interface.isExchanged,
                    largestCoefficients(interface), interface.overlap, interface.notes, interface.remarks});
  std::size_t k = 0;
  for (const Told& told : gatheredOnAll(comm, mine)) {
    FrictionSpec& friction = data.friction[k++];
    if (options[k - 1].friction.hasFields() && friction.law != FrictionLaw::Frictionless) {
      friction.coefficients = told.coefficients;
      if (friction.coefficients == std::array<double, 2>{0, 0}) friction.law = FrictionLaw::Frictionless;
    }
    data.unpairedNodes += told.unpairedNodes;
    data.tiedPairs += told.tiedPairs;
    data.isMortar.push_back(told.isMortar);
    data.isExchanged.push_back(told.isExchanged);
    data.overlaps.push_back(told.overlap);
    data.notes.insert(data.notes.end(), told.notes.begin(), told.notes.end());
    data.remarks.insert(data.remarks.end(), told.remarks.begin(), told.remarks.end());
  }
}

// What the pairing of these surfaces must know of materials and supports; complete on rank 0.  Collective.
ContactSurroundings surroundingsOf(const Communicator& comm, const OwnElements& own, const PartialMesh& surfaces,
                                   const std::vector<PrescribedDisplacement>& prescribed, const ModelDraft& draft) {
  ContactSurroundings around;
  for (int material : draft.materialOfBlock)
    around.youngsModulus.push_back(material < 0 ? 0.0 : draft.data.materials[std::size_t(material)].youngsModulus);
  const auto first = own.nodes.begin(own.rank);
  around.isPrescribed = RemoteValues(comm, own.nodes, surfaces.nodes).fetch([&](std::int64_t place) {
    std::array<char, 3> components{};
    const auto before = [](const PrescribedDisplacement& given, std::int64_t node) { return given.node < node; };
    for (auto at = std::lower_bound(prescribed.begin(), prescribed.end(), first + place, before);
         at != prescribed.end() && at->node == first + place; ++at)
      components[std::size_t(at->component)] = 1;
    return components;
  });
  return around;
}

// Empty: that of the geometry.  A tie has none.
std::function<double(std::int64_t)> gapFunction(const ContactOptions& contact, const Mesh& mesh) {
  if (!contact.gap || !contact.friction.law) return nullptr;
  return [gap = *contact.gap, &mesh](std::int64_t node) {
    const auto& x = mesh.coordinates[std::size_t(node)];
    return gap(x[0], x[1], x[2]);
  };
}

// Tells all ranks where nodes are to be that rank 0 moves.  Collective.
void moveNodes(const Communicator& comm, const std::vector<ContactInterface>& interfaces, PartialMesh& part) {
  std::vector<NodeMove> moves;
  for (const auto& interface : interfaces) moves.insert(moves.end(), interface.moves.begin(), interface.moves.end());
  for (const NodeMove& move : gatheredOnAll(comm, moves)) {
    const auto at = std::lower_bound(part.nodes.begin(), part.nodes.end(), move.node);
    if (at == part.nodes.end() || *at != move.node) continue;
    auto& x = part.mesh.coordinates[std::size_t(at - part.nodes.begin())];
    x = Vec3::add(x, move.by);
  }
}

}  // namespace

std::vector<ContactInterface> pairSurfaces(const Communicator& comm, const MeshShare& mesh, const std::vector<PrescribedDisplacement>& prescribed,
                                           OwnElements& own, ModelDraft& draft) {
  std::vector<int> rankOf;
  for (char isAt : elementsAt(own.part.mesh, draft.contacts)) rankOf.push_back(isAt ? 0 : -1);
  const PartialMesh surfaces = sendElements(comm, own.part, rankOf, std::vector<int>(rankOf.size(), 0)).part;
  const ContactSurroundings around = surroundingsOf(comm, own, surfaces, prescribed, draft);
  const FrictionFields fields(comm, mesh, surfaces);
  std::vector<ContactInterface> interfaces;
  try {
    runOnRoot(comm, [&] {
      for (std::size_t k = 0; k < draft.contacts.size(); ++k) {
        draft.contacts[k].directionAt = fields.directionAt(draft.contactOptions[k]);
        draft.contacts[k].isToldAtNodes = !namedFields({draft.contactOptions[k]}).empty();
        draft.contacts[k].gapAt = gapFunction(draft.contactOptions[k], surfaces.mesh);
      }
      interfaces = buildContact(surfaces.mesh, draft.contacts, around);
      for (std::size_t k = 0; k < interfaces.size(); ++k) {
        if (!draft.late.empty()) addLatePairs(draft.late[k], surfaces.nodes, draft.contacts[k], interfaces[k]);
        fields.setCoefficients(draft.contactOptions[k], interfaces[k]);
      }
    });
  } catch (const InputError&) {  // a surface of inverted elements cannot be paired: then the element is what must be named
    runOnAllRanks(comm, [&] { checkElements(own.part.mesh); });
    throw;
  }
  for (auto& spec : draft.contacts) {  // they refer to what ends here
    spec.directionAt = nullptr;
    spec.gapAt = nullptr;
  }
  const auto wholeOf = [&](std::int64_t node) { return surfaces.nodes[std::size_t(node)]; };
  for (auto& interface : interfaces) {
    for (auto& pair : interface.pairs) renumber(wholeOf, pair);
    if (interface.unpaired) interface.unpaired->renumber(surfaces.nodes);
    for (auto& move : interface.moves) move.node = surfaces.nodes[std::size_t(move.node)];
  }
  moveNodes(comm, interfaces, own.part);
  shareNotes(comm, interfaces, draft.contactOptions, draft.data);
  draft.surfaceElements = std::int64_t(surfaces.elements.size());
  return interfaces;
}

}  // namespace Haptos
