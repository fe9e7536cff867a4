// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/named_file_vfs.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <new>
#include <vector>

#include <sqlite3.h>

#include "core/base/error.h"
#include "core/platform/file_system.h"

namespace limber {

struct NamedFileVfs::State {
  std::string name, database, journal, wal;
  Refusal refusal;
  sqlite3_vfs* system = nullptr;
  sqlite3_vfs own{};

  bool is_beside(const char* path) const { return path && (path == journal || path == wal); }
  void refuse(std::string what, std::string where, std::string what_to_do) {
    if (refusal.what.empty()) refusal = {std::move(what), std::move(where), std::move(what_to_do)};
  }
  void refuse_other_file(const char* path) {
    refuse("the project refers to another file, which a project of Limber never does",
           std::string(path ? path : "a temporary file"), "do not trust this project; open an earlier copy");
  }
};

namespace {

using State = NamedFileVfs::State;

// The last eight bytes of a journal that names a super-journal. In front of them are the super-journal's name, the
// name's length (4 bytes) and the sum of the name's bytes (4 bytes).
constexpr std::array<unsigned char, 8> kJournalMagic = {0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7};
constexpr int kSuperTail = 16;

State* state_of(sqlite3_vfs* vfs) { return static_cast<State*>(vfs->pAppData); }

// Gives `file` a copy of the system's file methods without shared memory and memory maps, since these would open other
// files. The copy is stored behind the system's own data of the file.
void limit_methods(sqlite3_file* file, int system_bytes) {
  auto* methods = new (reinterpret_cast<char*>(file) + system_bytes) sqlite3_io_methods(*file->pMethods);
  methods->iVersion = 1;
  file->pMethods = methods;
}

bool is_regular_or_missing(const char* path) {
  const auto status = status_of_link(path);
  return !status || status->is_regular;
}

// Returns true if the journal ends like one that names a super-journal. The sum of the name's bytes is not verified,
// since a wrong sum does not make the journal harmless.
bool names_super_journal(sqlite3_file* file) {
  sqlite3_int64 size = 0;
  std::array<unsigned char, kSuperTail> tail{};
  if (file->pMethods->xFileSize(file, &size) != SQLITE_OK || size < kSuperTail) return false;
  if (file->pMethods->xRead(file, tail.data(), kSuperTail, size - kSuperTail) != SQLITE_OK) return false;
  const bool has_length = tail[0] || tail[1] || tail[2] || tail[3];
  return has_length &&
         std::memcmp(tail.data() + kSuperTail - kJournalMagic.size(), kJournalMagic.data(), kJournalMagic.size()) == 0;
}

// Returns true when the file does not begin like a journal. Such a file must be refused: SQLite would treat any file
// with the journal's name as its journal and delete it.
bool is_no_journal(sqlite3_file* file) {
  sqlite3_int64 size = 0;
  std::array<unsigned char, 8> begin{};
  if (file->pMethods->xFileSize(file, &size) != SQLITE_OK || size == 0) return false;
  const int length = static_cast<int>(std::min<sqlite3_int64>(size, std::ssize(begin)));
  if (file->pMethods->xRead(file, begin.data(), length, 0) != SQLITE_OK) return false;
  return begin[0] != 0 && begin != kJournalMagic;
}

// Checks the journal that has just been opened. Returns true when it must be refused, and records the reason in
// `state`.
bool refuse_journal(State& state, sqlite3_file* file) {
  const std::string move_away =
      "move this file away if you do not know where it comes from, then check the project: limber project " +
      state.database + " verify";
  if (names_super_journal(file))
    state.refuse("the journal beside the project names another file, which no journal of Limber's does", state.journal,
                 move_away);
  else if (is_no_journal(file))
    state.refuse("the file beside the project is not the project's journal", state.journal, move_away);
  else return false;
  return true;
}

int open_file(sqlite3_vfs* vfs, sqlite3_filename path, sqlite3_file* file, int flags, int* out_flags) {
  State& state = *state_of(vfs);
  file->pMethods = nullptr;
  const bool known = path && ((flags & SQLITE_OPEN_MAIN_DB && path == state.database) ||
                              (flags & SQLITE_OPEN_MAIN_JOURNAL && path == state.journal) ||
                              (flags & SQLITE_OPEN_WAL && path == state.wal));
  if (!known) {
    state.refuse_other_file(path);
    return SQLITE_CANTOPEN;
  }
  if (path != state.database && !is_regular_or_missing(path)) {
    state.refuse("the file beside the project is not a regular file", path,
                 "remove this file if you do not know where it comes from, then open the project again");
    return SQLITE_CANTOPEN;
  }
  const int code = state.system->xOpen(state.system, path, file, flags, out_flags);
  if (code != SQLITE_OK) return code;
  if (path == state.journal && refuse_journal(state, file)) {
    file->pMethods->xClose(file);
    file->pMethods = nullptr;
    return SQLITE_CANTOPEN;
  }
  limit_methods(file, state.system->szOsFile);
  return SQLITE_OK;
}

int delete_file(sqlite3_vfs* vfs, const char* path, int sync_folder) {
  State& state = *state_of(vfs);
  if (state.is_beside(path)) return state.system->xDelete(state.system, path, sync_folder);
  state.refuse_other_file(path);
  return SQLITE_IOERR_DELETE;
}

int access_file(sqlite3_vfs* vfs, const char* path, int flags, int* result) {
  State& state = *state_of(vfs);
  if (state.is_beside(path)) return state.system->xAccess(state.system, path, flags, result);
  state.refuse_other_file(path);
  return SQLITE_IOERR_ACCESS;
}

int full_path(sqlite3_vfs* vfs, const char* path, int size, char* out) {
  State& state = *state_of(vfs);
  return state.system->xFullPathname(state.system, path, size, out);
}

// Keeps SQLite from loading any library.
void* load_nothing(sqlite3_vfs*, const char*) { return nullptr; }
void tell_nothing(sqlite3_vfs*, int size, char* message) {
  if (size > 0) message[0] = '\0';
}

int random_bytes(sqlite3_vfs* vfs, int size, char* out) {
  return state_of(vfs)->system->xRandomness(state_of(vfs)->system, size, out);
}
int sleep_for(sqlite3_vfs* vfs, int microseconds) {
  return state_of(vfs)->system->xSleep(state_of(vfs)->system, microseconds);
}
int current_time(sqlite3_vfs* vfs, double* days) {
  return state_of(vfs)->system->xCurrentTime(state_of(vfs)->system, days);
}
int last_error(sqlite3_vfs* vfs, int size, char* out) {
  return state_of(vfs)->system->xGetLastError(state_of(vfs)->system, size, out);
}

std::string absolute_path(sqlite3_vfs& system, const Path& path) {
  std::vector<char> full(static_cast<std::size_t>(system.mxPathname) + 1);
  const int code = system.xFullPathname(&system, path.string().c_str(), static_cast<int>(full.size()), full.data());
  if ((code & 0xff) != SQLITE_OK || !Path(full.data()).is_absolute())
    throw Error("the project cannot be opened", path.string(), "use a shorter path, and check its links");
  return full.data();
}

}  // namespace

NamedFileVfs::NamedFileVfs(const Path& database) : state_(std::make_unique<State>()) {
  static std::atomic<std::int64_t> count = 0;
  State& state = *state_;
  state.system = sqlite3_vfs_find(nullptr);
  if (!state.system) throw std::bad_alloc();
  state.name = "limber-" + std::to_string(++count);
  state.database = absolute_path(*state.system, database);
  state.journal = state.database + "-journal";
  state.wal = state.database + "-wal";
  state.own = {.iVersion = 1,
               .szOsFile = state.system->szOsFile + static_cast<int>(sizeof(sqlite3_io_methods)),
               .mxPathname = state.system->mxPathname,
               .zName = state.name.c_str(),
               .pAppData = &state,
               .xOpen = open_file,
               .xDelete = delete_file,
               .xAccess = access_file,
               .xFullPathname = full_path,
               .xDlOpen = load_nothing,
               .xDlError = tell_nothing,
               .xRandomness = random_bytes,
               .xSleep = sleep_for,
               .xCurrentTime = current_time,
               .xGetLastError = last_error};
  if (sqlite3_vfs_register(&state.own, 0) != SQLITE_OK) throw std::bad_alloc();
}

NamedFileVfs::~NamedFileVfs() { sqlite3_vfs_unregister(&state_->own); }

const std::string& NamedFileVfs::name() const { return state_->name; }
const std::string& NamedFileVfs::database() const { return state_->database; }
const NamedFileVfs::Refusal& NamedFileVfs::refusal() const { return state_->refusal; }

}  // namespace limber
