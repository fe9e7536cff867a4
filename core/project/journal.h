// SPDX-License-Identifier: AGPL-3.0-or-later
// What was edited since the last save, on disk: NAME.limber-edits beside the project, or a file of its own in the
// user's state folder for a project that was never saved. (NAME.limber-journal is SQLite's own.)
//
// A journal is appended to, record by record, each with a checksum: first a header, then chunks that neither the
// project nor the journal has, then the edit that they make whole, then a sync. Whatever a crash or a power cut leaves
// of the last write is no whole record and is not read. It starts anew, under another name that is then given to it,
// after each save: from then on it relies on the chunks of that save.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/project/document_codec.h"
#include "core/project/log_file.h"
#include "core/project/project_io.h"

namespace limber {

class JournalWriter final : public ChunkSink {
 public:
  // project  absolute, empty when never saved        base  the save that the journal builds on, with its chunks
  // Comes into being in one step, whole and locked. throws Error, also when the name is taken and not to be replaced
  struct Start {
    Path path, project;
    std::optional<SaveMark> base;
    ChunkSet base_chunks;
    bool replace = true;
    const Document* document = nullptr;  // the first edit, if any
    std::string label;
  };
  JournalWriter(Start start, DocumentWriter& writer, const OpenLog& open = open_log);

  // On the disk when it returns. throws Error; then write again, or start anew when broken().
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

// What a journal holds, as far as it is whole.
class JournalReader final : public ChunkSource {
 public:
  struct Edit {
    ChunkHash root;
    std::string label;
    std::int64_t time;  // s since 1970
  };
  // throws Error when it cannot be read or is no journal
  explicit JournalReader(const Path& path);
  ~JournalReader() override;

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
  int descriptor_ = -1;
  Path project_;
  std::optional<SaveMark> base_;
  std::vector<Edit> edits_;
  std::map<std::array<std::uint8_t, 32>, Place> chunks_;
};

// Edits that a session which did not end well has left.
struct Recoverable {
  Path journal, project;  // the project is empty when it was never saved
  std::string label;      // of the last edit
  std::int64_t time = 0;  // of the last edit, s since 1970
  std::int64_t edits = 0;
};

// $XDG_STATE_HOME/limber/edits, made when it is not there.
Path edits_folder();
// NAME.limber-edits
Path journal_path(const Path& project);

// Nothing when the journal is in use, cannot be read, or holds no edit that the project lacks.
std::optional<Recoverable> recoverable(const Path& journal);
// Of a journal that is open and has edits.
Recoverable recoverable(const JournalReader& reader, const Path& journal);
// All that the edits folder knows of, the latest first.
std::vector<Recoverable> all_recoverable(const Path& folder = edits_folder());

struct Recovered {
  Document document;
  Path project;
  std::string label;
  std::vector<std::string> warnings;  // edits and parts that could not be read
};
// The document after the last edit that is whole. throws Error when there is none
Recovered recover(const Path& journal, Progress& progress = no_progress());
// Removes the journal and the edits folder's note of it.
void discard(const Path& journal, const Path& folder = edits_folder());

}  // namespace limber
