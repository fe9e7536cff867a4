// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/serve_volume.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>

#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include "core/base/error.h"
#include "core/volume_io/dicom.h"
#include "core/volume_io/reader_messages.h"

namespace limber {

namespace {

constexpr std::size_t kChunk = 1 << 18;  // voxel bytes of one message, so few that they stay in a cache
constexpr int kOrders = STDIN_FILENO, kAnswers = STDOUT_FILENO;

// Ends this process. It is called when the channel to the program is closed, since nobody then reads an answer.
[[noreturn]] void leave() { ::_exit(1); }

void write_all(iovec* parts, int count) {
  while (count > 0) {
    ssize_t done = ::writev(kAnswers, parts, count);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) leave();
    for (; count > 0 && static_cast<std::size_t>(done) >= parts->iov_len; ++parts, --count)
      done -= static_cast<ssize_t>(parts->iov_len);
    if (count == 0) return;
    parts->iov_base = static_cast<char*>(parts->iov_base) + done;
    parts->iov_len -= static_cast<std::size_t>(done);
  }
}

void say(Message kind, const void* bytes, std::size_t size) {
  MessageHead head{kind, 0, size};
  iovec parts[2] = {{&head, sizeof head}, {const_cast<void*>(bytes), size}};
  write_all(parts, size > 0 ? 2 : 1);
}
void say(Message kind, std::string_view text) { say(kind, text.data(), text.size()); }

struct Heard {
  Message kind;
  std::string bytes;
  int file = -1;  // descriptor of the file that came with the message; -1: none
};

void read_all(void* to, std::size_t size) {
  auto* out = static_cast<char*>(to);
  while (size > 0) {
    const ssize_t got = ::read(kOrders, out, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) leave();
    out += got;
    size -= static_cast<std::size_t>(got);
  }
}

Heard hear() {
  MessageHead head{};
  iovec part{&head, sizeof head};
  alignas(cmsghdr) char room[CMSG_SPACE(sizeof(int))]{};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = room;
  message.msg_controllen = sizeof room;
  const ssize_t got = ::recvmsg(kOrders, &message, MSG_CMSG_CLOEXEC);
  if (got <= 0) leave();
  Heard heard;
  if (const cmsghdr* control = CMSG_FIRSTHDR(&message); control && control->cmsg_type == SCM_RIGHTS)
    std::memcpy(&heard.file, CMSG_DATA(control), sizeof heard.file);
  read_all(reinterpret_cast<char*>(&head) + got, sizeof head - static_cast<std::size_t>(got));
  heard.kind = head.kind;
  heard.bytes.resize(head.size);
  read_all(heard.bytes.data(), head.size);
  return heard;
}

// The files of a volume when they are read inside the sandbox. The sandbox forbids opening files, so this class asks
// the program to open each file.
class AskedFiles final : public VolumeFiles {
 public:
  AskedFiles(VolumeLocation location, const Sandbox& sandbox) : VolumeFiles(std::move(location)), sandbox_(sandbox) {}

  PlainFile open_header(std::size_t index) override {
    const std::uint64_t number = index;
    return file_of(ask(Message::OpenHeader, {reinterpret_cast<const char*>(&number), sizeof number}));
  }
  PlainFile open_data(const std::string& name) override { return file_of(ask(Message::OpenData, name)); }
  void check_data(const std::vector<std::string>& names) override {
    if (!names.empty()) ask(Message::CheckData, bytes_of(names));
  }
  bool has_data(const std::string& name) override { return ask(Message::HasData, name).bytes == "1"; }
  void expect_memory(std::size_t bytes) override { allow_memory(sandbox_, kBookkeeping + bytes); }

 private:
  static Heard ask(Message question, std::string_view bytes) {
    say(question, bytes);
    Heard heard = hear();
    if (heard.kind == Message::Refused) throw std::runtime_error(heard.bytes);
    return heard;
  }
  static PlainFile file_of(const Heard& heard) {
    std::int64_t size = 0;
    if (heard.file < 0 || heard.bytes.size() != sizeof size) leave();
    std::memcpy(&size, heard.bytes.data(), sizeof size);
    return {heard.file, size};
  }

  static constexpr std::size_t kBookkeeping = 64
                                              << 20;  // memory for the names and positions of the largest series, bytes
  Sandbox sandbox_;
};

void deliver(OpenedVolume opened) {
  say(Message::Header, bytes_of(opened.header));
  if (!opened.voxels) return say(Message::End, bytes_of(std::vector<std::string>{}));
  std::vector<char> chunk(kChunk);
  const std::int64_t bytes = opened.header.grid.voxel_count() * size_of(opened.header.voxel_type);
  for (std::int64_t done = 0; done < bytes;) {
    const auto some = static_cast<std::size_t>(std::min<std::int64_t>(kChunk, bytes - done));
    opened.voxels->read(chunk.data(), some);
    say(Message::Voxels, chunk.data(), some);
    done += static_cast<std::int64_t>(some);
  }
  say(Message::End, bytes_of(opened.voxels->finish()));
}

// Makes the system kill this process when the program ends, and closes all inherited files except the standard streams.
void leave_all_behind(pid_t program) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != program) leave();
  ::closefrom(STDERR_FILENO + 1);
}

}  // namespace

int serve_volume(int argc, char** argv, const OpenFromFiles& open) {
  if (argc < 3) return 2;
  leave_all_behind(static_cast<pid_t>(std::atol(argv[1])));
  SandboxSettings settings;
  settings.memory_bytes = settings.most_memory = std::strtoull(argv[2], nullptr, 10);
  if (argc > 3) {
    settings.most_memory = std::numeric_limits<std::size_t>::max();
    load_dicom_library();
  }
  const Sandbox sandbox = enter_sandbox(settings);
  say(Message::Hello, bytes_of(sandbox.protection));
  try {
    Order order = order_from(hear().bytes, leave);
    deliver(open(std::make_shared<AskedFiles>(std::move(order.location), sandbox), order.holding));
  } catch (const std::bad_alloc&) {
    say(Message::OutOfMemory, {});
  } catch (const std::exception& error) {
    say(Message::Failed, error.what());
  }
  ::_exit(0);
}

}  // namespace limber
