// SPDX-License-Identifier: AGPL-3.0-or-later
// The journal keeps on disk what was edited since the last save: in NAME.limber-edits beside the project, or in a file
// in the user's state folder for a project that was never saved. (NAME.limber-journal belongs to SQLite.)
//
// A journal is a file of appended records, each with a checksum. It begins with a header. For each edit there follow
// the chunks that neither the project nor the journal has, and a record that names the edit's root chunk; then the file
// is synced to the disk. If a crash or a power cut interrupts a write, the last record is incomplete and is not read.
// After each save a new journal, written under another name and then renamed, replaces the old one and builds on the
// chunks of that save.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/platform/open_file.h"
#include "core/project/document_codec.h"
#include "core/project/log_file.h"
#include "core/project/project_io.h"

namespace limber {

class JournalWriter final : public ChunkSink {
 public:
  // The settings of a new journal. The writer's constructor first completes the file under another name, so that the
  // journal appears complete and locked. The constructor throws Error when the file cannot be written, or when a file
  // of this name exists and `replace` is false.
  //   project  absolute path, empty for a project that was never saved
  //   base     the save that the journal builds on; base_chunks lists that save's chunks
  struct Start {
    Path path, project;
    std::optional<SaveMark> base;
    ChunkSet base_chunks;
    bool replace = true;
    const Document* document = nullptr;  // the first edit to write; null: none
    std::string label;
  };
  JournalWriter(Start start, DocumentWriter& writer, const OpenLog& open = open_log);

  // Writes the document as an edit. When the call returns, the edit is on the disk. After an Error the caller calls
  // this again, or starts a new journal when broken() is true.
  void write(const Document& document, const std::string& label, DocumentWriter& writer);
  bool broken() const { return broken_; }
  std::int64_t bytes() const { return bytes_; }

  bool has(const ChunkHash& hash) override;
  void put(const ChunkHash& hash, const std::string& packed) override;

 private:
  void append(std::uint32_t type, const std::string& payload);
  ChunkSet chunks_;
  std::unique_ptr<LogFile> file_;
  std::int64_t bytes_ = 0;
  bool broken_ = false;
};

// Reads a journal up to its first record that is incomplete or damaged.
class JournalReader final : public ChunkSource {
 public:
  struct Edit {
    ChunkHash root;
    std::string label;
    std::int64_t time;  // time of the edit, seconds since 1970
  };
  // Throws Error when the journal cannot be read or is not a journal.
  explicit JournalReader(const Path& path);

  const Path& project() const { return project_; }
  const std::optional<SaveMark>& base() const { return base_; }
  const std::vector<Edit>& edits() const { return edits_; }
  std::optional<std::string> find(const ChunkHash& hash) override;

 private:
  struct Place {
    std::int64_t offset;
    std::uint32_t size;
  };
  void scan();
  std::string where_;
  OpenFile file_;
  Path project_;
  std::optional<SaveMark> base_;
  std::vector<Edit> edits_;
  std::map<std::array<std::uint8_t, 32>, Place> chunks_;
};

// Unsaved edits that an earlier session left in its journal.
struct Recoverable {
  Path journal, project;  // project: empty when it was never saved
  std::string label;      // label of the last edit
  std::int64_t time = 0;  // time of the last edit, seconds since 1970
  std::int64_t edits = 0;
};

// Returns $XDG_STATE_HOME/limber/edits (by default ~/.local/state/limber/edits) and creates the folder where it is
// missing.
Path edits_folder();
// Returns the project's path with "-edits" appended: NAME.limber-edits.
Path journal_path(const Path& project);

// Describes the unsaved edits in a journal. Returns nothing when the journal is in use or unreadable, or when its last
// edit is already saved in the project file.
std::optional<Recoverable> recoverable(const Path& journal);
// Describes the unsaved edits in a journal that is already open. The journal must have at least one edit.
Recoverable recoverable(const JournalReader& reader, const Path& journal);
// Describes the unsaved edits of all journals that are in the edits folder or linked from it, the latest first.
std::vector<Recoverable> all_recoverable(const Path& folder = edits_folder());

struct Recovered {
  Document document;
  Path project;
  std::string label;
  std::vector<std::string> warnings;  // edits and parts that could not be read
};
// Returns the document after the latest edit that is readable. Throws Error when no edit is readable.
Recovered recover(const Path& journal, Progress& progress = no_progress());
// Removes the journal and the link to it in the edits folder.
void discard(const Path& journal, const Path& folder = edits_folder());

}  // namespace limber
