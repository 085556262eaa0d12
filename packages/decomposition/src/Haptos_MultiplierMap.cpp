// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_MultiplierMap.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Map.hpp>
#include <algorithm>
#include <iterator>

#include "Haptos_Exchange.hpp"

namespace Haptos {
namespace {

struct SentEntry {
  GlobalOrdinal row;
  RowEntry entry;
};

// What one rank gets: its own rows, and the entries of its subdomains in anybody's rows.
struct Share {
  std::vector<GlobalOrdinal> rows;
  std::vector<RowKind> kinds;
  std::vector<char> pinned;
  std::vector<double> c;
  std::vector<std::int64_t> nodes;
  std::vector<std::size_t> offsets{0};
  std::vector<RowEntry> entries;
  std::vector<PairRows> pairs;
  std::vector<SentEntry> overlap;
};

void packPair(ByteWriter& writer, const PairRows& pair) {
  writer.write(pair.interface);
  writer.write(pair.pair);
  writer.write(pair.normal);
  for (GlobalOrdinal row : pair.tangential) writer.write(row);
  pack(writer, pair.geometry);
}

LocalPair unpackPair(ByteReader& reader, const Map& map) {
  LocalPair pair;
  pair.interface = reader.read<int>();
  pair.pair = reader.read<int>();
  pair.normal = map.getLocalElement(reader.read<GlobalOrdinal>());
  for (int& row : pair.tangential) {
    const auto global = reader.read<GlobalOrdinal>();
    row = global < 0 ? -1 : map.getLocalElement(global);
  }
  pair.geometry = unpackContactPair(reader);
  return pair;
}

std::vector<Bytes> packShares(const ConstraintRows& rows, const std::vector<int>& rankOfSubdomain, int ranks) {
  std::vector<Share> shares(ranks);
  for (GlobalOrdinal row = 0; row < rows.numRows(); ++row) {
    Share& mine = shares[rankOfSubdomain[rows.owner[row]]];
    mine.rows.push_back(row);
    mine.kinds.push_back(rows.kinds[row]);
    mine.pinned.push_back(rows.pinned[row]);
    mine.c.push_back(rows.c[row]);
    mine.nodes.push_back(rows.node[row]);
    for (auto k = rows.offsets[row]; k < rows.offsets[row + 1]; ++k) {
      mine.entries.push_back(rows.entries[k]);
      shares[rankOfSubdomain[rows.entries[k].subdomain]].overlap.push_back({row, rows.entries[k]});
    }
    mine.offsets.push_back(mine.entries.size());
  }
  for (const auto& pair : rows.pairs) shares[rankOfSubdomain[rows.owner[pair.normal]]].pairs.push_back(pair);

  std::vector<Bytes> messages;
  for (auto& share : shares) {
    ByteWriter writer;
    writer.write(rows.numRows());
    writer.write(rows.numEquality);
    writer.write(GlobalOrdinal(rows.pairs.size()));
    writer.write(share.rows);
    writer.write(share.kinds);
    writer.write(share.pinned);
    writer.write(share.c);
    writer.write(share.nodes);
    writer.write(share.offsets);
    writer.write(share.entries);
    writer.write(share.overlap);
    writer.write(share.pairs.size());
    for (const auto& pair : share.pairs) packPair(writer, pair);
    messages.push_back(writer.take());
    share = {};
  }
  return messages;
}

}  // namespace

MultiplierMap::MultiplierMap(const RCP<const Communicator>& comm, const ConstraintRows& rows,
                             const std::vector<int>& rankOfSubdomain) {
  std::vector<Bytes> messages;
  if (comm->getRank() == 0) messages = packShares(rows, rankOfSubdomain, comm->getSize());
  const Bytes message = scatterFromRoot(*comm, messages);
  ByteReader reader(message);
  const auto numRows = reader.read<GlobalOrdinal>();
  numEquality_ = reader.read<GlobalOrdinal>();
  numPairs_ = reader.read<GlobalOrdinal>();
  const auto owned = reader.readVector<GlobalOrdinal>();
  kinds_ = reader.readVector<RowKind>();
  pinned_ = reader.readVector<char>();
  c_ = reader.readVector<double>();
  nodes_ = reader.readVector<std::int64_t>();
  ownedOffsets_ = reader.readVector<std::size_t>();
  ownedEntries_ = reader.readVector<RowEntry>();
  auto overlap = reader.readVector<SentEntry>();

  std::vector<GlobalOrdinal> touched;
  for (const auto& sent : overlap) touched.push_back(sent.row);
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  const auto view = [](const std::vector<GlobalOrdinal>& v) { return Teuchos::ArrayView<const GlobalOrdinal>(v.data(), v.size()); };
  map_ = Teuchos::rcp(new Map(numRows, view(owned), 0, comm));
  std::vector<GlobalOrdinal> all = owned;
  std::copy_if(touched.begin(), touched.end(), std::back_inserter(all), [&](GlobalOrdinal row) { return !map_->isNodeGlobalElement(row); });
  overlapMap_ = Teuchos::rcp(new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(), view(all), 0, comm));
  remote_ = std::make_unique<RemoteRows>(map_, overlapMap_);
  for (std::size_t row = 0; row < kinds_.size(); ++row)
    if (!isEquality(kinds_[row])) contactRows_.push_back(int(row));
  contactMap_ = mapOfRows(*map_, contactRows_);

  pairs_.resize(reader.read<std::size_t>());
  for (auto& pair : pairs_) pair = unpackPair(reader, *map_);
  for (const auto& sent : overlap)
    overlapEntries_.push_back({overlapMap_->getLocalElement(sent.row), sent.entry.subdomain, sent.entry.dof,
                               sent.entry.value, sent.entry.weight});
  std::stable_sort(overlapEntries_.begin(), overlapEntries_.end(), [](const OverlapEntry& a, const OverlapEntry& b) {
    return a.subdomain != b.subdomain ? a.subdomain < b.subdomain : a.row < b.row;
  });
}

}  // namespace Haptos
