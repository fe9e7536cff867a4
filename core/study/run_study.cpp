// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/run_study.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <sys/resource.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/project/worker.h"
#include "core/report/report.h"
#include "core/study/computing_sources.h"
#include "core/study/machine.h"
#include "core/study/work_folder.h"
#include "core/volume_io/volume_io.h"

namespace limber {

namespace fs = std::filesystem;

namespace {
using Json = nlohmann::ordered_json;

constexpr int kHashLetters = 12;
constexpr double kStepsOfDoubling = 16;
constexpr int kCodeOfOne = 128;

double children_cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void make_folder(const Path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error("the folder cannot be made", folder.string(), error.message());
}

// Returns the text with only those characters that are safe in a file name.
std::string plain(const std::string& text) {
  std::string result;
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '+' || c == '-' || c == '.' || c == '_') result += c;
  return result;
}

std::string hash_of(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  return sha256_of_bytes(text.data(), text.size());
}

// Returns the extension of the file to which a copy of the volume `path` is written. It is the extension of `path` if
// this format can be written, else .nrrd.
std::string volume_ending(const Path& path) {
  const std::string name = path.filename().string();
  for (const char* ending : {".seg.nrrd", ".nrrd", ".mha", ".nii.gz", ".nii"})
    if (name.ends_with(ending)) return ending;
  return ".nrrd";
}

// Estimates the computing time of the remaining cells from the mean time of finished cells of the same technique. Cells
// of the rest pose are ignored, since they are faster than bent poses.
class Pace {
 public:
  void took(const Technique& technique, double seconds) {
    Taken& taken = taken_[word_of(technique)];
    taken.seconds += seconds;
    taken.cells += 1;
    taken.units += weight(technique);
  }
  // Returns the seconds that a cell of this technique is expected to take. Negative if no cell has finished yet.
  double expected(const Technique& technique) const {
    if (const auto found = taken_.find(word_of(technique)); found != taken_.end())
      return found->second.seconds / found->second.cells;
    // Without a finished cell of this technique, uses the times of the other techniques. A solve by finite elements is
    // assumed to take as long as five cells by skinning.
    double units = 0, seconds = 0;
    for (const auto& [word, taken] : taken_) units += taken.units, seconds += taken.seconds;
    return units > 0 ? seconds / units * weight(technique) : -1;
  }

 private:
  struct Taken {
    double seconds = 0, cells = 0, units = 0;
  };
  static double weight(const Technique& technique) { return technique.is_fem() ? 5 : 1; }
  std::map<std::string, Taken> taken_;  // computing times of each technique, by the technique's word ("fem-contact")
};

// Reports the progress of one cell's worker process as part [begin, end] of the whole study's progress.
class CellProgress final : public Progress {
 public:
  CellProgress(Progress& study, std::string name, double begin, double end)
      : study_(study),
        name_(std::move(name)),
        begin_(begin),
        end_(end) {}
  bool cancelled() const override { return study_.cancelled() || Progress::cancelled(); }

 protected:
  void on_update(std::string_view stage, double fraction) override {
    study_.update(name_ + ": " + std::string(stage), begin_ + (end_ - begin_) * std::clamp(fraction, 0.0, 1.0));
  }

 private:
  Progress& study_;
  std::string name_;
  double begin_, end_;
};

class Runner {
 public:
  Runner(const Study& study, const StudyRun& run, Progress& progress)
      : study_(study),
        run_(run),
        progress_(progress),
        cells_(cells_of(study)) {
    for (int i = run.shard; i < std::ssize(cells_); i += run.shards) mine_.push_back(cells_[i]);
  }

  std::vector<CellOutcome> operator()() {
    make_folder(run_.out);
    for (const char* name : {"inputs", "bodies", "cells"}) make_folder(run_.out / name);
    take_inputs();
    std::vector<CellOutcome> outcomes;
    for (const StudyCell& cell : mine_) {
      outcomes.push_back(compute(cell));
      progress_.update("study", double(outcomes.size()) / double(mine_.size()));
    }
    return outcomes;
  }

 private:
  struct Input {
    Path path;  // relative to the folder of a cell, which is two levels below the study's output folder
    std::string sha256;
  };

  // Copies an input file into the study's output folder, so that the jobs in it can be run again after the folder has
  // moved. A .gltf file is not copied, since it refers to other files by their paths.
  Input take(const Path& file) {
    if (file.empty()) return {};
    Input input{fs::absolute(file), sha256_of_file(file)};
    if (file.extension() == ".gltf") return input;
    const std::string name =
        plain(file.stem().string()) + "-" + input.sha256.substr(0, kHashLetters) + file.extension().string();
    if (const Path copy = run_.out / "inputs" / name; !fs::exists(copy)) write_file_atomically(copy, read_file(file));
    input.path = Path("../../inputs") / name;
    return input;
  }

  void take_inputs() {
    rig_ = take(study_.rig);
    tissues_ = take(study_.tissues);
    for (const StudyPose& pose : study_.poses) poses_.push_back({take(pose.pose), take(pose.motion), take(pose.map)});
    bodies_.resize(study_.spacings.size());
  }

  Json body_description(int spacing) {
    const std::optional<double> mm = study_.spacings[spacing];
    Json json{{"sources", computing_sources()},
              {"made", "body/1"},
              {"spacing_mm", mm ? Json(*mm) : Json()},
              {"weights", study_.weights}};
    if (!study_.phantom.empty()) {
      json["phantom"] = study_.phantom;
    } else {
      json["volume"] = sha256_of_file(source(spacing).first);
      json["rig"] = rig_.sha256;
      json["tissues"] = tissues_.sha256;
      json["bones"] = study_.bones;
    }
    return json;
  }

  // Returns the file of the volume for a spacing (index into the study's spacings), and true if the volume must be
  // resampled to this spacing.
  std::pair<Path, bool> source(int spacing) const {
    const std::optional<double> mm = study_.spacings[spacing];
    if (mm)
      if (const auto found = study_.ready.find(*mm); found != study_.ready.end()) return {found->second, false};
    return {study_.volume, mm.has_value()};
  }

  std::string bones_text() const {
    std::string text;
    for (const double label : study_.bones) text += (text.empty() ? "" : ",") + Json(label).dump();
    return text;
  }
  void add_body_words(Json& job, const Path& folder) const {
    job["volume"] = (folder / ("volume" + (study_.phantom.empty() ? volume_ending(study_.volume) : ".nrrd"))).string();
    job["rig"] = study_.phantom.empty() ? rig_.path.string() : (folder / "rig.json").string();
    if (!study_.phantom.empty()) job["tissues"] = (folder / "tissues.json").string();
    if (!tissues_.path.empty()) job["tissues"] = tissues_.path.string();
    if (!study_.bones.empty()) job["bones"] = bones_text();
  }

  WorkerOutput work(const WorkFolder& folder, const std::string& name, Json job, Progress& progress) const {
    write_file_atomically(folder / name, job.dump(1) + "\n");
    if (run_.threads == 0) return run_worker(folder / name, progress);
    // The worker gets a second job file with the number of threads. The job file that stays with the result does not
    // contain this number, since results do not depend on it.
    job["threads"] = run_.threads;
    write_file_atomically(folder / "limited.json", job.dump(1) + "\n");
    WorkerOutput output = run_worker(folder / "limited.json", progress);
    fs::remove(folder / "limited.json");
    return output;
  }

  // Name and key (hash of everything that it depends on) of the folder with the body's volume and skin weights at one
  // spacing. Volume and weights are computed if there is no such folder yet.
  struct Body {
    std::string name, key;
  };
  const Body& body(int spacing, Progress& progress) {
    if (bodies_[spacing]) return *bodies_[spacing];
    const std::string key = hash_of(body_description(spacing));
    const Body body{plain(spacing_text(study_.spacings[spacing])) + "-" + key.substr(0, kHashLetters), key};
    if (const Path place = run_.out / "bodies" / body.name; !fs::exists(place)) {
      WorkFolder folder(place, progress);
      if (!folder.made()) {
        make_body(folder, spacing, progress);
        folder.commit();
      }
    }
    bodies_[spacing] = body;
    return *bodies_[spacing];
  }
  void make_body(WorkFolder& folder, int spacing, Progress& progress) const {
    const double before = children_cpu_seconds();
    const auto [from, regrids] = source(spacing);
    Json first;
    if (!study_.phantom.empty()) {
      first = {{"command", "phantom"}, {"subject", study_.phantom}, {"output", "."}};
      if (study_.spacings[spacing]) first["spacing"] = *study_.spacings[spacing];
    } else {
      first = {{"command", "prepare"},
               {"volume", fs::absolute(from).string()},
               {"output", "volume" + volume_ending(study_.volume)}};
      if (regrids) first["spacing"] = *study_.spacings[spacing];
    }
    work(folder, "volume-job.json", first, progress);
    const double made = children_cpu_seconds();
    Json job{{"command", "weights"}, {"method", study_.weights}, {"output", "weights.nrrd"}};
    add_body_words(job, "");
    work(folder, "weights-job.json", job, progress);
    write_file_atomically(
        folder / "body.json",
        Json{{"cpu_seconds", {{"volume", made - before}, {"weights", children_cpu_seconds() - made}}}}.dump(1) + "\n");
  }

  Json cell_job(const StudyCell& cell, const Body& body) const {
    const StudyPose& pose = study_.poses[cell.pose];
    const auto& [pose_file, motion, map] = poses_[cell.pose];
    const Technique& technique = study_.techniques[cell.technique];
    const Path folder = Path("../../bodies") / body.name;
    Json job{{"command", "resample"}};
    add_body_words(job, folder);
    job["weights"] = (folder / "weights.nrrd").string();
    if (!pose.flex.empty()) job["flex"] = pose.flex;
    if (!pose.body.name.empty()) job["pose_name"] = pose.body.name;
    if (!pose.body.joints.empty()) job["joints"] = pose.body.joints;
    if (!pose_file.path.empty()) job["pose"] = pose_file.path.string();
    if (!motion.path.empty()) job["motion"] = motion.path.string();
    if (!map.path.empty()) job["map"] = map.path.string();
    if (pose.frame) job["frame"] = *pose.frame;
    if (!pose.up.empty()) job["up"] = pose.up;
    job["method"] = technique.method;
    if (technique.contact) job["contact"] = true;
    if (technique.is_fem()) job["quality"] = study_.quality;
    if (technique.mass_exact) job["mass-exact"] = true;
    if (study_.fit_joints) job["fit-joints"] = true;
    if (study_.nearest) job["nearest"] = true;
    job.update({{"output", "posed.nrrd"},
                {"report", "report.json"},
                {"jacobian", "jacobian.nrrd"},
                {"overlap", "overlap.nrrd"}});
    return job;
  }

  std::string cell_key(const StudyCell& cell, const Body& body, const Json& job) const {
    const auto& [pose, motion, map] = poses_[cell.pose];
    return hash_of({{"sources", computing_sources()},
                    {"made", "cell/1"},
                    {"body", body.key},
                    {"job", job},
                    {"inputs", {pose.sha256, motion.sha256, map.sha256}}});
  }

  // Returns true if the folder contains a complete result of a cell with this key.
  static bool is_done(const Path& folder, const std::string& key) {
    if (!fs::exists(folder / "cell.json")) return false;
    const Json json = Json::parse(sound_json(read_file(folder / "cell.json")), nullptr, false);
    return json.is_object() && json.value("key", "") == key && fs::exists(folder / "report.json") &&
           fs::exists(folder / "posed.nrrd");
  }
  static bool is_rest(const StudyPose& pose) {
    return pose.flex.empty() && pose.body.empty() && pose.pose.empty() && pose.motion.empty();
  }
  // Returns the technique from whose times the time of the cell is estimated. A cell of the rest pose takes as long as
  // skinning, whatever its technique is.
  Technique kind_of(const StudyCell& cell) const {
    return is_rest(study_.poses[cell.pose]) ? Technique{"lbs"} : study_.techniques[cell.technique];
  }
  static double wall_seconds_of(const Path& folder) {
    return Json::parse(sound_json(read_file(folder / "cell.json")), nullptr, false).value("wall_seconds", 0.0);
  }

  CellOutcome compute(const StudyCell& cell) {
    const int number = ++started_;
    const double of = double(mine_.size());
    CellProgress progress(progress_,
                          std::to_string(number) + " of " + std::to_string(mine_.size()) + ", " + text_of(study_, cell),
                          (number - 1) / of, number / of);
    const Body& of_body = body(cell.spacing, progress);
    const Json job = cell_job(cell, of_body);
    const std::string key = cell_key(cell, of_body, job);
    const std::string name = plain(spacing_text(study_.spacings[cell.spacing])) + "-" +
                             plain(study_.poses[cell.pose].name) + "-" + word_of(study_.techniques[cell.technique]) +
                             "-" + key.substr(0, kHashLetters);
    CellOutcome outcome{cell, run_.out / "cells" / name, {}};
    bool was_there = true;
    if (fs::exists(outcome.folder) && !is_done(outcome.folder, key))
      fs::remove_all(outcome.folder);  // the result in the folder is damaged
    if (!fs::exists(outcome.folder)) {
      WorkFolder folder(outcome.folder, progress);
      was_there = folder.made();
      if (!was_there) outcome.failure = compute_into(folder, cell, key, job, progress);
    }
    if (outcome.failure.empty() && !is_rest(study_.poses[cell.pose]))
      pace_.took(kind_of(cell), wall_seconds_of(outcome.folder));
    tell(outcome, number, was_there);
    return outcome;
  }

  // Computes a cell and writes its result to the folder. Returns the message of the error if the cell failed, else an
  // empty text. Throws Error if no other cell could be computed either, because the disk is full.
  std::string compute_into(WorkFolder& folder, const StudyCell& cell, const std::string& key, const Json& job,
                           Progress& progress) const {
    const Stopwatch wall;
    const double before = children_cpu_seconds();
    bool reached = true;
    try {
      reached = work(folder, "job.json", job, progress).pose_reached;
    } catch (const Error& error) {
      if (!folder.has_room())
        throw Error("the results cannot be written", run_.out.string(),
                    "make room on the disk, then run the same again");
      return error.what();
    }
    const double cpu = children_cpu_seconds() - before, seconds = wall.seconds();
    code_ratios(folder);
    write_file_atomically(
        folder / "cell.json",
        Json{{"schema", "limber-cell/1"},
             {"key", key},
             {"spacing_mm", study_.spacings[cell.spacing] ? Json(*study_.spacings[cell.spacing]) : Json()},
             {"pose", study_.poses[cell.pose].name},
             {"method", word_of(study_.techniques[cell.technique])},
             {"pose_reached", reached},
             {"cpu_seconds", cpu},
             {"wall_seconds", seconds},
             {"machine", machine_text()},
             {"sources", computing_sources()}}
                .dump(1, ' ', false, Json::error_handler_t::replace) +
            "\n");
    folder.commit();
    return {};
  }

  static void code_ratios(const WorkFolder& folder) {
    const GreyVolume ratios = read_grey_volume(folder / "jacobian.nrrd");
    LabelVolume codes{ratios.grid, ZeroedVector<Label>(ratios.voxels.size())};
    for (size_t i = 0; i < ratios.voxels.size(); ++i)
      codes.voxels[i] = ratios.voxels[i] == 0 ? 0 : code_of_ratio(ratios.voxels[i]);
    write_volume(codes, folder / "ratio.nrrd", {}, {"NRRD", "uint8", true});
    fs::remove(folder / "jacobian.nrrd");
  }

  void tell(const CellOutcome& outcome, int number, bool was_there) const {
    if (!run_.on_cell) return;
    double left = 0;
    for (int i = number; i < std::ssize(mine_) && left >= 0; ++i) {
      const double expected = pace_.expected(kind_of(mine_[i]));
      left = expected < 0 ? -1 : left + expected;
    }
    run_.on_cell(outcome, number, static_cast<int>(mine_.size()), was_there, left);
  }

  const Study& study_;
  const StudyRun& run_;
  Progress& progress_;
  const std::vector<StudyCell> cells_;
  std::vector<StudyCell> mine_;
  Input rig_, tissues_;
  std::vector<std::array<Input, 3>> poses_;  // for each pose: its pose file, motion file and retarget map
  std::vector<std::optional<Body>> bodies_;
  Pace pace_;
  int started_ = 0;
};

}  // namespace

std::vector<StudyCell> cells_of(const Study& study) {
  std::vector<StudyCell> cells;
  for (int s = 0; s < std::ssize(study.spacings); ++s)
    for (int p = 0; p < std::ssize(study.poses); ++p)
      for (int t = 0; t < std::ssize(study.techniques); ++t) cells.push_back({s, p, t});
  return cells;
}

std::string text_of(const Study& study, const StudyCell& cell) {
  return spacing_text(study.spacings[cell.spacing]) + ", " + study.poses[cell.pose].name + ", " +
         title_of(study.techniques[cell.technique]);
}

std::uint8_t code_of_ratio(double ratio) {
  if (!(ratio > 0)) return 1;  // an inverted voxel gets the smallest code of tissue
  return static_cast<std::uint8_t>(std::clamp(std::lround(kCodeOfOne + kStepsOfDoubling * std::log2(ratio)), 1L, 255L));
}
double ratio_of_code(int code) { return std::exp2((code - kCodeOfOne) / kStepsOfDoubling); }

std::vector<CellOutcome> run_study(const Study& study, const StudyRun& run, Progress& progress) {
  return Runner(study, run, progress)();
}

}  // namespace limber
