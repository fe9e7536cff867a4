// SPDX-License-Identifier: AGPL-3.0-or-later
// What projects and journals are made of: chunks of bytes, named by their SHA-256 and kept packed (zstd). What did not
// change has the name it had, and is not written again; what is read must have its name's hash, or it is damaged.
//
// A chunk is a leaf (plain bytes) or a node: it names other chunks and carries bytes of its own. A chunk is put only
// after all that it names, so whoever has a node has everything below it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace limber {

struct ChunkHash {
  std::array<std::uint8_t, 32> bytes{};

  bool operator==(const ChunkHash&) const = default;
  struct Hasher {
    std::size_t operator()(const ChunkHash& hash) const;
  };
};
using ChunkSet = std::unordered_set<ChunkHash, ChunkHash::Hasher>;

ChunkHash hash_of(std::string_view chunk);

constexpr std::size_t kLargestChunk = std::size_t{16}
                                      << 20;  // bytes, unpacked: what a reader may have to allocate at once

class ChunkSink {
 public:
  virtual ~ChunkSink() = default;
  virtual bool has(const ChunkHash& hash) = 0;
  virtual void put(const ChunkHash& hash, const std::string& packed) = 0;
};

class ChunkSource {
 public:
  virtual ~ChunkSource() = default;
  virtual std::optional<std::string> find(const ChunkHash& hash) = 0;  // packed
};

// Quick for journals; dense is still faster than most disks.
enum class Packing { Quick, Dense };
std::string pack(std::string_view chunk, Packing packing);
// Nothing when the bytes are damaged, are not this hash's, or would unpack to more than kLargestChunk.
std::optional<std::string> unpack(std::string_view packed, const ChunkHash& hash);

struct Node {
  std::vector<ChunkHash> nodes, leaves;
  std::string bytes;
};
std::string to_chunk(const Node& node);
std::optional<Node> to_node(std::string_view chunk);  // nothing when it is none

// Adds `root` and every chunk below it to `reached`. False when a node is missing or damaged.
bool reach(const ChunkHash& root, ChunkSource& source, ChunkSet& reached);

}  // namespace limber
