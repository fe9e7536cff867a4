// SPDX-License-Identifier: AGPL-3.0-or-later
// Takes this process's rights away, for code that parses what a stranger made. Four walls stand behind each other; each
// holds where the one before has a hole, and where the kernel has no such wall the others stand alone:
//   system calls  seccomp allows those that compute, take memory, and use what is open already. It refuses every other
//                 one with EPERM: open, socket, fork, exec, ptrace, and memory that can be executed.
//   files         Landlock refuses every path, TCP, and signals and sockets to processes outside.
//   resources     limits on memory, processor time, file size, open files and new processes. They always stand.
//   privileges    no new ones through set-user-ID programs, no core dump, no other process reads its memory.
// Linux only: seccomp since 3.5 (x86-64 and AArch64), Landlock since 5.13.
#pragma once

#include <cstddef>

namespace limber {

struct SandboxSettings {
  std::size_t memory_bytes = std::size_t{256} << 20;  // beyond what is mapped at the call; raised by allow_memory()
  std::size_t most_memory = std::size_t{256} << 20;   // that allow_memory() can reach, likewise
  double processor_seconds = 600;
  bool system_calls = true, files = true;  // off only to test the other wall alone
};

// What stands.
struct Protection {
  bool own_process = false;   // apart from the program
  bool system_calls = false;  // seccomp
  int landlock = 0;           // the version of its interface in the kernel, 0: none

  bool operator==(const Protection&) const = default;
};

struct Sandbox {
  Protection protection;
  std::size_t mapped_bytes = 0;  // when it was entered: no file can be opened later to ask
};

// For a process with one thread, for good. Keeps the files that are open. Never fails: says what stands.
Sandbox enter_sandbox(const SandboxSettings& settings);

// Address space beyond what was mapped when the sandbox was entered, in bytes, as far as `most_memory` allows.
void allow_memory(const Sandbox& sandbox, std::size_t bytes);

}  // namespace limber
