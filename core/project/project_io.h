// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes the project file NAME.limber. It is an SQLite database with the document's chunks
// (core/project/chunk.h), the hash of the root chunk, and what the editor restores when it opens the project (views,
// layout, a picture). The editor's bytes are not interpreted here. Its two tables:
//   chunk(hash, packed)      state(name, value): root, mark, editor, thumbnail, program
// A save writes the missing chunks and the new root in one transaction. So whoever opens the file later finds the state
// before or after the save, even if the save was interrupted. A new file is written under another name and then
// renamed.
//
// Every save stores a mark of its own. The next save names the mark that it expects, so that a project that another
// program has changed or replaced meanwhile is not overwritten.
#pragma once

#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/project/document.h"
#include "core/project/document_codec.h"

namespace limber {

// Identifies one save of a project.
struct SaveMark {
  ChunkHash root;
  std::string id;  // random, differs for every save

  bool operator==(const SaveMark&) const = default;
};

struct Project {
  Document document;
  std::string editor;     // the editor's state, JSON; 16 MB at most
  std::string thumbnail;  // picture of the project, PNG; 16 MB at most
  SaveMark mark;
  std::vector<std::string> warnings;  // parts that were left out when reading
};

// Returns true if the file is a project: it has an SQLite header with Limber's application id.
bool is_project(const Path& path);

// Reads a project. Throws Error when the file is not a project, is damaged, was written by a newer version, or is in
// use.
Project read_project(const Path& path, Progress& progress = no_progress(), const ReadLimits& limits = {});
// Returns the project's thumbnail, or "" when there is none or the file cannot be read.
std::string read_thumbnail(const Path& path);

// Chunks that a new file gets in addition to those of its document. The next save removes them.
struct SpareChunks {
  std::vector<ChunkHash> hashes;
  ChunkSource* source = nullptr;
};

// Writes a new file, completely or not at all, in place of any file at `path`. Throws Error when the file cannot be
// written.
SaveMark create_project(const Project& project, const Path& path, DocumentWriter& writer,
                        Progress& progress = no_progress(), const SpareChunks& spare = {});

// Tells update_project() whether to remove or keep the chunks that only earlier saves need.
enum class Unused { Remove, Keep };

// Saves into an existing project file: writes only what has changed since the save with the mark `expected`. Throws
// Error when the file has another mark, is gone, or cannot be written; the file then stays as it was.
SaveMark update_project(const Project& project, const Path& path, const SaveMark& expected, Unused unused,
                        DocumentWriter& writer, Progress& progress = no_progress());
// Removes the chunks that the last save does not need.
void prune_project(const Path& path);

// Returns the mark of the file's last save.
SaveMark read_mark(const Path& path);
// Returns the hashes of the last save's root chunk and of all chunks that it names directly or indirectly.
ChunkSet reachable_chunks(const Path& path);

// Checks the database's structure and every chunk. Returns one line for each fault.
std::vector<std::string> verify_project(const Path& path, Progress& progress = no_progress());

struct ProjectSummary {
  std::string program;                                       // version of Limber that saved the file
  std::int64_t file_bytes = 0, chunks = 0, chunk_bytes = 0;  // chunk_bytes: packed size of all chunks
  bool has_thumbnail = false;
};
ProjectSummary summarize_project(const Path& path);

// Finds chunks in a project file. Readers of a journal need this class, since a journal omits the chunks that the
// project has.
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
