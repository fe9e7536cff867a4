// SPDX-License-Identifier: AGPL-3.0-or-later
// Takes rights away from this process before it parses a file from a stranger. Four protections work independently: if
// one has a gap, or the kernel lacks it, the others still work.
//   system calls  seccomp allows calls that compute, allocate memory and use open files. It refuses every other one
//                 with EPERM: open, socket, fork, exec, ptrace and executable memory.
//   files         Landlock refuses every path, TCP, and signals and sockets to other processes.
//   resources     limits on memory, processor time, file size, open files and new processes. They always apply.
//   privileges    no new ones through set-user-ID programs, no core dump, no other process can read its memory.
// Linux only: seccomp since 3.5 (x86-64 and AArch64), Landlock since 5.13.
#pragma once

#include <cstddef>

namespace limber {

struct SandboxSettings {
  // Memory that the process may map in addition to what it has mapped on entry, bytes; see allow_memory().
  std::size_t memory_bytes = std::size_t{256} << 20;
  // The largest value, bytes, to which allow_memory() can raise the limit memory_bytes.
  std::size_t most_memory = std::size_t{256} << 20;
  double processor_seconds = 600;
  // False switches the protection by seccomp (system_calls) or by Landlock (files) off, to test the other protections
  // alone.
  bool system_calls = true, files = true;
};

// The protections that are in force for a process.
struct Protection {
  bool own_process = false;   // the work runs in a process of its own
  bool system_calls = false;  // seccomp, the kernel's system call filter
  int landlock = 0;           // version of the kernel's Landlock interface that is in force; 0: not in force

  bool operator==(const Protection&) const = default;
};

struct Sandbox {
  Protection protection;
  // Size of the address space on entry, bytes. It is stored because the file that tells it cannot be opened later.
  std::size_t mapped_bytes = 0;
};

// Puts this process into the sandbox permanently; the process must have only one thread. Files that are open stay open.
// Never fails: the result tells which protections are in force.
Sandbox enter_sandbox(const SandboxSettings& settings);

// Sets the limit of the process's address space: `bytes` more than the process had mapped when it entered the sandbox,
// at most SandboxSettings::most_memory.
void allow_memory(const Sandbox& sandbox, std::size_t bytes);

}  // namespace limber
