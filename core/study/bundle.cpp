// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/bundle.h"

#include <algorithm>
#include <map>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/batch/computing_sources.h"
#include "core/report/report.h"
#include "core/volume_io/volume_io.h"

namespace limber {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr char kSchema[] = "limber-expected/1";
constexpr std::uint64_t kLargestFile = std::uint64_t{1} << 30;
constexpr std::size_t kToldDifferences = 3;

// Gives each input file of a study a name in the bundle. Files with equal names from different folders get numbers.
class InputNames {
 public:
  explicit InputNames(const Study& study) {
    add(study.volume, true);
    for (const auto& [spacing, file] : study.ready) add(file, true);
    add(study.rig, false);
    add(study.tissues, false);
    for (const DescribedPose& pose : study.poses)
      for (const Path& file : {pose.pose, pose.motion, pose.map}) add(file, false);
  }

  struct Input {
    Path path;
    std::string name;
    bool is_volume = false;
  };
  const std::vector<Input>& inputs() const { return inputs_; }
  std::string name_of(const Path& path) const {
    const auto found = std::find_if(inputs_.begin(), inputs_.end(), [&](const Input& one) { return one.path == path; });
    return found == inputs_.end() ? "" : "inputs/" + found->name;
  }

 private:
  void add(const Path& path, bool is_volume) {
    if (path.empty() || !name_of(path).empty()) return;
    std::string name = path.filename().string();
    const auto taken = [&] {
      return std::any_of(inputs_.begin(), inputs_.end(), [&](const Input& one) { return one.name == name; });
    };
    for (int number = 2; taken(); ++number) name = std::to_string(number) + "-" + path.filename().string();
    inputs_.push_back({path, name, is_volume});
  }

  std::vector<Input> inputs_;
};

// Returns the SHA-256 of a cell's posed volume: of its grid, and of the labels of all voxels as values in files. The
// hash does not depend on the file's compression.
std::string voxels_hash(const CellResult& cell, Progress& progress) {
  const VolumeFile file = read_volume(cell.folder / "posed.nrrd", progress);
  std::vector<double> value_of(65536, 0);
  for (const Tissue& tissue : file.tissues.tissues) value_of[tissue.label] = tissue.file_value;
  std::vector<std::uint8_t> bytes;
  const auto add = [&](const auto& value) {
    const auto* from = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof value);
  };
  const Grid& grid = file.volume.grid;
  add(grid.size), add(grid.spacing), add(grid.origin), add(grid.direction);
  const std::string place = sha256_of_bytes(bytes.data(), bytes.size());
  std::vector<double> values(file.volume.voxels.size());
  std::transform(file.volume.voxels.begin(), file.volume.voxels.end(), values.begin(),
                 [&](Label label) { return value_of[label]; });
  const std::string text = place + sha256_of_bytes(values.data(), values.size() * sizeof(double));
  return sha256_of_bytes(text.data(), text.size());
}

// Returns a cell's figures without those that depend on the run or on the folder, such as times and paths.
Json figures_of(const CellResult& cell) {
  Json report = Json::parse(cell.report);
  for (const char* key : {"seconds", "peak_memory_mb", "inputs", "version", "warnings"}) report.erase(key);
  return report;
}

Json expected_of(const Study& study, const std::vector<CellResult>& cells, Progress& progress) {
  Json rows = Json::array();
  for (const CellResult& cell : cells) {
    progress.update("hashes", double(rows.size()) / double(cells.size()));
    Json row{{"cell", text_of(study, cell.cell)}};
    if (cell.done()) row.update({{"voxels_sha256", voxels_hash(cell, progress)}, {"report", figures_of(cell)}});
    else row["failure"] = cell.failure;
    rows.push_back(row);
  }
  return rows;
}

Json read_expected(const Path& path) {
  Json json = Json::parse(checked_json(read_file(path, kLargestFile), path.string()), nullptr, false);
  if (!json.is_object() || json.value("schema", Json()) != kSchema || !json.value("cells", Json()).is_array() ||
      !json.value("inputs", Json()).is_array())
    throw Error("this is not a file of expected results", path.string(), "name the expected.json of a bundle");
  return json;
}

std::string text_at(const Json& object, const char* key) {
  return object.is_object() && object.contains(key) && object[key].is_string() ? object[key].get<std::string>() : "";
}

void copy_input(const Path& from, const Path& to) {
  if (from.extension() == ".gltf" || from.extension() == ".mhd" || from.extension() == ".nhdr")
    throw Error("the file refers to other files, so it cannot be copied alone", from.string(),
                "convert it to one file first, such as .nrrd or .glb");
  std::error_code error;
  fs::copy(from, to, fs::copy_options::recursive, error);
  if (error) throw Error("the input cannot be copied", from.string(), error.message());
}

std::string readme(const Study& study, const std::string& commit, bool is_whole) {
  return "A study to compute again: " + study.name +
         "\n\n"
         "Install Limber " LIMBER_VERSION +
         (commit.empty() ? "" : " (commit " + commit + ")") +
         ", then run in this folder:\n\n  limber experiment study.json -o again --expect expected.json\n\nIt computes "
         "every cell, writes again/report.html, and reports whether each voxel and each number\nis exactly the same; "
         "times and memory are not compared. Other versions of Limber may give other numbers.\n" +
         (is_whole
              ? ""
              : "\nThe volumes are not in this folder. Put them into inputs/ under the names that study.json gives\n"
                "them; expected.json has their SHA-256, which the command checks first.\n");
}

}  // namespace

void write_bundle(const Study& study, const std::vector<CellResult>& cells, const Path& folder, BundleVolumes volumes,
                  const std::string& commit, Progress& progress) {
  for (const CellResult& cell : cells)
    if (!cell.done())
      throw Error("a cell of the study failed", text_of(study, cell.cell),
                  "bundle a study whose cells are all computed");
  std::error_code error;
  fs::create_directories(folder / "inputs", error);
  if (error) throw Error("the folder cannot be made", folder.string(), error.message());
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().filename() != "inputs" || !fs::is_empty(entry.path()))
      throw Error("the folder of the bundle is not empty", folder.string(), "name a new folder");
  const InputNames names(study);
  Json inputs = Json::array();
  bool is_whole = true;
  for (const InputNames::Input& input : names.inputs()) {
    inputs.push_back({{"path", names.name_of(input.path)}, {"sha256", describe_input(input.path).sha256}});
    const bool is_copied = !input.is_volume || volumes == BundleVolumes::Copy;
    if (is_copied) copy_input(input.path, folder / "inputs" / input.name);
    is_whole = is_whole && is_copied;
  }
  const Json expected{{"schema", kSchema}, {"version", LIMBER_VERSION},
                      {"commit", commit},  {"sources", computing_sources()},
                      {"inputs", inputs},  {"cells", expected_of(study, cells, progress)}};
  write_file_atomically(folder / "study.json", to_json(study, [&](const Path& path) { return names.name_of(path); }));
  write_file_atomically(folder / "expected.json", expected.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  write_file_atomically(folder / "README.txt", readme(study, commit, is_whole));
}

void check_inputs(const Study& study, const Path& expected) {
  const Json json = read_expected(expected);
  std::map<std::string, std::string> hashes;
  for (const Json& input : json["inputs"]) hashes[text_at(input, "path")] = text_at(input, "sha256");
  const InputNames names(study);
  for (const InputNames::Input& input : names.inputs()) {
    const auto found = hashes.find("inputs/" + input.name);
    if (found == hashes.end())
      throw Error("the expected results were made without this file", input.path.string(),
                  "use the study.json beside " + expected.string());
    if (describe_input(input.path).sha256 != found->second)
      throw Error("the file is not the one that the expected results were made from", input.path.string(),
                  "put the file with the SHA-256 " + found->second.substr(0, 64) + " there");
  }
}

std::string check_results(const Study& study, const std::vector<CellResult>& cells, const Path& expected,
                          Progress& progress) {
  const Json json = read_expected(expected), found = expected_of(study, cells, progress);
  if (json["cells"].size() != found.size())
    throw Error("the expected results have " + std::to_string(json["cells"].size()) + " cells, but the study has " +
                    std::to_string(found.size()),
                expected.string(), "use the study.json beside this file");
  std::string told;
  std::size_t others = 0, differences = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Json difference = Json::diff(json["cells"][i], found[i]);
    others += !difference.empty();
    for (const Json& one : difference) {
      if (++differences > kToldDifferences) break;
      const Json::json_pointer at(one.at("path").get<std::string>());
      const auto text = [&](const Json& of) { return of.contains(at) ? of.at(at).dump().substr(0, 40) : "nothing"; };
      told += (told.empty() ? "" : "; ") + text_of(study, cells[i].cell) + ": " + at.to_string() + " is " +
              text(found[i]) + ", not " + text(json["cells"][i]);
    }
  }
  const std::string version = text_at(json, "version") + ", commit " + text_at(json, "commit");
  if (others > 0)
    throw Error(std::to_string(others) + " of " + std::to_string(found.size()) + " cells have different numbers", told,
                text_at(json, "sources") == computing_sources()
                    ? "both were computed by the same version of Limber: compare the machines"
                    : "other source code computed the expected results: use Limber " + version);
  return "the results are identical: every voxel and every figure of " + std::to_string(found.size()) +
         " cells is as expected by Limber " + version;
}

}  // namespace limber
