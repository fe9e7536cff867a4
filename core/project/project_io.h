// SPDX-License-Identifier: AGPL-3.0-or-later
// The project file NAME.limber: one SQLite database with the document's chunks (core/project/chunk.h), the name of
// their root, and beside it what the editor wants to find again (views, layout, a picture), which is opaque here.
//   chunk(hash, packed)      state(name, value): root, mark, editor, thumbnail, program
// Saving writes the chunks that are not there yet and the new root in one transaction, so whoever opens the file, after
// whatever happened, finds the state before or after. A new file is made under another name and renamed.
//
// Every save leaves a mark of its own. Who saves again says which mark was there last, so that a project that another
// program has changed or replaced meanwhile is not overwritten.
#pragma once

#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/project/document.h"
#include "core/project/document_codec.h"

namespace limber {

// What a save left behind.
struct SaveMark {
  ChunkHash root;
  std::string id;  // of this save alone

  bool operator==(const SaveMark&) const = default;
};

struct Project {
  Document document;
  std::string editor;     // the editor's state, JSON; 16 MB at most
  std::string thumbnail;  // PNG; 16 MB at most
  SaveMark mark;
  std::vector<std::string> warnings;  // parts that were left out
};

// By content: the header of a database that is ours.
bool is_project(const Path& path);

// Throws Error when it is no project, is damaged, was written by a newer version, or is in use.
Project read_project(const Path& path, Progress& progress = no_progress(), const ReadLimits& limits = {});
// The picture alone, "" when there is none or the file cannot be read.
std::string read_thumbnail(const Path& path);

// Chunks that a new file keeps beside the document's own, until it is saved again.
struct SpareChunks {
  std::vector<ChunkHash> hashes;
  ChunkSource* source = nullptr;
};

// A new file, whole or not at all; replaces what stands there.
SaveMark create_project(const Project& project, const Path& path, DocumentWriter& writer,
                        Progress& progress = no_progress(), const SpareChunks& spare = {});

// Chunks of earlier saves that this one does not need.
enum class Unused { Remove, Keep };

// Writes what changed since the save that left `expected`. Throws Error, and the file is as before, when it has changed
// since, is gone, or cannot be written.
SaveMark update_project(const Project& project, const Path& path, const SaveMark& expected, Unused unused,
                        DocumentWriter& writer, Progress& progress = no_progress());
// Removes chunks that the last save does not need.
void prune_project(const Path& path);

// The mark that stands in the file.
SaveMark read_mark(const Path& path);
// All chunks below the last save's root.
ChunkSet reachable_chunks(const Path& path);

// Checks the database's structure and every chunk; what is wrong, one line each.
std::vector<std::string> verify_project(const Path& path, Progress& progress = no_progress());

struct ProjectSummary {
  std::string program;                                       // the version that saved it
  std::int64_t file_bytes = 0, chunks = 0, chunk_bytes = 0;  // packed
  bool has_thumbnail = false;
};
ProjectSummary summarize_project(const Path& path);

// The project's chunks, as a source for whoever reads a journal.
class ProjectChunks final : public ChunkSource {
 public:
  explicit ProjectChunks(const Path& path);
  ~ProjectChunks() override;
  std::optional<std::string> find(const ChunkHash& hash) override;

 private:
  struct Open;
  std::unique_ptr<Open> open_;
};

}  // namespace limber
