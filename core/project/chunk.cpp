// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/chunk.h"

#include <cstring>
#include <memory>
#include <new>

#include <zstd.h>

#include "core/base/bytes.h"
#include "core/base/file.h"

namespace limber {

namespace {
constexpr int kQuick = 1, kDense = 3;  // zstd levels of Packing::Quick and Packing::Dense

struct NotANode {};

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};
}  // namespace

std::size_t ChunkHash::Hasher::operator()(const ChunkHash& hash) const {
  std::size_t value;
  std::memcpy(&value, hash.bytes.data(), sizeof value);
  return value;
}

ChunkHash hash_of(std::string_view chunk) { return {sha256(chunk.data(), chunk.size())}; }

std::string pack(std::string_view chunk, Packing packing) {
  // Each thread keeps its own zstd compression context, since creating a context allocates a megabyte.
  thread_local const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
  if (!context) throw std::bad_alloc();
  std::string packed(ZSTD_compressBound(chunk.size()), '\0');
  const std::size_t size = ZSTD_compressCCtx(context.get(), packed.data(), packed.size(), chunk.data(), chunk.size(),
                                             packing == Packing::Quick ? kQuick : kDense);
  if (ZSTD_isError(size)) throw std::bad_alloc();  // the output buffer is large enough, so only memory can be lacking
  packed.resize(size);
  packed.shrink_to_fit();
  return packed;
}

std::optional<std::string> unpack(std::string_view packed, const ChunkHash& hash) {
  const unsigned long long size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR || size > kLargestChunk) return std::nullopt;
  if (ZSTD_findFrameCompressedSize(packed.data(), packed.size()) != packed.size()) return std::nullopt;
  thread_local const std::unique_ptr<ZSTD_DCtx, FreeContext> context(ZSTD_createDCtx());
  if (!context) throw std::bad_alloc();
  std::string chunk(size, '\0');
  const std::size_t got = ZSTD_decompressDCtx(context.get(), chunk.data(), chunk.size(), packed.data(), packed.size());
  if (ZSTD_isError(got) || got != size || hash_of(chunk) != hash) return std::nullopt;
  return chunk;
}

std::string to_chunk(const Node& node) {
  ByteWriter out;
  out.count(node.nodes.size());
  out.count(node.leaves.size());
  for (const auto* list : {&node.nodes, &node.leaves})
    for (const ChunkHash& hash : *list) out.raw(hash.bytes.data(), hash.bytes.size());
  out.raw(node.bytes.data(), node.bytes.size());
  return out.take();
}

std::optional<Node> to_node(std::string_view chunk) {
  try {
    ByteReader in(chunk, [] { throw NotANode(); });
    Node node;
    const std::size_t nodes = in.get<std::uint32_t>(), leaves = in.get<std::uint32_t>();
    in.require(nodes + leaves <= chunk.size() / sizeof(ChunkHash));
    const auto read = [&](std::vector<ChunkHash>& list, std::size_t count) {
      list.resize(count);
      for (ChunkHash& hash : list) std::memcpy(hash.bytes.data(), in.raw(sizeof(ChunkHash)).data(), sizeof(ChunkHash));
    };
    read(node.nodes, nodes);
    read(node.leaves, leaves);
    node.bytes = in.rest();
    return node;
  } catch (const NotANode&) {
    return std::nullopt;
  }
}

bool reach(const ChunkHash& root, ChunkSource& source, ChunkSet& reached) {
  std::vector<ChunkHash> open{root};
  while (!open.empty()) {
    const ChunkHash hash = open.back();
    open.pop_back();
    if (!reached.insert(hash).second) continue;
    const auto packed = source.find(hash);
    const auto chunk = packed ? unpack(*packed, hash) : std::nullopt;
    const auto node = chunk ? to_node(*chunk) : std::nullopt;
    if (!node) return false;
    open.insert(open.end(), node->nodes.begin(), node->nodes.end());
    reached.insert(node->leaves.begin(), node->leaves.end());
  }
  return true;
}

}  // namespace limber
