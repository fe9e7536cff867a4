// SPDX-License-Identifier: AGPL-3.0-or-later
// Documents as chunks and back, bit for bit. Each part is a node; what is large in it (voxels, a group of weight
// bricks, a motion) lies in leaves of at most a megabyte, so that an edit writes anew only the leaves it touched.
//
// Reading believes nothing: hashes are verified, every list is bounded by the bytes that are there, every index is
// checked, and a volume is refused when it would not fit into memory. Parts that are equal come back as one part, so
// that a result still knows what it was made from.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/base/progress.h"
#include "core/project/chunk.h"
#include "core/project/document.h"

namespace limber {

// Remembers the parts it has written (by pointer, without keeping them), so that what is shared with an earlier
// document costs nothing. One thread uses it at a time.
class DocumentWriter {
 public:
  // Puts what the sink lacks; the root comes last. `progress` is told of stage "save".
  ChunkHash write(const Document& document, ChunkSink& sink, Packing packing, Progress& progress = no_progress());

 private:
  struct Part {
    std::weak_ptr<const void> part;
    ChunkHash hash;
  };
  struct LastWeights {  // weights differ from the last ones in the same role, or in another, by a few bricks
    std::vector<std::weak_ptr<const SkinWeights::Chunk>> bricks;
    std::vector<ChunkHash> groups;
  };
  class Writing;

  std::unordered_map<const void*, Part> parts_;
  std::map<int, LastWeights> last_weights_;
};

struct ReadLimits {
  std::int64_t most_bytes = 0;  // of voxels and weights; 0: what the machine has
  // Keep the parts that are whole, and of the volume and of weights the blocks that are; say what is not: lost voxels
  // are air, lost weights those of a block beside them.
  bool leave_out_damaged = false;
};

// `where` names the file in messages. throws Error when a chunk is missing or damaged, or does not make sense.
//   warnings  parts that were left out: damaged ones if so asked, and weights or a pose that fit no volume or armature
Document read_document(const ChunkHash& root, ChunkSource& source, const std::string& where,
                       std::vector<std::string>& warnings, const ReadLimits& limits = {},
                       Progress& progress = no_progress());

}  // namespace limber
