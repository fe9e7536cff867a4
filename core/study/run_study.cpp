// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/run_study.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/batch/cell_store.h"
#include "core/batch/part_of_progress.h"
#include "core/volume_io/volume_io.h"

namespace limber {

namespace fs = std::filesystem;

namespace {
using Json = nlohmann::ordered_json;

constexpr double kStepsOfDoubling = 16;
constexpr int kCodeOfOne = 128;

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

class Runner {
 public:
  Runner(const Study& study, const StudyRun& run, Progress& progress)
      : study_(study),
        run_(run),
        progress_(progress),
        store_(run.out, run.threads),
        settings_{.quality = study.quality,
                  .fit_joints = study.fit_joints,
                  .nearest = study.nearest,
                  .repeats = study.repeats,
                  .outputs = {{"output", "posed.nrrd"},
                              {"report", "report.json"},
                              {"jacobian", "jacobian.nrrd"},
                              {"overlap", "overlap.nrrd"}}} {
    const std::vector<StudyCell> cells = cells_of(study);
    for (int i = run.shard; i < std::ssize(cells); i += run.shards) mine_.push_back(cells[i]);
    for (const std::optional<double>& spacing : study.spacings) bodies_.push_back(body_at(spacing));
  }

  std::vector<CellOutcome> operator()() {
    std::vector<CellOutcome> outcomes;
    for (const StudyCell& cell : mine_) {
      outcomes.push_back(compute(cell));
      progress_.update("study", double(outcomes.size()) / double(mine_.size()));
    }
    return outcomes;
  }

 private:
  DescribedBody body_at(const std::optional<double>& spacing) const {
    DescribedBody body{.name = spacing_text(spacing),
                       .phantom = study_.phantom,
                       .volume = study_.volume,
                       .rig = study_.rig,
                       .tissues = study_.tissues,
                       .bones = study_.bones,
                       .spacing = spacing,
                       .weights = study_.weights};
    if (spacing)
      if (const auto ready = study_.ready.find(*spacing); ready != study_.ready.end()) {
        body.volume = ready->second;
        body.spacing.reset();
      }
    return body;
  }

  // Returns the technique from whose times the time of the cell is estimated. A cell of the rest pose takes as long as
  // skinning, whatever its technique is.
  Technique kind_of(const StudyCell& cell) const {
    return study_.poses[cell.pose].is_rest() ? Technique{"lbs"} : study_.techniques[cell.technique];
  }

  CellRequest request_of(const StudyCell& cell) const {
    const DescribedPose& pose = study_.poses[cell.pose];
    const Technique& technique = study_.techniques[cell.technique];
    const std::optional<double>& spacing = study_.spacings[cell.spacing];
    const Json facts{
        {"spacing_mm", spacing ? Json(*spacing) : Json()}, {"pose", pose.name}, {"method", word_of(technique)}};
    return {bodies_[cell.spacing],
            pose,
            technique,
            settings_,
            file_word(spacing_text(spacing)) + "-" + file_word(pose.name) + "-" + word_of(technique),
            facts.dump(-1, ' ', false, Json::error_handler_t::replace)};
  }

  CellOutcome compute(const StudyCell& cell) {
    const int number = ++started_;
    const double of = double(mine_.size());
    PartOfProgress progress(
        progress_, std::to_string(number) + " of " + std::to_string(mine_.size()) + ", " + text_of(study_, cell),
        (number - 1) / of, number / of);
    const StoredCell stored = store_.compute(request_of(cell), IfBusy::Wait, progress, code_ratios);
    const CellOutcome outcome{cell, stored.folder, stored.failure};
    if (outcome.failure.empty() && !study_.poses[cell.pose].is_rest())
      pace_.took(kind_of(cell), study_.repeats * wall_seconds_of(outcome.folder));
    tell(outcome, number, stored.state == CellState::WasThere);
    return outcome;
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
  CellStore store_;
  const CellSettings settings_;
  std::vector<StudyCell> mine_;
  std::vector<DescribedBody> bodies_;  // the body at each of the study's spacings
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
