// SPDX-License-Identifier: AGPL-3.0-or-later
// A stand-in for the program limber_reader, as it would act if a file had taken it over. Until the file is parsed it
// does what limber_reader does. Then it misbehaves in the way that the file names after "misbehave:".
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <stdexcept>

#include <fcntl.h>
#include <netinet/in.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/volume_io/reader_messages.h"
#include "core/volume_io/serve_volume.h"

using namespace limber;

namespace {

std::string misbehaviour(VolumeFiles& files) {
  const PlainFile file = files.open_header(0);
  std::string bytes(4096, '\0');
  bytes.resize(file.read_at(0, bytes.data(), bytes.size()));
  const std::size_t at = bytes.find("misbehave:");
  return at == std::string::npos ? "" : bytes.substr(at + 10, bytes.find('\n', at) - at - 10);
}

// Tries calls that need rights outside the sandbox, and throws an error that lists the calls that succeeded.
[[noreturn]] void use_rights(const Path& folder) {
  std::string could;
  const auto note = [&](const char* what, long result) {
    if (result >= 0) could += std::string(" ") + what;
  };
  note("open", ::open("/etc/passwd", O_RDONLY));
  note("make", ::open((folder / "made").c_str(), O_CREAT | O_WRONLY, 0600));
  note("remove", ::unlink((folder / "victim").c_str()));
  note("socket", ::socket(AF_INET, SOCK_STREAM, 0));
  note("local-socket", ::socket(AF_UNIX, SOCK_STREAM, 0));
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  note("fork", child);
  note("ptrace", ::ptrace(PTRACE_ATTACH, ::getppid(), nullptr, nullptr));
  note("kill", ::kill(::getppid(), 0));
  void* code = ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  note("code", code == MAP_FAILED ? -1 : 0);
  char* const words[] = {const_cast<char*>("true"), nullptr};
  note("exec", ::execv("/bin/true", words));
  throw std::runtime_error("it could: rights:" + could + " end");
}

[[noreturn]] void take_memory() {
  std::vector<std::string> taken;
  for (;;) taken.emplace_back(1 << 20, 'x');
}

void say(Message kind, std::uint64_t size) {
  const MessageHead head{kind, 0, size};
  if (::write(STDOUT_FILENO, &head, sizeof head) < 0) ::_exit(1);
}

// A volume that ends before the voxels that its header promises.
class EarlyEnd final : public VoxelSource {
 public:
  void read(void*, std::size_t) override {
    say(Message::End, 0);
    ::_exit(0);
  }
  std::vector<std::string> finish() override { return {}; }
};

// Claims that the volume's voxels are stored uncompressed at the given bytes of the file.
class PlainLie final : public VoxelSource {
 public:
  explicit PlainLie(const FileBytes& bytes) : bytes_(bytes) {}
  void read(void*, std::size_t) override {}
  std::optional<FileBytes> pass_plain() override { return bytes_; }
  std::vector<std::string> finish() override { return {}; }

 private:
  FileBytes bytes_;
};

// Sends the given bytes as the content of the message with the voxels.
class SparseLie final : public VoxelSource {
 public:
  explicit SparseLie(std::string message) : message_(std::move(message)) {}
  void read(void*, std::size_t) override {
    say(Message::Voxels, message_.size());
    if (::write(STDOUT_FILENO, message_.data(), message_.size()) < 0) ::_exit(1);
    const std::string no_warnings = bytes_of(std::vector<std::string>{});
    say(Message::End, no_warnings.size());
    if (::write(STDOUT_FILENO, no_warnings.data(), no_warnings.size()) < 0) ::_exit(1);
    ::_exit(0);
  }
  std::vector<std::string> finish() override { return {}; }

 private:
  std::string message_;
};

// Returns the content of a message with voxels. It announces `count` voxels in one span of `zeros` zero bytes and
// `others` other bytes; the bytes of `more` follow.
std::string sparse_message(std::uint64_t count, std::uint32_t zeros, std::uint32_t others, const std::string& more) {
  ByteWriter message;
  message.put(count);
  message.put(zeros);
  message.put(others);
  return message.take() + more;
}

class Crash final : public VoxelSource {
 public:
  void read(void*, std::size_t) override { ::raise(SIGBUS); }
  std::vector<std::string> finish() override { return {}; }
};

OpenedVolume misbehave(std::shared_ptr<VolumeFiles> files, Holding holding) {
  const std::string what = misbehaviour(*files);
  if (what == "crash") ::raise(SIGSEGV);
  if (what == "abort") std::abort();
  if (what == "leave") ::_exit(7);
  if (what == "spin")
    for (volatile bool forever = true; forever;) {
    }
  if (what == "silence")
    for (char byte;;) (void)!::read(STDIN_FILENO, &byte, 1);
  if (what == "memory") take_memory();
  if (what == "rights") use_rights(files->location().folder());
  if (what == "long message") say(Message::Header, std::numeric_limits<std::uint64_t>::max());
  if (what == "unknown message") say(static_cast<Message>(77), 0);
  if (what == "no header") say(Message::Voxels, 8);
  if (what == "wrong index") files->open_header(1);
  if (what == "other file") files->open_data("../other.raw");

  OpenedVolume opened = open_volume_here(files, holding);
  Grid& grid = opened.header.grid;
  if (what == "huge grid") grid.size = glm::ivec3(std::numeric_limits<int>::max());
  if (what == "negative grid") grid.size.y = -1;
  if (what == "no spacing") grid.spacing.x = std::numeric_limits<double>::quiet_NaN();
  if (what == "unknown type") opened.header.voxel_type = static_cast<VoxelType>(200);
  if (what == "unknown kind") opened.header.named.tissues.push_back({.kind = static_cast<TissueKind>(99)});
  if (what == "early end") opened.voxels = std::make_unique<EarlyEnd>();
  if (what == "late crash") opened.voxels = std::make_unique<Crash>();
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  const std::map<std::string, FileBytes> lies{
      {"plain beyond", {1 << 20, 8}}, {"plain overflow", {kMost - 4, 8}},
      {"plain before", {-8, 8}},      {"plain long", {0, kMost}},
      {"plain negative", {0, -8}},    {"plain most negative", {0, std::numeric_limits<std::int64_t>::min()}}};
  if (const auto lie = lies.find(what); lie != lies.end()) opened.voxels = std::make_unique<PlainLie>(lie->second);
  const std::map<std::string, std::string> sparse{{"sparse right", sparse_message(8, 3, 5, "12345")},
                                                  {"sparse short", "1234"},
                                                  {"sparse none", std::string(8, '\0')},
                                                  {"sparse few", sparse_message(8, 7, 0, "")},
                                                  {"sparse beyond", sparse_message(8, 0, 0xffffffff, "12345678")},
                                                  {"sparse long", sparse_message(8, 8, 1, "1")},
                                                  {"sparse after", sparse_message(8, 8, 0, "12345678")},
                                                  {"sparse promise", sparse_message(std::uint64_t{1} << 60, 9, 0, "")}};
  if (const auto lie = sparse.find(what); lie != sparse.end()) opened.voxels = std::make_unique<SparseLie>(lie->second);
  return opened;
}

}  // namespace

int main(int argc, char** argv) { return serve_volume(argc, argv, misbehave); }
