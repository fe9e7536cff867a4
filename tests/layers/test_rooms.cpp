// SPDX-License-Identifier: AGPL-3.0-or-later
// Lists the folders of each layer in order: files include only files of folders that come before theirs in the list. A
// newcomer can read a layer from the top of its list to the bottom.
#include <algorithm>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/layers/sources.h"

using namespace limber::layers;

namespace {

struct Floor {
  std::string name;
  std::vector<std::string> rooms;  // folders; "" for the files directly in the layer's folder
};

const std::vector<Floor> kFloors = {
    {"core",
     {"platform", "base",          "volume",     "tissue",  "volume_io",     "rig",     "motion",   "rig_io",  "pose",
      "phantom",  "measure",       "mesh",       "bones",   "prepare",       "autorig", "skin",     "binding", "seams",
      "paint",    "paint/brushes", "label_edit", "deform",  "deform/blends", "fem",     "resample", "export",  "report",
      "repair",   "body",          "bake",       "project", "batch",         "study",   "cmd",      "python"}},
    {"render", {"gl", "scene", "textures", "passes", ""}},
    {"editor", {"input",  "ui",       "context", "dialogs", "guide",  "file_browser", "shown",     "viewport",
                "volume", "measure",  "seams",   "rig",     "motion", "pose",         "selection", "labels",
                "skin",   "resample", "figure",  "files",   "screen", "app",          "cli"}},
};

std::string room_of(const std::string& file) { return fs::path(file).parent_path().generic_string(); }

// Returns the name of a file's unit: a header and the source of the same name are one unit.
std::string unit_of(const std::string& file) { return file.substr(0, file.rfind('.')); }

// Returns for each unit the program's own units that it includes.
std::map<std::string, std::set<std::string>> included_units() {
  std::map<std::string, std::set<std::string>> included;
  const std::vector<fs::path> files = sources({"core", "render", "editor"});
  for (const fs::path& file : files) included[unit_of(file.generic_string())];
  for (const fs::path& file : files)
    for (const Include& include : includes_of(file)) {
      const std::string from = unit_of(include.file), to = unit_of(include.header);
      if (from != to && included.contains(to)) included[from].insert(to);
    }
  return included;
}

// Finds the units that include one another in a cycle, by Tarjan's algorithm [1972]. Gives one list per cycle.
class Circles {
 public:
  explicit Circles(const std::map<std::string, std::set<std::string>>& included) : included_(included) {
    for (const auto& [unit, others] : included)
      if (!number_.contains(unit)) visit(unit);
  }
  const std::vector<std::vector<std::string>>& found() const { return found_; }

 private:
  void visit(const std::string& unit) {
    number_[unit] = lowest_[unit] = static_cast<int>(number_.size());
    open_.push_back(unit);
    for (const std::string& other : included_.at(unit)) {
      if (!number_.contains(other)) {
        visit(other);
        lowest_[unit] = std::min(lowest_[unit], lowest_[other]);
      } else if (std::find(open_.begin(), open_.end(), other) != open_.end()) {
        lowest_[unit] = std::min(lowest_[unit], number_[other]);
      }
    }
    if (lowest_[unit] != number_[unit]) return;
    const auto first = std::find(open_.begin(), open_.end(), unit);
    if (open_.end() - first > 1) found_.emplace_back(first, open_.end());
    open_.erase(first, open_.end());
  }

  const std::map<std::string, std::set<std::string>>& included_;
  std::map<std::string, int> number_, lowest_;
  std::vector<std::string> open_;
  std::vector<std::vector<std::string>> found_;
};

}  // namespace

TEST_CASE("rooms: every folder is in its floor's list, and the list names no other") {
  for (const Floor& floor : kFloors) {
    std::set<std::string> listed, there;
    for (const std::string& room : floor.rooms) listed.insert(room.empty() ? floor.name : floor.name + "/" + room);
    for (const fs::path& file : sources({floor.name})) there.insert(room_of(file.generic_string()));
    CHECK(listed == there);
  }
}

TEST_CASE("rooms: a room includes only rooms that come before it") {
  int seen = 0;
  for (const Floor& floor : kFloors) {
    std::map<std::string, int> place;
    for (const std::string& room : floor.rooms)
      place.emplace(room.empty() ? floor.name : floor.name + "/" + room, static_cast<int>(place.size()));
    for (const fs::path& file : sources({floor.name}))
      for (const Include& include : includes_of(file)) {
        const auto from = place.find(room_of(include.file)), to = place.find(room_of(include.header));
        if (from == place.end() || to == place.end()) continue;
        ++seen;
        INFO(include.file, " includes ", include.header);
        CHECK(to->second <= from->second);
      }
  }
  CHECK(seen > 1000);
}

TEST_CASE("rooms: no more than three units include one another in a circle") {
  const auto included = included_units();
  CHECK(included.size() > 400);
  const Circles circles(included);
  for (const auto& circle : circles.found()) {
    std::string names;
    for (const std::string& unit : circle) names += unit + " ";
    INFO(names);
    CHECK(circle.size() <= 3);
  }
}

TEST_CASE("rooms: a header's change rebuilds few sources of the editor") {
  const std::vector<fs::path> files = sources({"editor"});
  std::map<std::string, std::vector<std::string>> includes;
  for (const fs::path& file : files)
    for (const Include& include : includes_of(file))
      if (include.header.starts_with("editor/")) includes[include.file].push_back(include.header);
  std::map<std::string, int> rebuilt;
  for (const fs::path& file : files) {
    if (file.extension() == ".h") rebuilt[file.generic_string()];
    if (file.extension() != ".cpp") continue;
    std::set<std::string> reached;
    std::vector<std::string> open = {file.generic_string()};
    while (!open.empty()) {
      const std::string next = open.back();
      open.pop_back();
      for (const std::string& header : includes[next])
        if (reached.insert(header).second) open.push_back(header);
    }
    for (const std::string& header : reached) ++rebuilt[header];
  }
  std::vector<int> counts;
  for (const auto& [header, count] : rebuilt) counts.push_back(count);
  std::nth_element(counts.begin(), counts.begin() + std::ssize(counts) / 2, counts.end());
  CHECK(counts[counts.size() / 2] < 10);
  // At most 36 headers may be included, directly or through other headers, by 40 sources or more: the basic widgets,
  // the context, and the headers that most users of the context need.
  CHECK(std::count_if(counts.begin(), counts.end(), [](int count) { return count >= 40; }) <= 36);
}

TEST_CASE("rooms: few files of the editor name the struct that owns its state") {
  const std::regex word(R"(\bEditor\b)");
  int naming = 0;
  for (const fs::path& file : sources({"editor"})) {
    const std::vector<std::string> lines = lines_of(file);
    naming +=
        std::any_of(lines.begin(), lines.end(), [&](const std::string& line) { return std::regex_search(line, word); });
  }
  CHECK(naming > 0);
  CHECK(naming < 40);
}

TEST_CASE("rooms: a volume, a click and a dab pass through rooms in their order, down and up once") {
  // Each walk lists units in the order in which one user action calls them: a unit includes the next one, and the next
  // one lies in the same folder or in one that comes earlier in the lists. Calls return along the same units, so a walk
  // leads down once and up once.
  const std::vector<std::vector<std::string>> walks = {
      // A label volume from its file, through a pose, to the posed file.
      {"core/cmd/resample", "core/cmd/body_options", "core/body/body", "core/volume_io/volume_io",
       "core/volume_io/voxel_source"},
      {"core/cmd/resample", "core/body/pose_body", "core/resample/posed_voxels", "core/resample/resample",
       "core/deform/inverse_map", "core/deform/rasterize", "core/deform/lattice"},
      {"core/body/body", "core/volume_io/volume_io", "core/volume_io/volume_format", "core/volume_io/voxel_writer"},
      // A click from the window to the document: the event names an operator, whose edit is committed.
      {"editor/app/editor", "editor/app/event_dispatch", "editor/context/operator"},
      {"editor/pose/pose_ops", "editor/context/document_edits", "core/project/history", "core/project/document"},
      // A brush dab from the pointer to the stroke, and the changed weights from there to the texture of weights.
      {"editor/app/editor", "editor/skin/paint_mode", "editor/skin/painting", "core/paint/stroke",
       "core/paint/brush_rule"},
      {"editor/skin/paint_mode", "editor/context/views", "render/view", "render/passes/pass_resources",
       "render/textures/weight_texture"},
  };
  std::map<std::string, int> place;  // position of each folder, from the lowest of core to the highest of editor
  for (const Floor& floor : kFloors)
    for (const std::string& room : floor.rooms)
      place.emplace(room.empty() ? floor.name : floor.name + "/" + room, static_cast<int>(place.size()));
  const auto included = included_units();
  for (const std::vector<std::string>& walk : walks)
    for (std::size_t step = 1; step < walk.size(); ++step) {
      INFO(walk[step - 1], " to ", walk[step]);
      REQUIRE(included.contains(walk[step - 1]));
      CHECK(included.at(walk[step - 1]).contains(walk[step]));
      CHECK(place.at(room_of(walk[step])) <= place.at(room_of(walk[step - 1])));
    }
}
