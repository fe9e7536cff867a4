// SPDX-License-Identifier: AGPL-3.0-or-later
// Fuzzes the readers of the JSON files that the editor keeps outside projects: a file is read with all values in their
// ranges, or refused with Error. The first byte says what the other bytes are:
//   P  preferences     K  a key map     T  a theme     R  the list of recent files     A  an arrangement of areas
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

#include "core/base/error.h"
#include "editor/context/layout_json.h"
#include "editor/context/preferences.h"
#include "editor/context/recent_files.h"
#include "editor/input/keymap.h"
#include "editor/input/keymap_overrides.h"
#include "editor/ui/theme.h"

namespace {

using namespace limber;
using namespace limber::editor;

void require(bool holds) {
  if (!holds) std::abort();
}

Path file_of(const std::string& text) {
  static const Path path = std::filesystem::temp_directory_path() / ("fuzz-editor-" + std::to_string(::getpid()));
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

void check(const Arrangements& arrangements) {
  for (const Arrangement& one : arrangements) {
    require(one.views <= ViewLayout::Four && (!one.maximized || *one.maximized <= ViewId::Sagittal));
    for (const float share : {one.split_x, one.split_y, one.four_x, one.four_y}) require(share > 0 && share < 1);
    require(one.sidebar_width >= 260 && one.sidebar_width <= 520);
  }
}

void read_preferences_text(const std::string& text) {
  std::string problem;
  const Preferences preferences = preferences_from_json(text, problem);
  require(preferences.scale >= 0.75 && preferences.scale <= 3);
  require(preferences.jobs_at_once >= 1 && preferences.jobs_at_once <= 8);
  require(preferences.recent_commands.size() <= Preferences::kMostRecent);
  check(preferences.arrangements);
  // Whatever was read is written and read again unchanged.
  require(preferences_from_json(to_json(preferences), problem) == preferences || !problem.empty());
}

void read_keymap_text(const std::string& text) {
  const Keymap keymap = read_keymap(file_of(text), TwoMeanings::LetIn);
  clashes(keymap);
  const Keymap again = read_keymap(file_of(to_json(keymap)), TwoMeanings::LetIn);
  require(changed(again, differences(again, keymap)).contexts.size() == keymap.contexts.size());
}

void read_remembered_text(const std::string& text) {
  std::string warning;
  const RecentFiles recent_files = read_recent_files(file_of(text), warning);
  require(recent_files.tour_step >= 0 && recent_files.recents.size() <= 30);
  for (const Recent& recent : recent_files.recents) require(recent.path.is_absolute());
}

void read_arrangements_text(const std::string& text) {
  Arrangements arrangements = default_arrangements();
  restore(text, arrangements);
  check(arrangements);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    switch (data[0]) {
      case 'P': read_preferences_text(text); break;
      case 'K': read_keymap_text(text); break;
      case 'T': read_theme(file_of(text)); break;
      case 'R': read_remembered_text(text); break;
      case 'A': read_arrangements_text(text); break;
    }
  } catch (const Error&) {
  }
  return 0;
}
