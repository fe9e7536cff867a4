// SPDX-License-Identifier: AGPL-3.0-or-later
// A library that is loaded before the C library (LD_PRELOAD) into a program under test. It makes every n-th call of one
// kind fail, or kills the program at this call. LIMBER_FAIL is KIND:N or KIND:N:kill; kinds are write, open (for
// writing), rename and fsync. Calls on standard streams and on the notes on unfinished files never fail. Each failure
// adds a byte to the file LIMBER_FAIL_LOG.
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

namespace {

std::atomic<long> calls = 0;

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

void log_failure() {
  const char* log = std::getenv("LIMBER_FAIL_LOG");
  if (!log) return;
  const long file = ::syscall(SYS_openat, AT_FDCWD, log, O_WRONLY | O_CREAT | O_APPEND, 0600);
  if (file < 0) return;
  ::syscall(SYS_write, file, "x", 1);
  ::syscall(SYS_close, file);
}

bool is_note(const char* path) { return path && std::strstr(path, "/limber/unfinished/"); }

// Counts a call of the kind, and returns true if the call must fail.
bool fails(const char* kind, const char* path) {
  const char* wish = std::getenv("LIMBER_FAIL");
  if (!wish || is_note(path)) return false;
  const std::string text = wish, begin = std::string(kind) + ":";
  if (!text.starts_with(begin)) return false;
  const long n = std::strtol(text.c_str() + begin.size(), nullptr, 10);
  if (n <= 0 || ++calls % n != 0) return false;
  log_failure();
  if (text.ends_with(":kill")) ::raise(SIGKILL);
  return true;
}

bool fails(const char* kind, int descriptor) {
  if (descriptor <= STDERR_FILENO) return false;
  char path[4096];
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  const ssize_t size = ::readlink(link.c_str(), path, sizeof path - 1);
  path[size > 0 ? size : 0] = '\0';
  // Only files count. Pipes to other processes and sockets have no path.
  return path[0] == '/' && fails(kind, path);
}

template <class Number>
Number refuse(int reason) {
  errno = reason;
  return static_cast<Number>(-1);
}

bool opens_for_writing(int flags) { return (flags & O_ACCMODE) != O_RDONLY; }

mode_t mode_of(int flags, va_list& more) {
  return (flags & O_CREAT) || (flags & O_TMPFILE) == O_TMPFILE ? va_arg(more, mode_t) : 0;
}

}  // namespace

#define LIMBER_OPEN(NAME)                                                            \
  extern "C" int NAME(const char* path, int flags, ...) {                            \
    va_list more;                                                                    \
    va_start(more, flags);                                                           \
    const mode_t mode = mode_of(flags, more);                                        \
    va_end(more);                                                                    \
    if (opens_for_writing(flags) && fails("open", path)) return refuse<int>(ENOSPC); \
    return next<int(const char*, int, ...)>(#NAME)(path, flags, mode);               \
  }
LIMBER_OPEN(open)
LIMBER_OPEN(open64)

#define LIMBER_FOPEN(NAME)                                          \
  extern "C" FILE* NAME(const char* path, const char* how) {        \
    if (std::strpbrk(how, "wa+") && fails("open", path)) {          \
      errno = ENOSPC;                                               \
      return nullptr;                                               \
    }                                                               \
    return next<FILE*(const char*, const char*)>(#NAME)(path, how); \
  }
LIMBER_FOPEN(fopen)
LIMBER_FOPEN(fopen64)

extern "C" ssize_t write(int file, const void* bytes, size_t size) {
  if (fails("write", file)) return refuse<ssize_t>(ENOSPC);
  return next<ssize_t(int, const void*, size_t)>("write")(file, bytes, size);
}
extern "C" ssize_t writev(int file, const iovec* parts, int count) {
  if (fails("write", file)) return refuse<ssize_t>(ENOSPC);
  return next<ssize_t(int, const iovec*, int)>("writev")(file, parts, count);
}
extern "C" ssize_t pwrite(int file, const void* bytes, size_t size, off_t at) {
  if (fails("write", file)) return refuse<ssize_t>(ENOSPC);
  return next<ssize_t(int, const void*, size_t, off_t)>("pwrite")(file, bytes, size, at);
}
extern "C" ssize_t pwrite64(int file, const void* bytes, size_t size, off64_t at) {
  if (fails("write", file)) return refuse<ssize_t>(ENOSPC);
  return next<ssize_t(int, const void*, size_t, off64_t)>("pwrite64")(file, bytes, size, at);
}
extern "C" int rename(const char* from, const char* to) {
  if (fails("rename", to)) return refuse<int>(EIO);
  return next<int(const char*, const char*)>("rename")(from, to);
}
// Gives a name to a file without one (O_TMPFILE). It counts as a rename.
extern "C" int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) {
  if (fails("rename", to)) return refuse<int>(EIO);
  return next<int(int, const char*, int, const char*, int)>("linkat")(from_folder, from, to_folder, to, flags);
}
extern "C" int fsync(int file) {
  if (fails("fsync", file)) return refuse<int>(EIO);
  return next<int(int)>("fsync")(file);
}
extern "C" int fdatasync(int file) {
  if (fails("fsync", file)) return refuse<int>(EIO);
  return next<int(int)>("fdatasync")(file);
}
