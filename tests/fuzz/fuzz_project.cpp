// SPDX-License-Identifier: AGPL-3.0-or-later
// Fuzzes the readers of projects and journals: any bytes are read, or refused with Error. The first byte says what the
// other bytes are:
//   P  a project file       J  a journal       C  chunks with correct hashes, so that their contents are parsed
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <unistd.h>

#include "core/base/error.h"
#include "core/project/journal.h"
#include "core/project/project_io.h"
#include "core/project/seams_codec.h"

namespace {

using namespace limber;

constexpr std::int64_t kMostBytes = 64 << 20;

Path file_of(const std::string& bytes) {
  static const Path path = std::filesystem::temp_directory_path() / ("fuzz-project-" + std::to_string(::getpid()));
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

// Checks only what read_document guarantees: the parts of the document fit each other.
void check(const Document& document) {
  if (document.volume && document.volume->grid.voxel_count() != std::ssize(document.volume->voxels)) std::abort();
  if (document.weights && (!document.volume || TissueVoxels(*document.volume).size() != document.weights->size()))
    std::abort();
  if (document.seams && (!document.volume || !fit(*document.seams, *document.volume))) std::abort();
  if (document.pose && (!document.armature || document.pose->rotation.size() != document.armature->bones.size()))
    std::abort();
}

// Reads chunks, one after another, the root last. Each is: number of child nodes (a byte), number of leaves (a byte),
// the index of the earlier chunk for each of these (a byte each), length (two bytes), bytes. A chunk without children
// is a leaf if the highest bit of the length is set.
struct Chunks final : ChunkSource {
  std::map<std::array<std::uint8_t, 32>, std::string> packed;
  std::vector<ChunkHash> hashes;
  explicit Chunks(std::string_view in) {
    const auto byte = [&] {
      const std::uint8_t value = in.empty() ? 0 : static_cast<std::uint8_t>(in[0]);
      if (!in.empty()) in.remove_prefix(1);
      return value;
    };
    while (!in.empty() && hashes.size() < 255) {
      Node node;
      const int nodes = byte(), leaves = byte();
      for (int i = 0; i < nodes + leaves; ++i)
        if (const std::uint8_t which = byte(); which < hashes.size())
          (i < nodes ? node.nodes : node.leaves).push_back(hashes[which]);
      const int low = byte(), high = byte();
      const std::size_t size = std::min<std::size_t>(in.size(), static_cast<std::size_t>(low | (high & 0x7f) << 8));
      node.bytes = in.substr(0, size);
      in.remove_prefix(size);
      const bool leaf = nodes + leaves == 0 && (high & 0x80);
      const std::string chunk = leaf ? node.bytes : to_chunk(node);
      hashes.push_back(hash_of(chunk));
      packed[hashes.back().bytes] = pack(chunk, Packing::Quick);
    }
  }
  std::optional<std::string> find(const ChunkHash& hash) override {
    const auto at = packed.find(hash.bytes);
    return at == packed.end() ? std::nullopt : std::optional(at->second);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  ReadLimits limits;
  limits.most_bytes = kMostBytes;
  try {
    if (data[0] == 'P') {
      check(read_project(file_of(bytes), no_progress(), limits).document);
    } else if (data[0] == 'J') {
      check(recover(file_of(bytes)).document);
    } else {
      Chunks chunks(bytes);
      std::vector<std::string> warnings;
      limits.leave_out_damaged = data[0] == 'c';
      if (!chunks.hashes.empty()) check(read_document(chunks.hashes.back(), chunks, "f", warnings, limits));
    }
  } catch (const Error&) {
  }
  return 0;
}
