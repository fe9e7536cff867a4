// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/project_io.h"

#include <cstring>
#include <random>

#include "core/base/error.h"
#include "core/base/leftovers.h"
#include "core/base/replaced_file.h"
#include "core/platform/open_file.h"
#include "core/project/database.h"

namespace limber {

namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kApplication = 0x4c696d62;  // the letters "Limb", by which SQLite identifies Limber's files
constexpr std::int64_t kSchemaVersion = 1;
constexpr const char* kChunkTable = "CREATE TABLE chunk(hash BLOB PRIMARY KEY, packed BLOB NOT NULL)";
constexpr const char* kStateTable = "CREATE TABLE state(name BLOB PRIMARY KEY, value BLOB NOT NULL) WITHOUT ROWID";
constexpr std::size_t kMostEditorBytes = std::size_t{16} << 20;
constexpr std::int64_t kMostFreeBytes = std::int64_t{16} << 20;  // free bytes up to which the file is not shrunk

std::string_view view(const ChunkHash& hash) {
  return {reinterpret_cast<const char*>(hash.bytes.data()), hash.bytes.size()};
}

std::string new_id() {
  std::random_device random;
  std::string id;
  for (int i = 0; i < 16; ++i) id += static_cast<char>(random() & 0xff);
  return id;
}

// ---- the database as a store of chunks and states

class Store final : public ChunkSource, public ChunkSink {
 public:
  explicit Store(Database& database)
      : find_(database, "SELECT packed FROM chunk WHERE hash = ?"),
        has_(database, "SELECT 1 FROM chunk WHERE hash = ?"),
        put_(database, "INSERT OR IGNORE INTO chunk VALUES (?, ?)"),
        get_state_(database, "SELECT value FROM state WHERE name = ?"),
        set_state_(database, "INSERT OR REPLACE INTO state VALUES (?, ?)") {}

  std::optional<std::string> find(const ChunkHash& hash) override { return first_of(find_, view(hash)); }
  bool has(const ChunkHash& hash) override {
    const bool there = has_.bind(1, view(hash)).step();
    has_.reset();
    return there;
  }
  void put(const ChunkHash& hash, const std::string& packed) override { put_.run(view(hash), packed); }

  std::optional<std::string> state(std::string_view name) { return first_of(get_state_, name); }
  void set_state(std::string_view name, std::string_view value) { set_state_.run(name, value); }

 private:
  static std::optional<std::string> first_of(Statement& statement, std::string_view key) {
    std::optional<std::string> value;
    if (statement.bind(1, key).step()) value = statement.bytes(0);
    statement.reset();
    return value;
  }
  Statement find_, has_, put_, get_state_, set_state_;
};

Error damaged(const Path& path) {
  return {"the project is damaged", path.string(),
          "open an earlier copy, or recover the undamaged parts: limber project " + path.string() +
              " recover -o OUT.limber"};
}

// Throws Error unless the database was made by Limber, has a known version, and has exactly the two tables of a
// project.
void check_schema(Database& database, const Path& path) {
  if (database.number("PRAGMA application_id") != kApplication)
    throw Error("this is not a Limber project", path.string(), "name a .limber file");
  const std::int64_t version = database.number("PRAGMA user_version");
  if (version > kSchemaVersion)
    throw Error("the project was written by a newer version of Limber", path.string(), "open it with that version");
  const std::string ours = std::string("SELECT count(*) FROM sqlite_schema WHERE sql IN ('")
                               .append(kChunkTable)
                               .append("', '")
                               .append(kStateTable)
                               .append("')");
  if (version != kSchemaVersion || database.number(ours) != 2 ||
      database.number("SELECT count(*) FROM sqlite_schema WHERE sql IS NOT NULL") != 2)
    throw damaged(path);
}

SaveMark mark_in(Store& store, const Path& path) {
  const auto root = store.state("root"), id = store.state("mark");
  SaveMark mark;
  if (!root || root->size() != mark.root.bytes.size() || !id) throw damaged(path);
  std::memcpy(mark.root.bytes.data(), root->data(), root->size());
  mark.id = *id;
  return mark;
}

void check_editor_bytes(const Project& project, const Path& path) {
  if (project.editor.size() > kMostEditorBytes || project.thumbnail.size() > kMostEditorBytes)
    throw Error("the editor's state or picture is larger than 16 MB", path.string(),
                "save the project without the state and the picture");
}

SaveMark fill(Store& store, const Project& project, DocumentWriter& writer, Packing packing, Progress& progress) {
  SaveMark mark{writer.write(project.document, store, packing, progress), new_id()};
  store.set_state("root", view(mark.root));
  store.set_state("mark", mark.id);
  store.set_state("editor", project.editor);
  store.set_state("thumbnail", project.thumbnail);
  store.set_state("program", LIMBER_VERSION);
  return mark;
}

void remove_unused(Database& database, Store& store, const ChunkHash& root, const Path& path) {
  ChunkSet reached;
  if (!reach(root, store, reached)) throw damaged(path);
  if (database.number("SELECT count(*) FROM chunk") == std::ssize(reached)) return;
  std::vector<std::string> unused;
  {
    Statement all(database, "SELECT hash FROM chunk");
    while (all.step()) {
      const std::string bytes = all.bytes(0);
      ChunkHash hash;
      if (bytes.size() != hash.bytes.size()) throw damaged(path);
      std::memcpy(hash.bytes.data(), bytes.data(), bytes.size());
      if (!reached.contains(hash)) unused.push_back(bytes);
    }
  }
  Statement remove(database, "DELETE FROM chunk WHERE hash = ?");
  for (const std::string& hash : unused) {
    remove.bind(1, hash).step();
    remove.reset();
  }
}

// Shrinks the file when more than half of its bytes, and more than kMostFreeBytes, are free.
void shrink(Database& database) {
  const std::int64_t free = database.number("PRAGMA freelist_count") * database.number("PRAGMA page_size");
  const std::int64_t all = database.number("PRAGMA page_count") * database.number("PRAGMA page_size");
  if (free > kMostFreeBytes && free > all / 2) database.run("PRAGMA incremental_vacuum");
}

// Makes SQLite commit durably: a commit returns only after the data and the removal of the journal have reached the
// disk.
void write_durably(Database& database) { database.run("PRAGMA journal_mode = DELETE; PRAGMA synchronous = EXTRA"); }

}  // namespace

bool is_project(const Path& path) {
  constexpr int kHeader = 72;
  try {
    const std::string header = Database::first_bytes(path, kHeader);
    return header.size() == kHeader && header.starts_with("SQLite format 3") &&
           std::memcmp(header.data() + 68, "Limb", 4) == 0;
  } catch (const Error&) {
    return false;
  }
}

Project read_project(const Path& path, Progress& progress, const ReadLimits& limits) {
  Database database(path, Database::Mode::Read);
  database.run("BEGIN");  // reads one state of the file, even while others write
  check_schema(database, path);
  Store store(database);
  Project project;
  project.mark = mark_in(store, path);
  project.editor = store.state("editor").value_or("");
  project.thumbnail = store.state("thumbnail").value_or("");
  project.document = read_document(project.mark.root, store, path.string(), project.warnings, limits, progress);
  return project;
}

std::string read_thumbnail(const Path& path) {
  try {
    Database database(path, Database::Mode::Read);
    check_schema(database, path);
    return Store(database).state("thumbnail").value_or("");
  } catch (const Error&) {
    return "";
  }
}

namespace {
Error not_written(const Path& path, const std::error_code& error) {
  if (error == std::errc::permission_denied || error == std::errc::read_only_file_system)
    return {"the project cannot be opened", path.string(), "check that you may read and write the file and its folder"};
  if (is_disk_full(error))
    return {"the project cannot be written: the disk is full", path.string(), "free some space, or save elsewhere"};
  return {"the project cannot be written", path.string(), error.message()};
}

// Syncs the temporary file to the disk and gives it the permissions of the project file `target` that it replaces.
void finish(const Path& temporary, const Path& target, const Path& path) {
  std::error_code error;
  OpenFile file(temporary, Opening::Read, error);
  if (error) throw not_written(path, error);
  file.take_permissions(target);
  error = file.flush();
  if (error) throw not_written(path, error);
}
}  // namespace

SaveMark create_project(const Project& project, const Path& path, DocumentWriter& writer, Progress& progress,
                        const SpareChunks& spare) {
  check_place(path);
  check_editor_bytes(project, path);
  const Path target = target_of(path);
  check_place(target);
  const Path folder = target.has_parent_path() ? target.parent_path() : Path(".");
  const Path temporary = temporary_name(target);
  const Unfinished unfinished(temporary);
  std::error_code error;
  fs::remove(temporary, error);
  // When the new file replaces a project, it is created with access for its owner alone. The project's own permissions
  // may keep others from reading it.
  const OpeningRules rules{.is_private = fs::exists(target, error)};
  OpenFile(temporary, Opening::New, error, rules);
  if (error) throw not_written(path, error);

  SaveMark mark;
  try {
    Database database(temporary, Database::Mode::Create);
    database.run(
        "PRAGMA page_size = 8192; PRAGMA auto_vacuum = INCREMENTAL; PRAGMA journal_mode = OFF; PRAGMA synchronous = "
        "FULL");
    database.run(("PRAGMA application_id = " + std::to_string(kApplication) +
                  "; PRAGMA user_version = " + std::to_string(kSchemaVersion))
                     .c_str());
    Transaction transaction(database);
    database.run(kChunkTable);
    database.run(kStateTable);
    Store store(database);
    mark = fill(store, project, writer, Packing::Dense, progress);
    for (const ChunkHash& hash : spare.hashes)
      if (const auto packed = spare.source->find(hash))
        store.put(hash, *packed);  // does nothing where the file already has the chunk
    transaction.commit();
  } catch (const Error& failure) {
    throw with_name(failure, temporary, path);
  }
  Database::clear_journal(target);  // else SQLite would apply the old file's journal to the new file
  finish(temporary, target, path);
  fs::rename(temporary, target, error);
  if (error) throw not_written(path, error);
  sync_folder(folder);
  return mark;
}

SaveMark update_project(const Project& project, const Path& path, const SaveMark& expected, Unused unused,
                        DocumentWriter& writer, Progress& progress) {
  check_editor_bytes(project, path);
  Database database(path, Database::Mode::Write);
  check_schema(database, path);
  write_durably(database);
  SaveMark mark;
  {
    Transaction transaction(database);
    Store store(database);
    if (mark_in(store, path) != expected)
      throw Error("another program has changed the project since it was opened", path.string(),
                  "save under another name, then compare the two");
    mark = fill(store, project, writer, Packing::Dense, progress);
    if (unused == Unused::Remove) remove_unused(database, store, mark.root, path);
    transaction.commit();
  }
  if (unused == Unused::Remove) shrink(database);
  return mark;
}

void prune_project(const Path& path) {
  Database database(path, Database::Mode::Write);
  check_schema(database, path);
  write_durably(database);
  {
    Transaction transaction(database);
    Store store(database);
    remove_unused(database, store, mark_in(store, path).root, path);
    transaction.commit();
  }
  shrink(database);
}

SaveMark read_mark(const Path& path) {
  Database database(path, Database::Mode::Read);
  check_schema(database, path);
  Store store(database);
  return mark_in(store, path);
}

ChunkSet reachable_chunks(const Path& path) {
  Database database(path, Database::Mode::Read);
  database.run("BEGIN");
  check_schema(database, path);
  Store store(database);
  ChunkSet reached;
  if (!reach(mark_in(store, path).root, store, reached)) throw damaged(path);
  return reached;
}

std::vector<std::string> verify_project(const Path& path, Progress& progress) {
  std::vector<std::string> wrong;
  Database database(path, Database::Mode::Read);
  database.run("BEGIN");
  check_schema(database, path);
  progress.update("verify", 0);
  {
    Statement check(database, "PRAGMA integrity_check");
    while (check.step())
      if (const std::string line = check.bytes(0); line != "ok") wrong.push_back("database: " + line);
  }
  const std::int64_t count = database.number("SELECT count(*) FROM chunk");
  std::int64_t seen = 0, damaged_chunks = 0;
  Statement all(database, "SELECT hash, packed FROM chunk");
  while (all.step()) {
    progress.update("verify", static_cast<double>(seen++) / static_cast<double>(count));
    ChunkHash hash;
    const std::string name = all.bytes(0);
    if (name.size() == hash.bytes.size()) std::memcpy(hash.bytes.data(), name.data(), name.size());
    damaged_chunks += name.size() != hash.bytes.size() || !unpack(all.bytes(1), hash);
  }
  if (damaged_chunks > 0)
    wrong.push_back(std::to_string(damaged_chunks) + " of " + std::to_string(count) + " chunks are damaged");
  Store store(database);
  ReadLimits limits;
  limits.leave_out_damaged = true;
  read_document(mark_in(store, path).root, store, path.string(), wrong, limits, progress);
  return wrong;
}

ProjectSummary summarize_project(const Path& path) {
  ProjectSummary summary;
  Database database(path, Database::Mode::Read);
  check_schema(database, path);
  Store store(database);
  summary.program = store.state("program").value_or("");
  summary.has_thumbnail = !store.state("thumbnail").value_or("").empty();
  summary.chunks = database.number("SELECT count(*) FROM chunk");
  summary.chunk_bytes = database.number("SELECT sum(length(packed)) FROM chunk");
  summary.file_bytes = static_cast<std::int64_t>(fs::file_size(path));
  return summary;
}

struct ProjectChunks::Open {
  Database database;
  Store store;
  explicit Open(const Path& path)
      : database(path, Database::Mode::Read),
        store((check_schema(database, path), database)) {}
};
ProjectChunks::ProjectChunks(const Path& path) : open_(std::make_unique<Open>(path)) {}
ProjectChunks::~ProjectChunks() = default;
std::optional<std::string> ProjectChunks::find(const ChunkHash& hash) { return open_->store.find(hash); }

}  // namespace limber
