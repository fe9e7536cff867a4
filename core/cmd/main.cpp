// SPDX-License-Identifier: AGPL-3.0-or-later
// The program without the editor: subcommands only.
#include <cstdio>
#include <exception>
#include <new>

#include "core/base/error.h"
#include "core/cmd/command.h"

int main(int argc, char** argv) {
  using namespace limber;
  CLI::App app("Limber changes the pose of labelled voxel anatomy.", "limber");
  app.require_subcommand(1);
  app.set_version_flag("--version", LIMBER_VERSION);
  cmd::add_convert(app);
  cmd::add_fit_joint(app);
  cmd::add_fk(app);
  cmd::add_info(app);
  cmd::add_job(app);
  cmd::add_phantom(app);
  cmd::add_prepare(app);
  cmd::add_report(app);
  cmd::add_resample(app);
  cmd::add_skin_points(app);
  cmd::add_weights(app);

  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const Cancelled&) {
    return 3;
  } catch (const Error& error) {
    std::fprintf(stderr, "limber: %s\n", cmd::one_line(error.what()).c_str());
    return 1;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "limber: there is not enough memory: this request: use a coarser spacing or a smaller volume\n");
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "limber: a mistake of the program itself: %s: please report it with the command that shows it\n",
                 cmd::one_line(error.what()).c_str());
    return 1;
  }
}
