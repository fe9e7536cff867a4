// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/volume_reader.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.h"
#include "core/base/module.h"
#include "core/base/spawn.h"
#include "core/volume_io/reader_messages.h"

namespace limber {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kAskMilliseconds = 20;  // milliseconds between two checks whether the user has cancelled
constexpr int kPipeBytes = 1 << 20;   // requested pipe buffer, bytes: the largest that the kernel usually grants
constexpr std::uint64_t kLongestMessage = 64 << 20;  // bytes; enough for a header with all its keys
constexpr int kNotLoaded = 127;                      // exit code of a process that lacks a shared library
constexpr const char* kHarmful = "it is damaged, or made to do harm; export or download it again";

class Descriptor {
 public:
  explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
  Descriptor(Descriptor&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  ~Descriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

Error no_reader(const Path& program) {
  return {"the reader of volumes cannot be started", program.string(), std::strerror(errno)};
}

// Converts the text of an Error, "what: where: what to do", back to an Error.
Error error_from(const std::string& text, const std::string& where) {
  const std::size_t first = text.find(": "), last = text.rfind(": ");
  if (first == std::string::npos || first == last) return {text, where, kHarmful};
  return {text.substr(0, first), text.substr(first + 2, last - first - 2), text.substr(last + 2)};
}

// The two ends of a channel between this program and the reader process: `ours` is this program's end and never blocks,
// `its` is the reader's end.
struct Ends {
  Descriptor ours, its;
};

// Creates the channel for messages to the reader. The channel is a socket, because descriptors of open files are sent
// with the messages.
Ends make_orders(const Path& program) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) throw no_reader(program);
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

Ends make_answers(const Path& program) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw no_reader(program);
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  ::fcntl(ends[0], F_SETPIPE_SZ, kPipeBytes);
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

// Owns the reader's process and the program's ends of its channels. The destructor kills the process.
class ReaderProcess {
 public:
  ReaderProcess(const VolumeLocation& location, const ReaderSettings& settings)
      : ReaderProcess(make_orders(settings.program), make_answers(settings.program), location, settings) {}
  ~ReaderProcess() { end(); }
  ReaderProcess(const ReaderProcess&) = delete;
  ReaderProcess& operator=(const ReaderProcess&) = delete;

  int orders() const { return orders_.get(); }
  int answers() const { return answers_.get(); }

  // Returns the processor time that the reader's process has used, seconds; 0 when the process has ended.
  double processor_seconds() const {
    clockid_t clock;
    timespec time{};
    if (::clock_getcpuclockid(id_, &clock) != 0 || ::clock_gettime(clock, &time) != 0) return 0;
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  // Returns the exit status of the reader's process. A reader that has closed its pipe should end soon, so this
  // function waits up to 0.1 s. Returns nothing when the process still runs.
  std::optional<int> ended_status() {
    constexpr int kMoments = 100;  // upper limit on the number of waits, each of one millisecond
    for (int i = 0; id_ > 0 && i < kMoments; ++i) {
      int status = 0;
      if (::waitpid(id_, &status, WNOHANG) == id_) {
        id_ = -1;
        return status;
      }
      ::usleep(1000);
    }
    return std::nullopt;
  }

 private:
  ReaderProcess(Ends orders, Ends answers, const VolumeLocation& location, const ReaderSettings& settings)
      : orders_(std::move(orders.ours)),
        answers_(std::move(answers.ours)) {
    std::vector<std::string> words{kReaderName, std::to_string(::getpid()), std::to_string(settings.memory_bytes)};
    if (location.is_dicom) words.push_back("dicom");
    const Streams streams{.in = orders.its.get(), .out = answers.its.get()};
    id_ = spawn(settings.program, std::move(words), streams, Environment::Empty, "the reader of volumes");
  }
  void end() {
    if (id_ <= 0) return;
    ::kill(-id_, SIGKILL);  // a negative ID means the whole process group
    while (::waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
    }
    id_ = -1;
  }

  Descriptor orders_, answers_;
  pid_t id_ = -1;
};

// Transfers bytes between the program and its reader. While it waits for the reader, it checks whether the user has
// cancelled and whether the reader makes progress.
class Conversation {
 public:
  Conversation(const VolumeLocation& location, const ReaderSettings& settings, Progress& progress)
      : settings_(settings),
        progress_(progress),
        process_(location, settings),
        parsed_(location.path.string()) {}

  void read(void* to, std::size_t size) {
    auto* out = static_cast<char*>(to);
    while (size > 0) {
      const ssize_t got = ::read(process_.answers(), out, size);
      if (got > 0) {
        out += got;
        size -= static_cast<std::size_t>(got);
        delivered_ = true;
      } else if (got == 0) {
        throw death();
      } else {
        wait(process_.answers(), POLLIN);
      }
    }
  }

  // Sends a message to the reader. `file` is the descriptor of an open file to send with it; -1: none.
  void write(Message kind, std::string_view bytes, int file = -1) {
    const MessageHead head{kind, 0, bytes.size()};
    std::string all(reinterpret_cast<const char*>(&head), sizeof head);
    all += bytes;
    for (std::size_t done = 0; done < all.size();) {
      const ssize_t sent = send_some(all.data() + done, all.size() - done, done == 0 ? file : -1);
      if (sent > 0) done += static_cast<std::size_t>(sent);
      else if (errno == EPIPE || errno == ECONNRESET) throw death();
      else wait(process_.orders(), POLLOUT);
    }
  }

  MessageHead read_head() {
    MessageHead head{};
    read(&head, sizeof head);
    return head;
  }
  std::string read_bytes(const MessageHead& head) {
    require(head.size <= kLongestMessage);
    constexpr std::size_t kStep = 1 << 20;  // bytes; memory for a message grows in such steps, only as bytes arrive
    std::string bytes;
    while (bytes.size() < head.size) {
      const std::size_t before = bytes.size(), more = std::min<std::size_t>(kStep, head.size - before);
      bytes.resize(before + more);
      read(bytes.data() + before, more);
    }
    return bytes;
  }

  // Remembers the name of the file that the reader is parsing, for error messages.
  void parses(const std::string& file) { parsed_ = file; }
  const std::string& parsed() const { return parsed_; }

  void require(bool holds) const {
    if (!holds) throw nonsense();
  }
  Error out_of_memory() const {
    return {"the file made its reader take more memory than such a file may", parsed_, kHarmful};
  }

 private:
  ssize_t send_some(const char* bytes, std::size_t size, int file) const {
    iovec part{const_cast<char*>(bytes), size};
    alignas(cmsghdr) char room[CMSG_SPACE(sizeof(int))]{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    if (file >= 0) {
      message.msg_control = room;
      message.msg_controllen = sizeof room;
      cmsghdr* control = CMSG_FIRSTHDR(&message);
      control->cmsg_level = SOL_SOCKET;
      control->cmsg_type = SCM_RIGHTS;
      control->cmsg_len = CMSG_LEN(sizeof(int));
      std::memcpy(CMSG_DATA(control), &file, sizeof file);
    }
    return ::sendmsg(process_.orders(), &message, MSG_NOSIGNAL);
  }

  void wait(int descriptor, short event) {
    if (progress_.cancelled()) throw Cancelled();
    pollfd ready{descriptor, event, 0};
    if (::poll(&ready, 1, kAskMilliseconds) == 0) watch();
  }

  // Throws Error when the reader has sent nothing during `busy_seconds` of its processor time or `silent_seconds` of
  // elapsed time. It is called when nothing has arrived for kAskMilliseconds.
  void watch() {
    const double processor = process_.processor_seconds();
    const auto now = Clock::now();
    if (std::exchange(delivered_, false)) {
      sign_ = now;
      busy_at_sign_ = processor;
    }
    const auto seconds = [](double value) { return std::to_string(static_cast<long>(value)) + " s"; };
    if (processor - busy_at_sign_ > settings_.busy_seconds)
      throw Error("the file kept its reader busy for " + seconds(settings_.busy_seconds) + " and nothing came of it",
                  parsed_, kHarmful);
    if (std::chrono::duration<double>(now - sign_).count() > settings_.silent_seconds)
      throw Error("the file's reader has said nothing for " + seconds(settings_.silent_seconds), parsed_,
                  "check the disk; if that is sound, export or download the file again");
  }

  Error nonsense() const { return {"the file made its reader answer nonsense", parsed_, kHarmful}; }

  // Returns the Error for a reader that closed its pipe before it had sent everything.
  Error death() {
    const std::optional<int> ended = process_.ended_status();
    if (!ended) return nonsense();
    const int status = *ended, signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    if (signal == SIGKILL)
      return {"the file's reader was ended by the system, most likely for lack of memory", parsed_,
              "close other programs and try again"};
    if (signal == 0 && WEXITSTATUS(status) == kNotLoaded)
      return {"the reader of volumes cannot be started", settings_.program.string(),
              "a library that it needs is missing; install Limber again"};
    if (signal == SIGXCPU) return {"the file made its reader take too much processor time", parsed_, kHarmful};
    if (signal != 0)
      return {"the file made its reader crash (" + std::string(::strsignal(signal)) + ")", parsed_, kHarmful};
    return {"the file made its reader give up (exit code " + std::to_string(WEXITSTATUS(status)) + ")", parsed_,
            kHarmful};
  }

  const ReaderSettings& settings_;
  Progress& progress_;
  ReaderProcess process_;
  std::string parsed_;
  bool delivered_ = true;
  Clock::time_point sign_ = Clock::now();
  double busy_at_sign_ = 0;
};

// A source of voxels that a reader process decodes. While it waits for voxels, it answers the reader's questions.
class ReaderVoxels final : public VoxelSource {
 public:
  ReaderVoxels(const VolumeLocation& location, Holding holding, Progress& progress, const ReaderSettings& settings)
      : settings_(settings),
        files_(location),
        talk_(location, settings_, progress) {
    talk_.write(Message::Order, bytes_of(Order{location, holding}));
  }

  Protection protection() { return protection_from(await(Message::Hello), damaged()); }
  VolumeHeader header() {
    VolumeHeader header = header_from(await(Message::Header), talk_.parsed(), damaged());
    promised_ = header.grid.voxel_count() * size_of(header.voxel_type);
    return header;
  }

  void read(void* to, std::size_t bytes) override {
    auto* out = static_cast<char*>(to);
    while (bytes > 0) {
      if (left_ == 0) next_voxels();
      const std::size_t now = std::min(bytes, left_);
      talk_.read(out, now);
      out += now;
      bytes -= now;
      left_ -= now;
    }
  }

  std::vector<std::string> finish() override {
    talk_.require(left_ == 0 && promised_ == 0);
    return texts_from(await(Message::End), damaged());
  }

 private:
  std::function<void()> damaged() {
    return [this] { talk_.require(false); };
  }

  void next_voxels() {
    const MessageHead head = next_of(Message::Voxels);
    talk_.require(head.size > 0 && head.size <= static_cast<std::uint64_t>(promised_));
    left_ = static_cast<std::size_t>(head.size);
    promised_ -= static_cast<std::int64_t>(head.size);
  }

  std::string await(Message kind) { return talk_.read_bytes(next_of(kind)); }

  // Waits for a message of kind `kind` and returns its head. Answers the reader's questions until then. Throws Error
  // for any other message.
  MessageHead next_of(Message kind) {
    for (;;) {
      const MessageHead head = talk_.read_head();
      if (head.kind == kind) return head;
      const std::string bytes = talk_.read_bytes(head);
      if (head.kind == Message::Failed) throw error_from(bytes, talk_.parsed());
      if (head.kind == Message::OutOfMemory) throw talk_.out_of_memory();
      answer(head.kind, bytes);
    }
  }

  // Answers one question of the reader. An Error about a file is sent to the reader as the answer. Throws Error for a
  // message that is not a valid question.
  void answer(Message question, const std::string& bytes) {
    const bool header = question == Message::OpenHeader, data = question == Message::OpenData;
    if (question == Message::HasData) return talk_.write(Message::Present, files_.has_data(bytes) ? "1" : "0");
    talk_.require(header || data || question == Message::CheckData);
    const std::size_t index = header ? index_from(bytes) : 0;
    const auto names = header || data ? std::vector<std::string>{} : texts_from(bytes, damaged());
    std::optional<PlainFile> file;
    try {
      if (header) file.emplace(files_.open_header(index));
      else if (data) file.emplace(files_.open_data(bytes));
      else files_.check_data(names);
    } catch (const Error& error) {
      return talk_.write(Message::Refused, error.what());
    }
    if (!file) return talk_.write(Message::Done, {});
    const VolumeLocation& location = files_.location();
    talk_.parses((header ? location.headers[index] : location.folder() / bytes).string());
    send(*file);
  }
  std::size_t index_from(const std::string& bytes) {
    std::uint64_t index = 0;
    talk_.require(bytes.size() == sizeof index);
    std::memcpy(&index, bytes.data(), sizeof index);
    talk_.require(index < files_.location().headers.size());
    return index;
  }
  void send(const PlainFile& file) {
    ByteWriter size;
    size.put(file.size());
    talk_.write(Message::Opened, size.take(), file.descriptor());
  }

  const ReaderSettings settings_;
  LocalFiles files_;
  Conversation talk_;
  std::int64_t promised_ = 0;  // voxel bytes that the header promised and no Voxels message has announced yet
  std::size_t left_ = 0;       // bytes not yet read of the current Voxels message
};

}  // namespace

OpenedVolume open_in_reader(const VolumeLocation& location, Holding holding, Progress& progress,
                            const ReaderSettings& settings) {
  if (progress.cancelled()) throw Cancelled();
  auto voxels = std::make_unique<ReaderVoxels>(location, holding, progress, settings);
  voxels->protection();
  VolumeHeader header = voxels->header();
  if (holding == Holding::Header) voxels.reset();
  return {std::move(header), std::move(voxels)};
}

Protection reader_protection() {
  const auto program = find_own_program(kReaderName);
  if (!program) return {};
  const VolumeLocation nothing{{}, false, {Path()}};
  return ReaderVoxels(nothing, Holding::Header, no_progress(), {.program = *program}).protection();
}

}  // namespace limber
