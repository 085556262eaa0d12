// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DistributedModel.hpp"

#include <Teuchos_Comm.hpp>

#include "Haptos_Error.hpp"
#include "Haptos_Exchange.hpp"
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
  model.multipliers = Teuchos::rcp(new MultiplierMap(comm, model.global.rows, rankOf));
  model.global.rows = {};
  sendSubdomains(*comm, rankOf, model);
  return model;
}

}  // namespace Haptos
