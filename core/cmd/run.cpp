// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/command.h"

#include <exception>
#include <new>
#include <sstream>
#include <system_error>

#include "core/base/error.h"
#include "core/base/leftovers.h"
#include "core/base/named_files.h"
#include "core/cmd/command_files.h"
#include "core/cmd/slicer_xml.h"
#include "core/cmd/surface_options.h"
#include "core/platform/large_blocks.h"
#include "core/platform/terminal.h"

namespace limber::cmd {

namespace {
constexpr const char* kExitCodes =
    "Exit codes: 0 success; 1 the input or the request is wrong, as one line of text explains; 2 wrong command line; 3 "
    "cancelled; 4 the finite element solve did not reach the pose, and the outputs show the last pose that it reached; "
    "5 a quality gate failed with --strict, and the outputs are written.";
}  // namespace

void add_commands(CLI::App& app, const std::string& commit) {
  app.footer(std::string(kExitCodes) +
             "\n"
             "\n"
             "limber COMMAND --xml describes a command for 3D Slicer (Slicer Execution Model).");
  app.set_version_flag("--version", LIMBER_VERSION + (commit.empty() ? "" : ", commit " + commit));
  add_bake_joint(app);
  add_batch(app);
  add_clean_motion(app);
  add_convert(app);
  add_export_gltf(app);
  add_fit_joint(app);
  add_fit_rig(app);
  add_fk(app);
  add_info(app);
  add_job(app);
  add_mesh(app);
  add_phantom(app);
  add_prepare(app);
  add_project(app);
  add_repair_joint(app);
  add_report(app);
  add_resample(app);
  add_skin_points(app);
  add_surfaces(app);
  add_tissues(app);
  add_weights(app);
}

namespace {
int told(const std::string& line, int exit_code) {
  tell("limber: " + line);
  return exit_code;
}

// Prints CLI11's message: help and version go to stdout, usage errors to stderr.
int told_by_parser(const CLI::App& app, const CLI::ParseError& error) {
  std::ostringstream out, err;
  const int code = app.exit(error, out, err);
  print_text(out.str());
  std::istringstream lines(err.str());
  for (std::string line; std::getline(lines, line);) tell(line);
  return code == 0 ? 0 : 2;
}

int run_command(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return told_by_parser(app, error);
  } catch (const Cancelled&) {
    return 3;
  } catch (const PoseNotReached&) {
    return 4;
  } catch (const GateFailed&) {
    return 5;
  } catch (const UsageError& error) {
    return told(error.what(), 2);
  } catch (const Error& error) {
    return told(error.what(), 1);
  } catch (const std::bad_alloc&) {
    return told("there is not enough memory: this request: use a coarser spacing or a smaller volume", 1);
  } catch (const std::system_error& error) {
    // This error means that the system could not start another thread.
    const bool lacks_room = error.code() == std::errc::resource_unavailable_try_again;
    if (lacks_room)
      return told(
          "there is not enough memory for another thread: this request: use a coarser spacing or a smaller volume", 1);
    return told(std::string("the system refuses: ") + error.what() +
                    ": try again; if it fails again, report it with the command that shows it",
                1);
  } catch (const std::exception& error) {
    return told(std::string("internal error: ") + error.what() + ": please report it with the command that shows it",
                1);
  }
}
}  // namespace

int run(CLI::App& app, int argc, char** argv) {
  use_large_blocks();
  keep_standard_streams();
  remove_leftovers();
  check_files_of_all(app);
  const std::string xml = requested_slicer_xml(app, std::vector<std::string>(argv + 1, argv + argc));
  print_text(xml);
  const int code = xml.empty() ? run_command(app, argc, argv) : 0;
  if (all_is_printed()) return code;
  return told(
      "the printed text could not be written: standard output: check that the output is open and its disk has room",
      code == 0 ? 1 : code);
}

}  // namespace limber::cmd
