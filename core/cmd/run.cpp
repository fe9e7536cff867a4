// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/command.h"

#include <cstdio>
#include <exception>
#include <new>

#include "core/base/error.h"
#include "core/base/leftovers.h"
#include "core/base/named_files.h"
#include "core/cmd/command_files.h"
#include "core/cmd/surface_options.h"

namespace limber::cmd {

namespace {
constexpr const char* kExitCodes =
    "Exit codes: 0 done; 1 the input or the request is wrong, one line says what, where and what to do; 2 usage; 3 cancelled; "
    "4 finite elements could not reach the pose, the outputs hold the way to it; 5 with --strict, a gate failed, the outputs are written.";
}  // namespace

void add_commands(CLI::App& app) {
  app.footer(kExitCodes);
  app.set_version_flag("--version", LIMBER_VERSION);
  add_convert(app);
  add_export_gltf(app);
  add_fit_joint(app);
  add_fit_rig(app);
  add_fk(app);
  add_info(app);
  add_job(app);
  add_phantom(app);
  add_prepare(app);
  add_project(app);
  add_report(app);
  add_resample(app);
  add_skin_points(app);
  add_surfaces(app);
  add_tissues(app);
  add_weights(app);
}

int run(CLI::App& app, int argc, char** argv) {
  remove_leftovers();
  try {
    check_files_of_all(app);
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const Cancelled&) {
    return 3;
  } catch (const PoseNotReached&) {
    return 4;
  } catch (const GateFailed&) {
    return 5;
  } catch (const UsageError& error) {
    std::fprintf(stderr, "limber: %s\n", one_line(error.what()).c_str());
    return 2;
  } catch (const Error& error) {
    std::fprintf(stderr, "limber: %s\n", one_line(error.what()).c_str());
    return 1;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "limber: there is not enough memory: this request: use a coarser spacing or a smaller volume\n");
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "limber: a mistake of the program itself: %s: please report it with the command that shows it\n",
                 one_line(error.what()).c_str());
    return 1;
  }
}

}  // namespace limber::cmd
