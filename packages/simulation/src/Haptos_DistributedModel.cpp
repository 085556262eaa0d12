// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DistributedModel.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Map.hpp>
#include <algorithm>
#include <limits>

#include "Haptos_Error.hpp"
#include "Haptos_Exchange.hpp"
#include "Haptos_ParameterValue.hpp"
#include "Haptos_SubdomainOrder.hpp"

namespace Haptos {
namespace {

void packNames(ByteWriter& writer, const std::vector<std::string>& names) {
  writer.write(names.size());
  for (const auto& name : names) writer.write(name);
}

std::vector<std::string> unpackNames(ByteReader& reader) {
  std::vector<std::string> names(reader.read<std::size_t>());
  for (auto& name : names) name = reader.readString();
  return names;
}

// Names and numbers of blocks and sets, without their contents: enough to look loads up.
Bytes packHeader(const Mesh& mesh, const ModelData& data, const GlobalModel& model) {
  ByteWriter writer;
  const auto put = [&](const auto& list) {
    writer.write(list.size());
    for (const auto& item : list) {
      writer.write(item.id);
      writer.write(item.name);
    }
  };
  put(mesh.blocks);
  put(mesh.sideSets);
  put(mesh.nodeSets);
  packNames(writer, data.bodyNames);
  packNames(writer, data.hinged);
  packNames(writer, data.interfaceNames);
  packNames(writer, data.notes);
  packNames(writer, data.remarks);
  writer.write(data.formulation);
  writer.write(data.friction);
  writer.write(data.unpairedNodes);
  writer.write(data.tiedPairs);
  writer.write(data.metis);
  writer.write(data.mendedFragments);
  writer.write(model.partition.count);
  long unknowns = 0;
  for (const auto& sub : model.subdomains) unknowns += sub.numDofs();
  writer.write(unknowns);
  return writer.take();
}

void unpackHeader(const Bytes& bytes, const RunOptions& options, bool isReader, DistributedModel& model) {
  ByteReader reader(bytes);
  Mesh header;
  const auto get = [&](auto& list) {
    list.resize(reader.read<std::size_t>());
    for (auto& item : list) {
      item.id = reader.read<std::int64_t>();
      item.name = reader.readString();
    }
  };
  get(header.blocks);
  get(header.sideSets);
  get(header.nodeSets);
  model.data.bodyNames = unpackNames(reader);
  model.data.hinged = unpackNames(reader);
  model.data.interfaceNames = unpackNames(reader);
  model.data.notes = unpackNames(reader);
  model.data.remarks = unpackNames(reader);
  model.data.formulation = reader.read<Formulation>();
  model.data.friction = reader.readVector<FrictionSpec>();
  model.data.unpairedNodes = reader.read<std::size_t>();
  model.data.tiedPairs = reader.read<long>();
  model.data.metis = reader.read<bool>();
  model.data.mendedFragments = reader.read<int>();
  model.numSubdomains = reader.read<int>();
  model.primalUnknowns = reader.read<long>();
  if (isReader) return;
  model.data.loads = collectLoads(options.conditions, header);
  model.data.materials = materialsOf(options.materials);
}

std::vector<double> workOfSubdomains(const std::vector<Subdomain>& subdomains) {
  std::vector<double> work;
  for (const auto& sub : subdomains) work.push_back(workOfSubdomain(sub.numNodes()));
  return work;
}

void sendSubdomains(const Communicator& comm, const std::vector<int>& rankOf, DistributedModel& model) {
  std::vector<Bytes> messages;
  if (comm.getRank() == 0) {
    std::vector<ByteWriter> writers(comm.getSize());
    std::vector<int> counts(comm.getSize(), 0);
    for (int r : rankOf) ++counts[r];
    int first = 0;
    for (int r = 0; r < comm.getSize(); first += counts[r++]) {
      writers[r].write(first);
      writers[r].write(counts[r]);
    }
    for (auto& sub : model.global.subdomains) {
      pack(writers[rankOf[sub.id]], sub);
      sub = {};
    }
    model.global.subdomains.clear();
    for (auto& writer : writers) messages.push_back(writer.take());
  }
  const Bytes message = scatterFromRoot(comm, messages);
  ByteReader reader(message);
  model.firstSubdomain = reader.read<int>();
  const int count = reader.read<int>();
  for (int i = 0; i < count; ++i) model.subdomains.push_back(unpackSubdomain(reader));
}

RowSources rowSources(const DistributedModel& model) {
  std::vector<double> youngsModulus;
  for (const auto& material : model.data.materials) youngsModulus.push_back(material.youngsModulus);
  RowSources sources;
  for (const auto& sub : model.subdomains) sources.subdomains.push_back({sub.id, sub.nodes, nodalStiffness(sub, youngsModulus)});
  sources.prescribed = model.global.prescribed;
  sources.pairs = placedPairs(model.global.interfaces);
  for (std::size_t k = 0; k < model.data.friction.size(); ++k) {
    const FrictionSpec& spec = model.data.friction[k];
    sources.interfaces.push_back({model.data.interfaceNames[k], spec.tied, spec.law != FrictionLaw::Frictionless});
  }
  return sources;
}

// The largest extent of all subdomains.  Collective.
double sizeOf(const DistributedModel& model) {
  std::array<double, 6> mine, all;  // highest coordinates, - lowest ones
  mine.fill(-std::numeric_limits<double>::infinity());
  for (const auto& sub : model.subdomains)
    for (const auto& x : sub.coordinates)
      for (std::size_t d = 0; d < 3; ++d) {
        mine[d] = std::max(mine[d], x[d]);
        mine[3 + d] = std::max(mine[3 + d], -x[d]);
      }
  Teuchos::reduceAll(*model.comm, Teuchos::REDUCE_MAX, 6, mine.data(), all.data());
  return std::max({all[0] + all[3], all[1] + all[4], all[2] + all[5]});
}

// A pinned normal row cannot move: its data must already respect the gap.  The first pair that does not is told.  Collective.
void checkPinnedRows(const DistributedModel& model) {
  const MultiplierMap& rows = *model.multipliers;
  const double size = sizeOf(model);
  constexpr GlobalOrdinal kNone = std::numeric_limits<GlobalOrdinal>::max();
  GlobalOrdinal mine = kNone, first = kNone;
  double found[3] = {0, 0, 0}, all[3];  // node, interface, overlap
  for (const auto& pair : rows.pairs()) {
    const double c = rows.c()[std::size_t(pair.normal)];
    if (!rows.pinned()[std::size_t(pair.normal)] || c >= -1e-9 * size || mine != kNone) continue;
    mine = rows.map()->getGlobalElement(pair.normal);
    found[0] = double(pair.geometry.secondaryNode);
    found[1] = double(pair.interface);
    found[2] = -c;
  }
  Teuchos::reduceAll(*model.comm, Teuchos::REDUCE_MIN, mine, Teuchos::outArg(first));
  if (first == kNone) return;
  if (mine != first) std::fill(found, found + 3, 0.0);
  Teuchos::reduceAll(*model.comm, Teuchos::REDUCE_SUM, 3, found, all);
  runOnRoot(*model.comm, [&] {
    throw InsufficientModel("The model has no solution: at " + describeNode(model.global.mesh, std::int64_t(all[0])) + " of contact '" +
                            model.data.interfaceNames[std::size_t(all[1])] + "' the prescribed displacements make the surfaces overlap by " +
                            numberText(all[2]) + ".");
  });
}

}  // namespace

DistributedModel distributeModel(const RCP<const Communicator>& comm, const RunOptions& options,
                                 const SourceMesh* source, RunClock& clock) {
  DistributedModel model;
  model.comm = comm;
  const bool isReader = comm->getRank() == 0;
  SourceMesh mesh;
  {
    const auto scope = clock.time(Phase::Read);
    runOnRoot(*comm, [&] { mesh = source ? *source : makeMesh(options.mesh); });
  }
  const auto scope = clock.time(Phase::Decompose);
  ModelDraft draft;
  runOnRoot(*comm, [&] { draft = draftModel(options, std::move(mesh), model.data, model.global); });
  const auto parts = cutOnRanks(*comm, draft.plan.cuts);
  draft.plan.cuts = {};
  std::vector<Bytes> headers(comm->getSize());
  runOnRoot(*comm, [&] {
    finishModel(draft, parts, model.data, model.global);
    draft = {};
    headers.assign(comm->getSize(), packHeader(model.global.mesh, model.data, model.global));
  });
  unpackHeader(scatterFromRoot(*comm, headers), options, isReader, model);
  std::vector<int> rankOf;
  if (isReader) rankOf = dealToRanks(workOfSubdomains(model.global.subdomains), comm->getSize());
  sendSubdomains(*comm, rankOf, model);
  model.multipliers = Teuchos::rcp(new MultiplierMap(comm, rowSources(model)));
  checkPinnedRows(model);
  return model;
}

}  // namespace Haptos
