// SPDX-License-Identifier: AGPL-3.0-or-later
// The command line's subcommands: one file each, one function each, gathered in run.cpp. A function adds its
// subcommand with its options to the app and sets a callback that does the work; errors are thrown, never printed
// there. Exit codes: 0 done, 1 the input or the request is wrong, 2 usage, 3 cancelled, 4 a pose that could not be
// reached: outputs are written, of the last place on the way to it; 5 with --strict, a gate of the result failed:
// outputs are written as without.
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

void add_convert(CLI::App& app);
void add_export_gltf(CLI::App& app);
void add_fit_joint(CLI::App& app);
void add_fit_rig(CLI::App& app);
void add_fk(CLI::App& app);
void add_info(CLI::App& app);
void add_job(CLI::App& app);
void add_phantom(CLI::App& app);
void add_prepare(CLI::App& app);
void add_project(CLI::App& app);
void add_report(CLI::App& app);
void add_resample(CLI::App& app);
void add_skin_points(CLI::App& app);
void add_tissues(CLI::App& app);
void add_weights(CLI::App& app);

// Every subcommand above, and --version.
void add_commands(CLI::App& app);
// Parses and runs; prints an error as one line and returns the exit code. The program's only place that catches.
int run(CLI::App& app, int argc, char** argv);

// Thrown once everything is written, where exit code 0 would say too much.
struct PoseNotReached {};
struct GateFailed {};

// One line each on stderr: "limber: gate failed: ...".
void tell_failed_gates(const std::vector<std::string>& sentences);

// The report on stdout, as a table.
void print_table(const Report& report);

// A description of a file on stdout: as JSON, or as text.
void print_description(const std::string& json, bool as_json);

// One line on stderr: "limber: warning: ...".
void warn(const std::string& line);
void warn(const std::vector<std::string>& lines);

// What a long command shows while it works: a bar when stderr is a terminal, JSON lines ({"stage", "fraction"}) with
// --progress json, else nothing. Ctrl-C cancels it.
class CommandProgress final : public Progress {
 public:
  // `mode`: "" (choose by terminal) or "json"
  explicit CommandProgress(const std::string& mode);
  ~CommandProgress() override;
  bool cancelled() const override;
  // A line of the stage "solving": {"stage", "fraction", "angle_degrees", "iteration", "residual_mm", "seconds_left"}.
  struct Iteration {
    double fraction, angle_degrees;
    int iteration;
    double residual_mm, seconds_left;
  };
  void show(const Iteration& iteration);

  // While it lives, Ctrl-C and SIGTERM end the program at once, with the exit code of a cancelled one: for stages that
  // take long between two updates and have nothing on the disk.
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

// Adds --threads N and --progress json.
struct RunOptions {
  int threads = 0;  // 0: every core
  std::string progress;
};
void add_run_options(CLI::App& command, RunOptions& options);

}  // namespace limber::cmd
