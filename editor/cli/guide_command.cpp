// SPDX-License-Identifier: AGPL-3.0-or-later
// Defines the command `limber guide --html FOLDER`, which writes the user guide as HTML pages. The keys named in the
// pages are those of the default key map.
#include <memory>

#include "core/cmd/command_files.h"
#include "core/cmd/print.h"
#include "editor/cli/command.h"
#include "editor/guide/book_html.h"
#include "editor/input/keymap.h"
#include "editor/ui/asset_path.h"

namespace limber::editor {

void add_guide(CLI::App& app) {
  struct Options {
    std::string folder;
  };
  auto options = std::make_shared<Options>();
  auto* command = app.add_subcommand("guide", "writes the user guide as pages for a browser");
  cmd::writes(
      command->add_option(
          "--html", options->folder,
          "folder to write the pages and their pictures into; index.html is the first page; created if missing"),
      [](const std::string& folder) {
        return cmd::OptionFiles{{}, {Path(folder) / "index.html", Path(folder) / "guide.css"}};
      })
      ->required();
  command->callback([options] {
    const Keymap keymap = read_keymap(asset("keymap.json"));
    write_guide_html(read_guide([&](const std::string& id) {
                       const auto chord = keymap.chord_of(id);
                       return chord ? to_text(*chord) : std::string("(no key)");
                     }),
                     options->folder);
    cmd::print("%s\n", (Path(options->folder) / "index.html").string().c_str());
  });
}

}  // namespace limber::editor
