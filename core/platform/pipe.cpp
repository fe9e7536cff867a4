// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/pipe.h"

#include <array>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

namespace limber {

namespace {

constexpr int kOrders = STDIN_FILENO, kAnswers = STDOUT_FILENO;

std::error_code last_error() { return {errno, std::generic_category()}; }

// A message with one block of bytes and room for one file descriptor.
struct FileMessage {
  iovec part;
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> room{};
  msghdr message{};

  FileMessage(void* bytes, std::size_t size, bool has_file) : part{bytes, size} {
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    if (!has_file) return;
    message.msg_control = room.data();
    message.msg_controllen = room.size();
  }
  FileMessage(const FileMessage&) = delete;
  FileMessage& operator=(const FileMessage&) = delete;
};

}  // namespace

Pipe make_pipe(std::error_code& error, int buffer_bytes) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) {
    error = last_error();
    return {};
  }
  error.clear();
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  if (buffer_bytes > 0) ::fcntl(ends[0], F_SETPIPE_SZ, buffer_bytes);
  return {Handle(ends[0]), Handle(ends[1])};
}

FileChannel make_file_channel(std::error_code& error) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    error = last_error();
    return {};
  }
  error.clear();
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return {Handle(ends[0]), Handle(ends[1])};
}

std::ptrdiff_t read_some(const Handle& from, void* to, std::size_t size) {
  for (;;) {
    const ssize_t got = ::read(from.native(), to, size);
    if (got >= 0) return got;
    if (errno != EINTR) return errno == EAGAIN ? -1 : 0;
  }
}

std::ptrdiff_t send_some(const Handle& to, std::string_view bytes, const OpenFile* file) {
  FileMessage sent(const_cast<char*>(bytes.data()), bytes.size(), file != nullptr);
  if (file) {
    cmsghdr* control = CMSG_FIRSTHDR(&sent.message);
    control->cmsg_level = SOL_SOCKET;
    control->cmsg_type = SCM_RIGHTS;
    control->cmsg_len = CMSG_LEN(sizeof(int));
    const int native = file->handle().native();
    std::memcpy(CMSG_DATA(control), &native, sizeof native);
  }
  const ssize_t done = ::sendmsg(to.native(), &sent.message, MSG_NOSIGNAL);
  if (done >= 0) return done;
  return errno == EPIPE || errno == ECONNRESET ? 0 : -1;
}

bool wait_to_read(std::initializer_list<const Handle*> ends, int milliseconds) {
  std::array<pollfd, 4> ready{};
  nfds_t count = 0;
  for (const Handle* end : ends) ready.at(count++) = {end->native(), POLLIN, 0};
  return ::poll(ready.data(), count, milliseconds) != 0;
}

bool wait_to_write(const Handle& end, int milliseconds) {
  pollfd ready{end.native(), POLLOUT, 0};
  return ::poll(&ready, 1, milliseconds) != 0;
}

bool write_to_parent(std::string_view head, std::string_view body) {
  iovec both[2] = {{const_cast<char*>(head.data()), head.size()}, {const_cast<char*>(body.data()), body.size()}};
  iovec* parts = both;
  int count = body.empty() ? 1 : 2;
  while (count > 0) {
    ssize_t done = ::writev(kAnswers, parts, count);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    for (; count > 0 && static_cast<std::size_t>(done) >= parts->iov_len; ++parts, --count)
      done -= static_cast<ssize_t>(parts->iov_len);
    if (count == 0) return true;
    parts->iov_base = static_cast<char*>(parts->iov_base) + done;
    parts->iov_len -= static_cast<std::size_t>(done);
  }
  return true;
}

bool read_from_parent(void* to, std::size_t size, OpenFile* file) {
  auto* out = static_cast<char*>(to);
  if (file) {
    FileMessage heard(to, size, true);
    const ssize_t got = ::recvmsg(kOrders, &heard.message, MSG_CMSG_CLOEXEC);
    if (got <= 0) return false;
    if (const cmsghdr* control = CMSG_FIRSTHDR(&heard.message); control && control->cmsg_type == SCM_RIGHTS) {
      int native = -1;
      std::memcpy(&native, CMSG_DATA(control), sizeof native);
      *file = OpenFile(Handle(native));
    }
    out += got;
    size -= static_cast<std::size_t>(got);
  }
  while (size > 0) {
    const ssize_t got = ::read(kOrders, out, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    out += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

}  // namespace limber
