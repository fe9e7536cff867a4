// SPDX-License-Identifier: AGPL-3.0-or-later
// Projects and journals consist of chunks: byte strings that are named by their SHA-256 and stored compressed (zstd). A
// chunk that is already stored is not written again. If the bytes of a stored chunk do not have the SHA-256 that is its
// name, they are damaged.
//
// A chunk is a leaf (plain bytes) or a node, which names other chunks and carries bytes of its own. A node is written
// only after all chunks that it names, so where a node is stored, everything below it is stored too.
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

// A chunk that unpacks to more bytes is refused. A reader may have to allocate the whole chunk at once.
constexpr std::size_t kLargestChunk = std::size_t{16} << 20;

class ChunkSink {
 public:
  virtual ~ChunkSink() = default;
  virtual bool has(const ChunkHash& hash) = 0;
  virtual void put(const ChunkHash& hash, const std::string& packed) = 0;
};

class ChunkSource {
 public:
  virtual ~ChunkSource() = default;
  virtual std::optional<std::string> find(const ChunkHash& hash) = 0;  // returns the compressed chunk, or nothing
};

// Quick: the faster compression, for journals. Dense: smaller chunks; this compression is still faster than most disks.
enum class Packing { Quick, Dense };
std::string pack(std::string_view chunk, Packing packing);
// Returns the unpacked chunk. Returns nothing when the bytes are damaged, do not have this hash, or would unpack to
// more than kLargestChunk.
std::optional<std::string> unpack(std::string_view packed, const ChunkHash& hash);

struct Node {
  std::vector<ChunkHash> nodes, leaves;
  std::string bytes;
};
std::string to_chunk(const Node& node);
std::optional<Node> to_node(std::string_view chunk);  // returns nothing when the chunk is not a node

// Adds the chunk `root`, and every chunk that it names directly or indirectly, to `reached`. Returns false when one of
// the nodes among them is missing or damaged.
bool reach(const ChunkHash& root, ChunkSource& source, ChunkSet& reached);

}  // namespace limber
