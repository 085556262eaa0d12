// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_FieldOutput.hpp"

#include <Teuchos_Comm.hpp>
#include <Tpetra_MultiVector.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

struct SentElement {
  std::int64_t element;
  int subdomain;
  Stress stress;
};

struct SentContact {
  std::int64_t node;
  double factor;  ///< of the pair's force
  bool isSecondary;
  PairState pair;

  bool isOwn() const { return isSecondary && node == pair.secondaryNode; }
};

using Values = std::vector<double>;
const char* const kAxes[3] = {"_x", "_y", "_z"};

void addVector(ResultFields& fields, const std::string& name, const Values& values) {
  for (int d = 0; d < 3; ++d) {
    Values component(values.size() / 3);
    for (std::size_t i = 0; i < component.size(); ++i) component[i] = values[3 * i + d];
    fields.nodal.emplace_back(name + kAxes[d], std::move(component));
  }
}

// Contact quantities on the nodes of a range, the opposite force on the primary side.  A multiplier's own node shows what its pair
// has; any other shows the mean pressure of the pairs that use it, and slip and axis of the one that uses it most.  Normal forces
// of either side have the sum of all multipliers: primary nodes show their (signed) shares, secondary ones without a multiplier 0.
class ContactFields {
 public:
  explicit ContactFields(std::size_t n)
      : force(3 * n, 0.0), slip(3 * n, 0.0), axis(3 * n, 0.0), coefficients{Values(n, 0.0), Values(n, 0.0)},
        normalForce(n, 0.0), pressure(n, 0.0), gap(n, 0.0), status(n, 0.0),
        most_(n, 0.0) {}

  Values force, slip, axis;
  std::array<Values, 2> coefficients;
  Values normalForce, pressure, gap, status;

  /// \param first node of the range
  void add(const std::vector<SentContact>& items, std::int64_t first) {
    std::vector<char> isOwn(most_.size(), 0);  // nodes that have a multiplier
    for (const auto& item : items)
      if (item.isOwn()) isOwn[std::size_t(item.node - first)] = 1;
    for (const auto& item : items) {
      const std::size_t i = std::size_t(item.node - first);
      addForce(i, item);
      if (item.isOwn()) normalForce[i] += item.pair.normalForce;
      else if (!item.isSecondary) normalForce[i] -= item.factor * item.pair.normalForce;
      if (item.isOwn()) describe(i, 1.0, item.pair);
      else if (!item.isSecondary || !isOwn[i]) describe(i, std::abs(item.factor), item.pair);
    }
    for (const auto& [place, share] : shares_)
      if (share[1] > 0) pressure[place] = share[0] / share[1];
  }

 private:
  void addForce(std::size_t i, const SentContact& item) {
    for (std::size_t d = 0; d < 3; ++d) force[3 * i + d] += item.factor * item.pair.force[d];
  }

  void describe(std::size_t i, double weight, const PairState& pair) {
    auto& share = shares_[i];
    // Mean pressure = sum of forces over sum of areas, of all interfaces that meet at the node.
    share[0] += weight * pair.normalForce;
    share[1] += weight * pair.area;
    // Of several pairs the closest counts, and the state that holds most.
    gap[i] = status[i] == 0 ? pair.gap : std::min(gap[i], pair.gap);
    status[i] = std::max(status[i], double(int(pair.status)));
    // Slips and axes of different pairs cannot be averaged: directions may be opposite.
    if (weight < most_[i]) return;
    most_[i] = weight;
    for (std::size_t d = 0; d < 3; ++d) {
      slip[3 * i + d] = pair.slip[d];
      axis[3 * i + d] = pair.axis[d];
    }
    for (std::size_t k = 0; k < 2; ++k) coefficients[k][i] = pair.coefficients[k];
  }

  Values most_;  // largest weight so far
  std::map<std::size_t, std::array<double, 2>> shares_;  // node -> force and area
};

// The force of a pair on every node that shares it, weight by weight, with the opposite sign on the primary side.
ContactFields makeContactFields(const Communicator& comm, const EvenRanges& nodes, const std::vector<PairResult>& pairs) {
  std::vector<SentContact> sent;
  for (const auto& pair : pairs) {
    for (const auto& [node, weight] : pair.secondary) sent.push_back({node, +weight, true, pair});
    for (const auto& [node, weight] : pair.primary) sent.push_back({node, -weight, false, pair});
  }
  const int rank = comm.getRank();
  ContactFields fields(std::size_t(nodes.count(rank)));
  fields.add(sendItems(comm, sent, [&](const SentContact& c) { return nodes.owner(c.node); }), nodes.begin(rank));
  return fields;
}

}  // namespace

// An element is in one subdomain, so its stress comes from one rank, in whatever order.
ElementResults gatherElementResults(const Communicator& comm, const std::vector<Subdomain>& subdomains,
                                    const std::vector<IsotropicMaterial>& materials, const std::vector<std::size_t>& offsets,
                                    const MultiVector& u, const EvenRanges& elements) {
  const auto data = u.getData(0);
  std::vector<SentElement> mine;
  for (std::size_t i = 0; i < subdomains.size(); ++i) {
    const Subdomain& sub = subdomains[i];
    const Eigen::Map<const Eigen::VectorXd> ui(data.getRawPtr() + offsets[i], sub.numDofs());
    // Groups list their elements in the order of `sub.elements`.
    std::size_t element = 0;
    for (const auto& group : sub.groups)
      for (const auto& stress : elementStresses(sub.coordinates, group, materials[group.material], ui))
        mine.push_back({sub.elements[element++], sub.id, stress});
  }
  const auto first = elements.begin(comm.getRank());
  ElementResults result;
  result.stress.resize(std::size_t(elements.count(comm.getRank())));
  result.subdomain.resize(result.stress.size());
  for (const auto& sent : sendItems(comm, mine, [&](const SentElement& e) { return elements.owner(e.element); })) {
    result.stress[std::size_t(sent.element - first)] = sent.stress;
    result.subdomain[std::size_t(sent.element - first)] = sent.subdomain;
  }
  return result;
}

// Names are those that the verification scripts and users' filters know.
ResultFields makeResultFields(const Communicator& comm, const EvenRanges& nodes, const StepResults& results) {
  ResultFields fields;
  addVector(fields, "displacement", results.displacement);
  ContactFields contact = makeContactFields(comm, nodes, results.pairs);
  addVector(fields, "contact_force", contact.force);
  fields.nodal.emplace_back("contact_normal_force", std::move(contact.normalForce));
  fields.nodal.emplace_back("contact_pressure", std::move(contact.pressure));
  fields.nodal.emplace_back("contact_gap", std::move(contact.gap));
  addVector(fields, "contact_slip", contact.slip);
  fields.nodal.emplace_back("contact_status", std::move(contact.status));
  addVector(fields, "friction_axis", contact.axis);
  for (std::size_t k = 0; k < 2; ++k) fields.nodal.emplace_back("friction_coefficient_" + std::to_string(k + 1), std::move(contact.coefficients[k]));

  const char* const components[6] = {"stress_xx", "stress_yy", "stress_zz", "stress_xy", "stress_yz", "stress_zx"};
  const ElementResults& elements = results.elements;
  const std::size_t n = elements.stress.size();
  for (int k = 0; k < 6; ++k) {
    Values values(n);
    for (std::size_t e = 0; e < n; ++e) values[e] = elements.stress[e][k];
    fields.element.emplace_back(components[k], std::move(values));
  }
  Values mises(n);
  for (std::size_t e = 0; e < n; ++e) mises[e] = vonMises(elements.stress[e]);
  fields.element.emplace_back("von_mises", std::move(mises));
  fields.element.emplace_back("subdomain", elements.subdomain);
  fields.global = {{"kkt", results.kkt}, {"hessian_multiplications", double(results.hessianMultiplications)}};
  return fields;
}

}  // namespace Haptos
