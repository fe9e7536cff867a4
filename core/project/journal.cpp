// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/journal.h"

#include <algorithm>
#include <chrono>
#include <cstring>

#include "core/base/bytes.h"
#include "core/base/error.h"
#include "core/base/leftovers.h"
#include "core/platform/desktop.h"
#include "core/project/carved_chunks.h"

namespace limber {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "LimberEd";
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeadBytes = 8, kSumBytes = 8;
// Upper limit on a record's payload, bytes. Compression can make a chunk slightly longer, so the limit exceeds the
// limit of an unpacked chunk by 1 MB.
constexpr std::size_t kMostPayload = kLargestChunk + (std::size_t{1} << 20);

enum RecordType : std::uint32_t { kHeader = 1, kChunk = 2, kEdit = 3 };

std::int64_t now() {
  return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// Returns a journal record: type, length, payload and checksum. The checksum is the first bytes of the SHA-256 of
// everything before it.
std::string record(std::uint32_t type, const std::string& payload) {
  ByteWriter out;
  out.put(type);
  out.text(payload);
  std::string bytes = out.take();
  const auto sum = sha256(bytes.data(), bytes.size());
  bytes.append(reinterpret_cast<const char*>(sum.data()), kSumBytes);
  return bytes;
}

void put_hash(ByteWriter& out, const ChunkHash& hash) { out.raw(hash.bytes.data(), hash.bytes.size()); }
ChunkHash get_hash(ByteReader& in) {
  ChunkHash hash;
  std::memcpy(hash.bytes.data(), in.raw(hash.bytes.size()).data(), hash.bytes.size());
  return hash;
}

std::string header_payload(const JournalWriter::Start& start) {
  ByteWriter out;
  out.raw(kMagic.data(), kMagic.size());
  out.put(kVersion);
  out.text(start.project.string());
  out.flag(start.base.has_value());
  const SaveMark base = start.base.value_or(SaveMark{});
  put_hash(out, base.root);
  out.text(base.id);
  return out.take();
}

Error no_journal(const std::string& where) {
  return {"this is not a journal of edits, or its beginning is damaged", where, "open the project itself"};
}

struct Malformed {};

}  // namespace

// ---- writing a journal

JournalWriter::JournalWriter(Start start, DocumentWriter& writer, const OpenLog& open)
    : chunks_(std::move(start.base_chunks)) {
  const Path fresh = start.path.string() + ".new";
  const Unfinished unfinished(fresh);
  file_ = open(fresh);
  append(kHeader, header_payload(start));
  if (start.document) write(*start.document, start.label, writer);
  else file_->sync();
  std::error_code error;
  if (!start.replace) fs::create_hard_link(fresh, start.path, error);
  if (start.replace || (error && error != std::errc::file_exists)) fs::rename(fresh, start.path, error);
  if (error) throw Error("unsaved edits cannot be written to disk", start.path.string(), error.message());
  sync_folder(start.path.parent_path());
}

bool JournalWriter::has(const ChunkHash& hash) { return chunks_.contains(hash); }

void JournalWriter::put(const ChunkHash& hash, const std::string& packed) {
  ByteWriter out;
  put_hash(out, hash);
  out.raw(packed.data(), packed.size());
  append(kChunk, out.take());
  chunks_.insert(hash);
}

void JournalWriter::append(std::uint32_t type, const std::string& payload) {
  const std::string bytes = record(type, payload);
  try {
    file_->append(bytes);
  } catch (...) {
    file_->cut(bytes_);
    throw;
  }
  bytes_ += std::ssize(bytes);
}

void JournalWriter::write(const Document& document, const std::string& label, DocumentWriter& writer) {
  const ChunkHash root = writer.write(document, *this, Packing::Quick);
  ByteWriter out;
  put_hash(out, root);
  out.text(label);
  out.put(now());
  append(kEdit, out.take());
  try {
    file_->sync();
  } catch (...) {
    // The journal cannot be continued, since it is unknown which bytes of the failed write are on the disk.
    broken_ = true;
    throw;
  }
}

// ---- reading a journal

JournalReader::JournalReader(const Path& path) : where_(path.string()) {
  std::error_code error;
  file_ = OpenFile(path, Opening::Read, error);
  if (error) throw Error("the journal of edits cannot be opened", where_, error.message());
  scan();
}

// Reads the journal's records up to the first one that is incomplete or damaged.
void JournalReader::scan() {
  std::int64_t offset = 0;
  const std::int64_t end = file_.size();
  for (bool first = true;; first = false) {
    char head[kHeadBytes];
    std::uint32_t type = 0, size = 0;
    bool whole = file_.read_at(offset, head, sizeof head) == sizeof head;
    std::memcpy(&type, head, sizeof type);
    std::memcpy(&size, head + sizeof type, sizeof size);
    whole = whole && size <= kMostPayload && offset + static_cast<std::int64_t>(kHeadBytes + size + kSumBytes) <= end;
    std::string bytes;
    if (whole) {
      bytes.resize(kHeadBytes + size + kSumBytes);
      whole = file_.read_at(offset, bytes.data(), bytes.size()) == bytes.size();
    }
    if (whole) {
      const auto sum = sha256(bytes.data(), kHeadBytes + size);
      whole = std::memcmp(sum.data(), bytes.data() + kHeadBytes + size, kSumBytes) == 0;
    }
    if (!whole || (first && type != kHeader)) {
      if (first) throw no_journal(where_);
      return;
    }
    try {
      ByteReader in(std::string_view(bytes).substr(kHeadBytes, size), [] { throw Malformed(); });
      if (type == kHeader) {
        in.require(first && in.raw(kMagic.size()) == kMagic);
        if (in.get<std::uint32_t>() != kVersion)
          throw Error("the journal of edits was written by another version of Limber", where_,
                      "open it with that version");
        project_ = in.text();
        const bool has_base = in.flag();
        SaveMark base;
        base.root = get_hash(in);
        base.id = in.text();
        if (has_base) base_ = base;
      } else if (type == kChunk) {
        const ChunkHash hash = get_hash(in);
        chunks_[hash.bytes] = {offset + static_cast<std::int64_t>(kHeadBytes + sizeof(ChunkHash)),
                               static_cast<std::uint32_t>(size - sizeof(ChunkHash))};
      } else if (type == kEdit) {
        Edit edit;
        edit.root = get_hash(in);
        edit.label = in.text();
        edit.time = in.get<std::int64_t>();
        edits_.push_back(std::move(edit));
      }
    } catch (const Malformed&) {
      throw no_journal(where_);
    }
    offset += static_cast<std::int64_t>(kHeadBytes + size + kSumBytes);
  }
}

std::optional<std::string> JournalReader::find(const ChunkHash& hash) {
  const auto place = chunks_.find(hash.bytes);
  if (place == chunks_.end()) return std::nullopt;
  std::string packed(place->second.size, '\0');
  if (file_.read_at(place->second.offset, packed.data(), packed.size()) != packed.size()) return std::nullopt;
  return packed;
}

// ---- the journals of earlier sessions

Path edits_folder() {
  const Path state = user_folder(UserFolder::State);
  const Path folder = (state.empty() ? fs::temp_directory_path() : state) / "limber" / "edits";
  std::error_code ignored;
  fs::create_directories(folder, ignored);
  return folder;
}

Path journal_path(const Path& project) { return project.string() + "-edits"; }

namespace {
// Returns the hash of the root chunk of the project's last save, or nothing when the project cannot be read.
std::optional<ChunkHash> saved_root(const Path& project) {
  try {
    if (is_project(project)) return read_mark(project).root;
  } catch (const Error&) {  // damaged or in use: the caller then treats the journal's edits as unsaved
  }
  return std::nullopt;
}
}  // namespace

std::optional<Recoverable> recoverable(const Path& journal) {
  try {
    std::error_code error;
    if (!fs::is_regular_file(journal, error)) return std::nullopt;
    const FileLock lock(journal);
    if (!lock.taken()) return std::nullopt;
    const JournalReader reader(journal);
    if (reader.edits().empty() || saved_root(reader.project()) == reader.edits().back().root) return std::nullopt;
    return recoverable(reader, journal);
  } catch (const Error&) {
    return std::nullopt;
  }
}

Recoverable recoverable(const JournalReader& reader, const Path& journal) {
  const JournalReader::Edit& last = reader.edits().back();
  return {journal, reader.project(), last.label, last.time, std::ssize(reader.edits())};
}

std::vector<Recoverable> all_recoverable(const Path& folder) {
  std::vector<Recoverable> all;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".edits") continue;
    std::error_code ignored;
    Path journal = entry.path();
    if (entry.is_symlink(ignored)) journal = fs::read_symlink(journal, ignored);
    if (!fs::exists(journal, ignored)) {
      fs::remove(entry.path(), ignored);
      continue;
    }
    if (auto one = recoverable(journal)) all.push_back(std::move(*one));
  }
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.time > b.time; });
  return all;
}

namespace {

// A chunk source that looks for a chunk in the journal first, then in the saved project.
class Both final : public ChunkSource {
 public:
  Both(JournalReader& journal, ChunkSource* saved) : journal_(journal), saved_(saved) {}
  std::optional<std::string> find(const ChunkHash& hash) override {
    if (auto packed = journal_.find(hash)) return packed;
    return saved_ ? saved_->find(hash) : std::nullopt;
  }

 private:
  JournalReader& journal_;
  ChunkSource* saved_;
};

// Reads the latest edit of the journal that is readable within the limits. Returns false when no edit is readable.
bool read_latest(const JournalReader& reader, ChunkSource& source, const ReadLimits& limits, const Path& journal,
                 Recovered& recovered, Progress& progress) {
  const auto& edits = reader.edits();
  for (auto edit = edits.rbegin(); edit != edits.rend(); ++edit) {
    try {
      std::vector<std::string> warnings;
      Document document = read_document(edit->root, source, journal.string(), warnings, limits, progress);
      if (limits.leave_out_damaged && document == Document{}) continue;
      recovered.document = std::move(document);
      recovered.project = reader.project();
      recovered.label = edit->label;
      recovered.warnings.insert(recovered.warnings.end(), warnings.begin(), warnings.end());
      if (edit != edits.rbegin())
        recovered.warnings.push_back("the last " + std::to_string(edit - edits.rbegin()) +
                                     " edits could not be read: parts of the project are missing");
      return true;
    } catch (const Error&) {
      continue;  // tries the edit before this one
    }
  }
  return false;
}

}  // namespace

Recovered recover(const Path& journal, Progress& progress) {
  JournalReader reader(journal);
  std::unique_ptr<ProjectChunks> saved;
  Recovered recovered;
  try {
    if (!reader.project().empty()) saved = std::make_unique<ProjectChunks>(reader.project());
  } catch (const Error& error) {
    recovered.warnings.push_back(error.what());
  }
  Both both(reader, saved.get());
  if (read_latest(reader, both, {}, journal, recovered, progress)) return recovered;

  // No edit is readable, so the project file on which the journal builds must be damaged. Searches that file for
  // undamaged chunks, and reads the latest edit of which at least one part is readable.
  std::error_code error;
  if (fs::is_regular_file(reader.project(), error)) {
    CarvedChunks carved(reader.project(), progress);
    Both with_carved(reader, &carved);
    ReadLimits limits;
    limits.leave_out_damaged = true;
    if (read_latest(reader, with_carved, limits, journal, recovered, progress)) return recovered;
  }
  throw Error(
      "no edit can be recovered", journal.string(),
      reader.edits().empty() ? "the journal is empty" : "the project that the edits change is missing or damaged");
}

void discard(const Path& journal, const Path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::error_code ignored;
    if (entry.is_symlink(ignored) && fs::read_symlink(entry.path(), ignored) == journal)
      fs::remove(entry.path(), ignored);
  }
  fs::remove(journal, error);
}

}  // namespace limber
