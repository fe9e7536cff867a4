// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/support/power_cut.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <vector>

#include <sqlite3.h>
#include <sys/stat.h>

#include "core/base/error.h"
#include "tests/support/program.h"

namespace limber::test {

namespace {
namespace fs = std::filesystem;

constexpr std::int64_t kSector = 512;
constexpr auto kCopy = fs::copy_options::recursive | fs::copy_options::copy_symlinks;

// The contents of a file: as programs read them now, and as they were at the last sync.
struct Image {
  std::string seen, synced;
};

ino_t inode_of(const Path& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 ? status.st_ino : 0;
}

// A journal file, which gets another name after it was made.
struct LogImage {
  std::shared_ptr<Image> image;
  Path first_name, last_name;
  ino_t inode = 0;
};

// Returns the contents that a file has on the disk after the power cut.
std::string after_the_cut(const Image& image, std::mt19937& random) {
  std::string disk = image.synced;
  // The length is that at the last sync, the newest, or one in between.
  const std::size_t low = std::min(image.seen.size(), disk.size()), high = std::max(image.seen.size(), disk.size());
  std::size_t length = random() % 2 ? image.seen.size() : disk.size();
  if (random() % 4 == 0) length = low + random() % (high - low + 1);
  disk.resize(length, '\0');
  for (std::size_t at = 0; at < std::min(length, image.seen.size()); at += kSector) {
    const std::size_t size = std::min<std::size_t>(kSector, std::min(length, image.seen.size()) - at);
    if (random() % 2) std::memcpy(disk.data() + at, image.seen.data() + at, size);
  }
  return disk;
}

std::string bytes_of(const std::string& path) {
  FILE* file = std::fopen(path.c_str(), "rb");
  std::string bytes;
  char block[1 << 16];
  for (std::size_t got = 0; file && (got = std::fread(block, 1, sizeof block, file)) > 0;) bytes.append(block, got);
  if (file) std::fclose(file);
  return bytes;
}

void put_bytes(const std::string& path, const std::string& bytes) {
  if (FILE* file = std::fopen(path.c_str(), "wb")) {
    std::fwrite(bytes.data(), 1, bytes.size(), file);
    std::fclose(file);
  }
}
}  // namespace

struct PowerCut::Disk {
  std::mutex mutex;
  std::int64_t operations = 0, cut_at = 0;
  std::mt19937 random;
  bool dead = false;
  std::map<std::string, std::shared_ptr<Image>> open;  // the files that SQLite has open, by path
  std::vector<LogImage> logs;
  std::map<std::string, std::string> removed;  // contents of removed files whose removal is not synced yet, by path
  Path folder;
  std::unique_ptr<TemporaryFolder> left;  // copy of the folder as it was on the disk after the power cut
  sqlite3_vfs* system = nullptr;
  sqlite3_vfs own{};

  // Counts an operation. Returns true if the power is off, or goes off with this operation.
  bool strikes() {
    if (dead) return true;
    if (++operations < cut_at) return false;
    dead = true;
    left = std::make_unique<TemporaryFolder>();
    fs::copy(folder, left->path(), kCopy);
    for (const auto& [path, bytes] : removed)
      if (random() % 2 && !fs::exists(in_left(path))) put_bytes(in_left(path), bytes);
    for (const auto& [path, image] : open)
      if (!path.empty()) put_bytes(in_left(path), after_the_cut(*image, random));
    for (const LogImage& log : logs)
      for (const Path& name : {log.first_name, log.last_name})
        if (inode_of(name) == log.inode) put_bytes(in_left(name), after_the_cut(*log.image, random));
    return true;
  }
  Path in_left(const Path& path) const { return left->path() / fs::relative(path, folder); }
};

namespace {

// ---- Files of SQLite. Each is based on a file of the system's own VFS, which opens and locks it.

struct File {
  sqlite3_file base;
  PowerCut::Disk* disk;
  std::string* path;
  std::shared_ptr<Image>* image;
  sqlite3_file* system() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};
File* as_file(sqlite3_file* file) { return reinterpret_cast<File*>(file); }

int close_file(sqlite3_file* raw) {
  File* file = as_file(raw);
  const std::lock_guard lock(file->disk->mutex);
  delete file->image;
  // If no other handle has the file open, its contents are forgotten: they are in the system's file, and count as
  // synced.
  if (const auto at = file->disk->open.find(*file->path); at != file->disk->open.end() && at->second.use_count() == 1)
    file->disk->open.erase(at);
  delete file->path;
  return file->system()->pMethods->xClose(file->system());
}

int read_file_at(sqlite3_file* raw, void* to, int size, sqlite3_int64 at) {
  File* file = as_file(raw);
  if (file->disk->dead) return SQLITE_IOERR_READ;
  return file->system()->pMethods->xRead(file->system(), to, size, at);
}

int write_file_at(sqlite3_file* raw, const void* from, int size, sqlite3_int64 at) {
  File* file = as_file(raw);
  const std::lock_guard lock(file->disk->mutex);
  std::string& seen = (*file->image)->seen;
  if (!file->disk->dead) {
    if (seen.size() < static_cast<std::size_t>(at + size)) seen.resize(static_cast<std::size_t>(at + size), '\0');
    std::memcpy(seen.data() + at, from, static_cast<std::size_t>(size));
  }
  if (file->disk->strikes()) return SQLITE_IOERR_WRITE;
  return file->system()->pMethods->xWrite(file->system(), from, size, at);
}

int truncate_file(sqlite3_file* raw, sqlite3_int64 size) {
  File* file = as_file(raw);
  const std::lock_guard lock(file->disk->mutex);
  if (!file->disk->dead) (*file->image)->seen.resize(static_cast<std::size_t>(size), '\0');
  if (file->disk->strikes()) return SQLITE_IOERR_TRUNCATE;
  return file->system()->pMethods->xTruncate(file->system(), size);
}

int sync_file(sqlite3_file* raw, int) {
  File* file = as_file(raw);
  const std::lock_guard lock(file->disk->mutex);
  if (file->disk->strikes()) return SQLITE_IOERR_FSYNC;
  (*file->image)->synced = (*file->image)->seen;
  return SQLITE_OK;
}

int file_size(sqlite3_file* raw, sqlite3_int64* size) {
  return as_file(raw)->system()->pMethods->xFileSize(as_file(raw)->system(), size);
}
int lock_file(sqlite3_file* raw, int level) {
  return as_file(raw)->system()->pMethods->xLock(as_file(raw)->system(), level);
}
int unlock_file(sqlite3_file* raw, int level) {
  return as_file(raw)->system()->pMethods->xUnlock(as_file(raw)->system(), level);
}
int check_lock(sqlite3_file* raw, int* held) {
  return as_file(raw)->system()->pMethods->xCheckReservedLock(as_file(raw)->system(), held);
}
int control(sqlite3_file* raw, int what, void* with) {
  return as_file(raw)->system()->pMethods->xFileControl(as_file(raw)->system(), what, with);
}
int sector_size(sqlite3_file*) { return static_cast<int>(kSector); }
int characteristics(sqlite3_file*) { return 0; }

const sqlite3_io_methods kMethods = {.iVersion = 1,
                                     .xClose = close_file,
                                     .xRead = read_file_at,
                                     .xWrite = write_file_at,
                                     .xTruncate = truncate_file,
                                     .xSync = sync_file,
                                     .xFileSize = file_size,
                                     .xLock = lock_file,
                                     .xUnlock = unlock_file,
                                     .xCheckReservedLock = check_lock,
                                     .xFileControl = control,
                                     .xSectorSize = sector_size,
                                     .xDeviceCharacteristics = characteristics};

int open_file(sqlite3_vfs* vfs, const char* name, sqlite3_file* raw, int flags, int* out_flags) {
  auto* disk = static_cast<PowerCut::Disk*>(vfs->pAppData);
  File* file = as_file(raw);
  file->base.pMethods = nullptr;
  if (disk->dead) return SQLITE_CANTOPEN;
  const int code = disk->system->xOpen(disk->system, name, file->system(), flags, out_flags);
  if (code != SQLITE_OK) return code;
  const std::lock_guard lock(disk->mutex);
  file->disk = disk;
  file->path = new std::string(name ? name : "");
  std::shared_ptr<Image>& image = disk->open[*file->path];
  if (!image) {
    image = std::make_shared<Image>();
    image->seen = image->synced = bytes_of(*file->path);
  }
  file->image = new std::shared_ptr<Image>(image);
  file->base.pMethods = &kMethods;
  return SQLITE_OK;
}

int remove_file(sqlite3_vfs* vfs, const char* name, int sync_folder) {
  auto* disk = static_cast<PowerCut::Disk*>(vfs->pAppData);
  const std::lock_guard lock(disk->mutex);
  if (!disk->dead && !sync_folder) disk->removed[name] = bytes_of(name);
  if (disk->strikes()) return SQLITE_IOERR_DELETE;
  if (sync_folder) disk->removed.clear();
  return disk->system->xDelete(disk->system, name, 0);
}

int access_file(sqlite3_vfs* vfs, const char* name, int flags, int* result) {
  auto* disk = static_cast<PowerCut::Disk*>(vfs->pAppData);
  return disk->system->xAccess(disk->system, name, flags, result);
}

// ---- The journal

class Log final : public LogFile {
 public:
  Log(PowerCut::Disk& disk, const Path& path)
      : disk_(disk),
        image_(std::make_shared<Image>()),
        file_(limber::open_log(path)) {
    const std::lock_guard lock(disk_.mutex);
    Path last_name = path;
    last_name.replace_extension();  // removes ".new" from the name
    disk_.logs.push_back({image_, path, last_name, inode_of(path)});
  }
  ~Log() override {
    const std::lock_guard lock(disk_.mutex);
    std::erase_if(disk_.logs, [&](const LogImage& log) { return log.image == image_; });
  }
  void append(std::string_view bytes) override {
    const std::lock_guard lock(disk_.mutex);
    if (!disk_.dead) image_->seen += bytes;
    strike();
    file_->append(bytes);
  }
  void sync() override {
    const std::lock_guard lock(disk_.mutex);
    strike();
    image_->synced = image_->seen;
  }
  void cut(std::int64_t size) override {
    const std::lock_guard lock(disk_.mutex);
    if (disk_.dead) return;
    image_->seen.resize(static_cast<std::size_t>(size));
    file_->cut(size);
  }

 private:
  void strike() {
    if (disk_.strikes()) throw Error("the power is gone", "disk", "");
  }
  PowerCut::Disk& disk_;
  std::shared_ptr<Image> image_;
  std::unique_ptr<LogFile> file_;
};

}  // namespace

PowerCut::PowerCut(const Path& folder, std::int64_t operation, std::uint32_t seed) : disk_(std::make_unique<Disk>()) {
  disk_->folder = folder;
  disk_->cut_at = operation;
  disk_->random.seed(seed);
  disk_->system = sqlite3_vfs_find("unix");
  disk_->own = *disk_->system;
  sqlite3_vfs& own = disk_->own;
  own.iVersion = 1;
  own.pNext = nullptr;
  own.zName = "power-cut";
  own.pAppData = disk_.get();
  own.szOsFile = static_cast<int>(sizeof(File)) + disk_->system->szOsFile;
  own.xOpen = open_file;
  own.xDelete = remove_file;
  own.xAccess = access_file;
  sqlite3_vfs_register(&own, 1);
}

PowerCut::~PowerCut() {
  sqlite3_vfs_unregister(&disk_->own);
  sqlite3_vfs_register(disk_->system, 1);
}

OpenLog PowerCut::open_log() {
  return [disk = disk_.get()](const Path& path) { return std::make_unique<Log>(*disk, path); };
}

void PowerCut::restore() {
  for (const auto& entry : fs::directory_iterator(disk_->folder)) fs::remove_all(entry.path());
  fs::copy(disk_->left->path(), disk_->folder, kCopy);
}

bool PowerCut::happened() const {
  const std::lock_guard lock(disk_->mutex);
  return disk_->dead;
}

std::int64_t PowerCut::operations() const {
  const std::lock_guard lock(disk_->mutex);
  return disk_->operations;
}

}  // namespace limber::test
