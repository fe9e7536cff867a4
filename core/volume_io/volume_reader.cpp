// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/volume_reader.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <optional>
#include <thread>
#include <utility>

#include "core/base/error.h"
#include "core/platform/child_program.h"
#include "core/platform/module.h"
#include "core/platform/pipe.h"
#include "core/platform/process.h"
#include "core/volume_io/reader_messages.h"
#include "core/volume_io/sparse_bytes.h"

namespace limber {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kAskMilliseconds = 20;  // milliseconds between two checks whether the user has cancelled
// Requested size of the pipe's buffer, bytes: the largest that the kernel usually grants.
constexpr int kPipeBytes = 1 << 20;
// Limit on the length of a message, bytes; it is enough for a header with all its keys.
constexpr std::uint64_t kLongestMessage = 64 << 20;
constexpr int kNotLoaded = 127;  // exit code of a process that lacks a shared library
constexpr const char* kHarmful = "it is damaged or malicious; export or download it again";

// Converts the text of an Error, "what: where: what to do", back to an Error.
Error error_from(const std::string& text, const std::string& where) {
  const std::size_t first = text.find(": "), last = text.rfind(": ");
  if (first == std::string::npos || first == last) return {text, where, kHarmful};
  return {text.substr(0, first), text.substr(first + 2, last - first - 2), text.substr(last + 2)};
}

// Throws Error if `error` says that a part of the reader's process could not be made.
void require_reader(const std::error_code& error, const Path& program) {
  if (error) throw Error("the reader of volumes cannot be started", program.string(), error.message());
}

// Owns the reader's process and the program's ends of its channels. The destructor kills the process.
class ReaderProcess {
 public:
  ReaderProcess(const VolumeLocation& location, const ReaderSettings& settings) {
    std::error_code error;
    FileChannel orders = make_file_channel(error);
    require_reader(error, settings.program);
    Pipe answers = make_pipe(error, kPipeBytes);
    require_reader(error, settings.program);
    std::vector<std::string> words{kReaderName, std::to_string(process_id()), std::to_string(settings.memory_bytes)};
    if (location.is_dicom) words.push_back("dicom");
    const Streams streams{.in = &orders.its, .out = &answers.write_end};
    process_.emplace(settings.program, std::move(words), streams, Environment::Empty, error);
    require_reader(error, settings.program);
    orders_ = std::move(orders.ours);
    answers_ = std::move(answers.read_end);
  }
  ~ReaderProcess() {
    if (process_) process_->kill_and_wait();
  }
  ReaderProcess(const ReaderProcess&) = delete;
  ReaderProcess& operator=(const ReaderProcess&) = delete;

  const Handle& orders() const { return orders_; }
  const Handle& answers() const { return answers_; }

  // Returns the processor time that the reader's process has used, seconds; 0 when the process has ended.
  double processor_seconds() const { return process_->processor_seconds(); }

  // Returns how the reader's process ended. A reader that has closed its pipe should end soon, so this function waits
  // up to 0.1 s. Returns nothing when the process still runs.
  std::optional<ProgramEnd> end() {
    constexpr int kMoments = 100;  // upper limit on the number of waits, each of one millisecond
    for (int i = 0; i < kMoments; ++i) {
      if (process_->has_ended()) return process_->end();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return std::nullopt;
  }

 private:
  Handle orders_, answers_;
  std::optional<ChildProgram> process_;
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
      const std::ptrdiff_t got = read_some(process_.answers(), out, size);
      if (got > 0) {
        out += got;
        size -= static_cast<std::size_t>(got);
        delivered_ = true;
      } else if (got == 0) {
        throw death();
      } else {
        on_wait(wait_to_read({&process_.answers()}, kAskMilliseconds));
      }
    }
  }

  // Sends a message to the reader, and with it `file` unless it is nullptr.
  void write(Message kind, std::string_view bytes, const OpenFile* file = nullptr) {
    const MessageHead head{kind, 0, bytes.size()};
    std::string all(reinterpret_cast<const char*>(&head), sizeof head);
    all += bytes;
    for (std::size_t done = 0; done < all.size();) {
      const std::ptrdiff_t sent =
          send_some(process_.orders(), std::string_view(all).substr(done), done == 0 ? file : nullptr);
      if (sent > 0) done += static_cast<std::size_t>(sent);
      else if (sent == 0) throw death();
      else on_wait(wait_to_write(process_.orders(), kAskMilliseconds));
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

  void check_cancelled() const {
    if (progress_.cancelled()) throw Cancelled();
  }

  // Remembers the name of the file that the reader is parsing, for error messages.
  void parses(const std::string& file) { parsed_ = file; }
  const std::string& parsed() const { return parsed_; }

  void require(bool holds) const {
    if (!holds) throw nonsense();
  }
  Error out_of_memory() const { return {"the file's reader exceeded its memory limit", parsed_, kHarmful}; }

 private:
  // Throws Cancelled if the user has cancelled, and Error if the reader hangs (watch()). Call this after each wait for
  // the reader.
  //   arrived  false: nothing arrived during the wait
  void on_wait(bool arrived) {
    if (progress_.cancelled()) throw Cancelled();
    if (!arrived) watch();
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
      throw Error("the file's reader made no progress in " + seconds(settings_.busy_seconds) + " of computing", parsed_,
                  kHarmful);
    if (std::chrono::duration<double>(now - sign_).count() > settings_.silent_seconds)
      throw Error("the file's reader has not answered for " + seconds(settings_.silent_seconds), parsed_,
                  "check the disk; if the disk has no fault, export or download the file again");
  }

  Error nonsense() const { return {"the file's reader gave an invalid answer", parsed_, kHarmful}; }

  // Returns the Error for a reader that closed its pipe before it had sent everything.
  Error death() {
    const std::optional<ProgramEnd> end = process_.end();
    if (!end) return nonsense();
    if (end->was_killed())
      return {"the file's reader was ended by the system, most likely for lack of memory", parsed_,
              "close other programs and try again"};
    if (!end->by_signal() && end->exit_code == kNotLoaded)
      return {"the reader of volumes cannot be started", settings_.program.string(),
              "a library that it needs is missing; install Limber again"};
    if (end->took_too_much_time()) return {"the file's reader took too much processor time", parsed_, kHarmful};
    if (end->by_signal()) return {"the file's reader crashed (" + end->signal_text() + ")", parsed_, kHarmful};
    return {"the file's reader failed (exit code " + std::to_string(end->exit_code) + ")", parsed_, kHarmful};
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
      if (plain_at_) read_plain(out, now);
      else talk_.require(packed_.read(out, now));
      out += now;
      bytes -= now;
      left_ -= now;
    }
  }

  std::vector<std::string> finish() override {
    talk_.require(left_ == 0 && promised_ == 0 && packed_.is_done());
    return texts_from(await(Message::End), damaged());
  }

 private:
  std::function<void()> damaged() {
    return [this] { talk_.require(false); };
  }

  void next_voxels() {
    talk_.require(packed_.is_done());
    const MessageHead head = next_of(Message::Voxels, Message::PlainVoxels);
    std::string bytes = talk_.read_bytes(head);
    plain_at_.reset();
    std::int64_t count = 0;
    if (head.kind == Message::Voxels) {
      talk_.require(bytes.size() >= sizeof count);
      std::memcpy(&count, bytes.data(), sizeof count);
      packed_ = SparseBytes(std::move(bytes), sizeof count);
    } else {
      FileBytes plain;
      talk_.require(bytes.size() == sizeof plain && opened_);
      std::memcpy(&plain, bytes.data(), sizeof plain);
      talk_.require(plain.offset >= 0 && plain.bytes > 0 && plain.bytes <= opened_->size() &&
                    plain.offset <= opened_->size() - plain.bytes);
      count = plain.bytes;
      plain_at_ = plain.offset;
    }
    talk_.require(count > 0 && count <= promised_);
    left_ = static_cast<std::size_t>(count);
    promised_ -= count;
  }

  // Reads the next bytes from the opened file itself, a few megabytes at a time, so that the user can cancel.
  void read_plain(char* to, std::size_t bytes) {
    constexpr std::size_t kStep = 16 << 20;
    for (std::size_t done = 0; done < bytes;) {
      talk_.check_cancelled();
      const std::size_t now = std::min(kStep, bytes - done);
      if (opened_->read_at(*plain_at_, to + done, now) < now)
        throw Error("the file could not be read to its end", talk_.parsed(),
                    "check the disk, and whether another program writes the file");
      *plain_at_ += static_cast<std::int64_t>(now);
      done += now;
    }
  }

  std::string await(Message kind) { return talk_.read_bytes(next_of(kind)); }

  MessageHead next_of(Message kind) { return next_of(kind, kind); }
  // Waits for a message of kind `kind` or `other` and returns its head. Answers the reader's questions until then.
  // Throws Error for any other message.
  MessageHead next_of(Message kind, Message other) {
    for (;;) {
      const MessageHead head = talk_.read_head();
      if (head.kind == kind || head.kind == other) return head;
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
    opened_ = std::move(file);
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
    talk_.write(Message::Opened, size.take(), &file.file());
  }

  const ReaderSettings settings_;
  LocalFiles files_;
  Conversation talk_;
  std::int64_t promised_ = 0;        // voxel bytes that the header promised and no Voxels message has announced yet
  std::size_t left_ = 0;             // bytes not yet read of the current Voxels or PlainVoxels message
  SparseBytes packed_;               // the voxels of the current Voxels message
  std::optional<PlainFile> opened_;  // the file that was sent to the reader last
  std::optional<std::int64_t> plain_at_;  // after a PlainVoxels message: offset of the next byte in opened_
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
