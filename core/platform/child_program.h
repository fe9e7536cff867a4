// SPDX-License-Identifier: AGPL-3.0-or-later
// Starts another program, waits for its end, and ends it. This is safe while other threads run, because no code of this
// process runs in the new process before the program does.
#pragma once

#include <cstdint>
#include <string>
#include <system_error>
#include <vector>

#include "core/platform/open_file.h"

namespace limber {

// The new program's standard streams. nullptr: the input is empty, or the output is discarded.
struct Streams {
  const Handle *in = nullptr, *out = nullptr, *err = nullptr;
};
enum class Environment { Same, Empty };

// The way in which a program ended.
struct ProgramEnd {
  int exit_code = 0;
  int signal = 0;  // number of the signal that ended the program; 0: it ended by itself

  bool by_signal() const { return signal != 0; }
  bool was_killed() const;          // true if kill() ended it, or the system for lack of memory
  bool took_too_much_time() const;  // true if it exceeded its limit of processor time
  std::string signal_text() const;  // returns the signal's name, for example "Segmentation fault"
};

// A program that this process started. The program is the leader of its own process group. So Ctrl+C at the terminal
// does not reach it, and its children are ended together with it. It starts with no signal blocked, and with the
// default actions of SIGINT, SIGTERM, SIGPIPE and SIGHUP.
class ChildProgram {
 public:
  // Starts the program. When this fails, `error` is set, and has_ended() is true.
  //   words  arguments, the program's name first
  ChildProgram(const Path& program, std::vector<std::string> words, const Streams& streams, Environment environment,
               std::error_code& error);
  // Kills the program and its children. Does not wait for their end, because a program at idle priority can take long
  // to free its memory.
  ~ChildProgram();
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;

  void ask_to_end() const;
  void kill() const;
  void kill_and_wait();
  // Returns true if the program has ended. If so, kills the processes that it left in its group, before the system can
  // reuse its process id.
  bool has_ended();
  const ProgramEnd& end() const { return end_; }  // call this only after has_ended() has returned true

  // Returns the processor time that the program has used, seconds; 0 when it has ended.
  double processor_seconds() const;

 private:
  void bury();

  std::int64_t id_ = -1;
  bool ended_ = false;
  ProgramEnd end_;
};

}  // namespace limber
