// SPDX-License-Identifier: AGPL-3.0-or-later
// The subcommands of the command line. Each has its own source file and one function, which run.cpp calls. The function
// adds the subcommand to the app, with its options and with a callback that does the work. The callback throws errors
// and never prints them. Exit codes: 0 done; 1 the input or the request is wrong; 2 wrong usage; 3 cancelled; 4 the
// pose could not be reached, so the outputs show the last pose that was reached on the way to it; 5 a quality gate of
// the result failed with --strict, but the outputs are written as without --strict.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/base/parallel.h"
#include "core/base/progress.h"
#include "core/cmd/print.h"

namespace limber {
struct Report;
}

namespace limber::cmd {

void add_bake_joint(CLI::App& app);
void add_batch(CLI::App& app);
void add_clean_motion(CLI::App& app);
void add_convert(CLI::App& app);
void add_export_gltf(CLI::App& app);
void add_fit_joint(CLI::App& app);
void add_fit_rig(CLI::App& app);
void add_fk(CLI::App& app);
void add_info(CLI::App& app);
void add_job(CLI::App& app);
void add_mesh(CLI::App& app);
void add_phantom(CLI::App& app);
void add_prepare(CLI::App& app);
void add_project(CLI::App& app);
void add_repair_joint(CLI::App& app);
void add_report(CLI::App& app);
void add_resample(CLI::App& app);
void add_skin_points(CLI::App& app);
void add_tissues(CLI::App& app);
void add_weights(CLI::App& app);

// Adds all subcommands of this header, and --version.
//   commit  the commit that the program was built from (program_commit.h); "": unknown
void add_commands(CLI::App& app, const std::string& commit);
// Parses and runs the command line. Prints an error as one line and returns the exit code. Only this function turns
// exceptions into exit codes.
int run(CLI::App& app, int argc, char** argv);

// Exceptions for the exit codes 4 and 5, thrown after all outputs are written.
struct PoseNotReached {};
struct GateFailed {};

// Prints one line "limber: gate failed: ..." on stderr for each sentence.
void tell_failed_gates(const std::vector<std::string>& sentences);

// Prints the report on stdout as a table.
void print_table(const Report& report);

// Prints the description of a file on stdout, as JSON or as text that is made from the JSON.
void print_description(const std::string& json, bool as_json);

// Prints "limber: warning: ..." on stderr as one line.
void warn(const std::string& line);
void warn(const std::vector<std::string>& lines);

// Shows the progress of a long command: JSON lines ({"stage", "fraction"}) with --progress json, otherwise a bar if
// stderr is a terminal, otherwise nothing. Ctrl-C cancels the command.
class CommandProgress final : public Progress {
 public:
  // `mode` is the value of --progress: "json" for JSON lines; "" for a bar if stderr is a terminal.
  explicit CommandProgress(const std::string& mode);
  ~CommandProgress() override;
  bool cancelled() const override;
  // The values of a progress line of the stage "solving": {"stage", "fraction", "angle_degrees", "iteration",
  // "residual_mm", "seconds_left"}.
  struct Iteration {
    double fraction, angle_degrees;
    int iteration;
    double residual_mm, seconds_left;
  };
  void show(const Iteration& iteration);

  // While this object lives, Ctrl-C and SIGTERM end the program at once, with the exit code of a cancelled command. It
  // is for stages that take long between two progress updates and have written nothing to the disk yet.
  class LeavesAtOnce {
   public:
    LeavesAtOnce();
    ~LeavesAtOnce();
    LeavesAtOnce(const LeavesAtOnce&) = delete;
    LeavesAtOnce& operator=(const LeavesAtOnce&) = delete;
  };

 protected:
  void on_update(std::string_view stage, double fraction) override;

 private:
  CancelScope cancels_loops_{*this};
  enum class Mode { Silent, Bar, Json } mode_;
  std::string stage_;
  double shown_ = -1;
};

// The values of the options --threads N and --progress json.
struct RunOptions {
  int threads = 0;  // number of threads that the command uses; 0: one for each processor core
  std::string progress;
};
void add_run_options(CLI::App& command, RunOptions& options);

}  // namespace limber::cmd
