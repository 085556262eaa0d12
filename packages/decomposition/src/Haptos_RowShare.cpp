// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RowShare.hpp"

namespace Haptos {

void pack(ByteWriter& writer, const RowShare::Pair& pair) {
  writer.write(pair.interface);
  writer.write(pair.position);
  writer.write(pair.isTied);
  writer.write(pair.rows);
  writer.write(pair.c);
  writer.write(pair.pinned);
  writer.write(pair.holder);
  writer.write(pair.meetsContact);
  pack(writer, pair.geometry);
  writer.write(pair.nodes);
}

RowShare::Pair unpackPair(ByteReader& reader) {
  RowShare::Pair pair;
  pair.interface = reader.read<int>();
  pair.position = reader.read<int>();
  pair.isTied = reader.read<bool>();
  pair.rows = reader.read<std::array<GlobalOrdinal, 3>>();
  pair.c = reader.read<std::array<double, 3>>();
  pair.pinned = reader.read<std::array<char, 3>>();
  pair.holder = reader.read<int>();
  pair.meetsContact = reader.read<bool>();
  pair.geometry = unpackContactPair(reader);
  pair.nodes = reader.readVector<PairNode>();
  return pair;
}

void pack(ByteWriter& writer, const RowShare::Node& node) {
  writer.write(node.node);
  writer.write(node.gluing);
  writer.write(node.dirichlet);
  writer.write(node.prescribed);
  writer.write(node.holder);
  writer.write(node.stiffness);
}

RowShare::Node unpackNode(ByteReader& reader) {
  RowShare::Node node;
  node.node = reader.read<std::int64_t>();
  node.gluing = reader.read<GlobalOrdinal>();
  node.dirichlet = reader.read<std::array<GlobalOrdinal, 3>>();
  node.prescribed = reader.read<std::array<double, 3>>();
  node.holder = reader.read<int>();
  node.stiffness = reader.readVector<double>();
  return node;
}

}  // namespace Haptos
