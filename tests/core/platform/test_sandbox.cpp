// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/sandbox.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <doctest/doctest.h>

#include "core/platform/child_process.h"
#include "tests/support/sanitizer.h"

using namespace limber;

namespace {

struct Seen {
  Protection protection;
  int open_error = 0, connect_error = 0;
  bool reads_open_file = false, after_raise = false, before_raise = false;
};

int error_of_connect() {
  const int end = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in nobody{};
  nobody.sin_family = AF_INET;
  nobody.sin_port = htons(9);
  nobody.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return end >= 0 && ::connect(end, reinterpret_cast<const sockaddr*>(&nobody), sizeof nobody) == 0 ? 0 : errno;
}

bool can_take(std::size_t bytes) {
#ifdef LIMBER_ADDRESS_SANITIZER
  if (bytes > 0) return true;  // AddressSanitizer ends the program where malloc would return null
#endif
  void* const volatile memory = std::malloc(bytes);  // volatile, or the compiler removes the allocation
  const bool taken = memory != nullptr;
  std::free(memory);
  return taken;
}

// Enters a sandbox in a child process, and returns what the child could do in it.
Seen seen_inside(const SandboxSettings& settings) {
  const auto sent = run_in_child(
      [&](const Send& send) {
        const int open_before = ::open("/proc/self/exe", O_RDONLY | O_CLOEXEC);
        const Sandbox sandbox = enter_sandbox(settings);
        Seen seen{.protection = sandbox.protection};
        seen.open_error = ::open("/etc/passwd", O_RDONLY | O_CLOEXEC) < 0 ? errno : 0;
        seen.connect_error = error_of_connect();
        char byte = 0;
        seen.reads_open_file = ::pread(open_before, &byte, 1, 0) == 1;
        allow_memory(sandbox, 32 << 20);
        seen.before_raise = can_take(128 << 20);
        allow_memory(sandbox, 512 << 20);
        seen.after_raise = can_take(128 << 20);
        send(&seen, sizeof seen);
        return true;
      },
      sizeof(Seen));
  REQUIRE(sent);
  Seen seen;
  std::memcpy(static_cast<void*>(&seen), sent->data(), sizeof seen);
  return seen;
}

}  // namespace

TEST_CASE("sandbox: each wall refuses files and the network alone, and what is open stays open") {
  const Seen both = seen_inside({});
  const Seen files = seen_inside({.system_calls = false}), calls = seen_inside({.files = false});
  CHECK(both.protection.own_process);
  for (const Seen& seen : {both, files, calls}) CHECK(seen.reads_open_file);
  if (calls.protection.system_calls) {
    CHECK(calls.open_error == EPERM);
    CHECK(calls.connect_error == EPERM);
    CHECK(both.connect_error == EPERM);
  } else {
    MESSAGE("SKIPPED: this kernel filters no system calls");
  }
  if (files.protection.landlock > 0) CHECK(files.open_error == EACCES);
  else MESSAGE("SKIPPED: this kernel has no Landlock");
  constexpr int kWithNetwork = 4;
  if (files.protection.landlock >= kWithNetwork) CHECK(files.connect_error == EACCES);
  CHECK(calls.protection.landlock == 0);
  CHECK_FALSE(files.protection.system_calls);
}

#ifndef LIMBER_ADDRESS_SANITIZER
TEST_CASE("sandbox: memory is limited, the limit can be raised as far as was said and no further") {
  const Seen raised = seen_inside({.memory_bytes = 32 << 20, .most_memory = 512 << 20});
  CHECK_FALSE(raised.before_raise);
  CHECK(raised.after_raise);
  const Seen kept = seen_inside({.memory_bytes = 32 << 20, .most_memory = 64 << 20});
  CHECK_FALSE(kept.before_raise);
  CHECK_FALSE(kept.after_raise);
}
#endif
