// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes documents as chunks and reads them back, bit for bit. Each part of a document is a node. Its large arrays
// (voxels, a group of weight bricks, a motion) are stored in leaves of at most a megabyte, so that an edit writes only
// the leaves that it changed.
//
// The reader trusts nothing: it verifies every hash, checks the length of every list against the bytes that are left,
// checks every index, and refuses a volume that would not fit into memory. Equal parts are read as one shared part, so
// that a result still refers to the parts that it was made from.
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

// Writes documents and remembers the parts that it has written (by weak pointer). A part that two documents share is
// then written once. Only one thread may use a writer at a time.
class DocumentWriter {
 public:
  // Writes the chunks that the sink lacks, the root node last, and returns the root's hash. Reports progress as stage
  // "save".
  ChunkHash write(const Document& document, ChunkSink& sink, Packing packing, Progress& progress = no_progress());

 private:
  struct Part {
    std::weak_ptr<const void> part;
    ChunkHash hash;
  };
  // One set of weights as last written: the blended weights, the base weights or the weights of one layer. New weights
  // mostly differ from one of these sets in a few bricks only.
  struct LastWeights {
    std::vector<std::weak_ptr<const SkinWeights::Chunk>> bricks;
    std::vector<ChunkHash> groups;
  };
  class Writing;

  std::unordered_map<const void*, Part> parts_;
  std::map<int, LastWeights> last_weights_;
};

struct ReadLimits {
  // Limit on the bytes of voxels and weights; a larger document is refused. 0: the limit is 90 % of the free memory.
  std::int64_t most_bytes = 0;
  // If true, reading keeps the undamaged parts of the document, and the undamaged blocks of the volume and of weights.
  // Warnings say what is lost. Lost voxels become air. Lost weights get the influences of a neighbouring voxel.
  bool leave_out_damaged = false;
};

// Reads the document whose root node is `root`. Throws Error when a chunk is missing, damaged or invalid.
//   where     the file's name in messages
//   warnings  receives a line for each part that was left out: damaged parts (only if limits.leave_out_damaged is set),
//             and weights or a pose that do not fit the volume or armature
Document read_document(const ChunkHash& root, ChunkSource& source, const std::string& where,
                       std::vector<std::string>& warnings, const ReadLimits& limits = {},
                       Progress& progress = no_progress());

}  // namespace limber
