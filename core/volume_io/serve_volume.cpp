// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/serve_volume.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>
#include <utility>

#include "core/base/error.h"
#include "core/platform/pipe.h"
#include "core/platform/process.h"
#include "core/volume_io/dicom.h"
#include "core/volume_io/reader_messages.h"
#include "core/volume_io/sparse_bytes.h"

namespace limber {

namespace {

constexpr std::size_t kChunk = 1 << 18;  // bytes of voxels in one message; small enough to stay in a processor cache

// Ends this process. It is called when the channel to the program is closed, since nobody then reads an answer.
[[noreturn]] void leave() { std::_Exit(1); }

void say(Message kind, std::string_view bytes) {
  const MessageHead head{kind, 0, bytes.size()};
  if (!write_to_parent({reinterpret_cast<const char*>(&head), sizeof head}, bytes)) leave();
}

struct Heard {
  Message kind;
  std::string bytes;
  OpenFile file;  // the file that came with the message, if any
};

Heard hear() {
  MessageHead head{};
  Heard heard;
  if (!read_from_parent(&head, sizeof head, &heard.file)) leave();
  heard.kind = head.kind;
  heard.bytes.resize(head.size);
  if (!read_from_parent(heard.bytes.data(), head.size, nullptr)) leave();
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
  static PlainFile file_of(Heard heard) {
    std::int64_t size = 0;
    if (!heard.file.is_open() || heard.bytes.size() != sizeof size) leave();
    std::memcpy(&size, heard.bytes.data(), sizeof size);
    return {std::move(heard.file), size};
  }

  // Memory for the names and positions of the slices of the largest DICOM series, bytes.
  static constexpr std::size_t kBookkeeping = 64 << 20;
  Sandbox sandbox_;
};

void deliver(OpenedVolume opened) {
  say(Message::Header, bytes_of(opened.header));
  if (!opened.voxels) return say(Message::End, bytes_of(std::vector<std::string>{}));
  std::vector<char> chunk(kChunk);
  std::string message;
  const std::int64_t bytes = opened.header.grid.voxel_count() * size_of(opened.header.voxel_type);
  for (std::int64_t done = 0; done < bytes;) {
    if (const std::optional<FileBytes> plain = opened.voxels->pass_plain()) {
      say(Message::PlainVoxels, {reinterpret_cast<const char*>(&*plain), sizeof *plain});
      done += plain->bytes;
      continue;
    }
    const std::uint64_t some = std::min<std::int64_t>(kChunk, bytes - done);
    opened.voxels->read(chunk.data(), some);
    message.assign(reinterpret_cast<const char*>(&some), sizeof some);
    pack_sparsely({chunk.data(), some}, message);
    say(Message::Voxels, message);
    done += static_cast<std::int64_t>(some);
  }
  say(Message::End, bytes_of(opened.voxels->finish()));
}

// Makes the system kill this process when the program ends, and closes all inherited files except the standard streams.
void leave_all_behind(std::int64_t program) {
  if (!end_with_parent(program)) leave();
  close_inherited_files();
}

}  // namespace

int serve_volume(int argc, char** argv, const OpenFromFiles& open) {
  if (argc < 3) return 2;
  leave_all_behind(std::atol(argv[1]));
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
  std::_Exit(0);
}

}  // namespace limber
