// SPDX-License-Identifier: AGPL-3.0-or-later
// A study compares one body at several voxel spacings, in several poses, by several techniques (ways of posing). Each
// combination of these is a cell, computed by one run of `limber resample`. A study is described in a JSON file, in
// which paths are relative to the file's folder:
//   {"name"?: "Elbow", "volume": "arm.nrrd" | "phantom": "arm"|"body", "rig"?: "rig.json", "tissues"?: "t.json",
//    "bones"?: [111, 209], "weights"?: "heat"|"geodesic"|"rigid", "spacings_mm"?: [2, 3, 4],
//    "methods"?: ["lbs", "dqs", "fem", "fem-contact", "fem-mass-exact"...],
//    "poses": [{"name": "+45", "flex": ["Forearm=45"]}, ... (batch/described_pose.h)],
//    "quality"?: "draft"|"normal"|"fine", "fit_joints"?: true, "nearest"?: true, "repeats"?: 5,
//    "gates"?: {"tissue_percent": 1, ...}, "volumes"?: [{"spacing_mm": 2, "volume": "arm-2mm.nrrd"}, ...]}
// Without spacings_mm the volume keeps its own spacing; without methods the study compares lbs, dqs, fem and
// fem-contact. A phantom has its own rig and tissues. `volumes` are files of the same body at some of the spacings; at
// other spacings `volume` is resampled. `repeats`: how many times each cell is computed, to measure the spread of its
// time.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/batch/described_pose.h"
#include "core/batch/technique.h"
#include "core/report/quality_gates.h"

namespace limber {

// The look of a technique on the report page: `number`, [0, kLooks), selects its colour and its mark. A mass-exact
// technique (exact = true) has the look of the same method without this correction, but with a hollow mark.
struct TechniqueLook {
  int number = -1;  // -1: grey, for values that belong to no technique
  bool exact = false;
};
inline constexpr int kLooks = 5;
TechniqueLook look_of(const Technique& technique);

struct Study {
  std::string name = "Study";
  Path description;     // the file that the study was read from; empty: none
  std::string phantom;  // "arm", "body", or empty for a study of `volume`
  Path volume, rig, tissues;
  std::map<double, Path> ready;  // volume files at some spacings (mm); at other spacings `volume` is resampled
  std::vector<double> bones;
  std::string weights = "heat", quality = "normal";
  bool fit_joints = false, nearest = false;
  int repeats = 1;  // how many times each cell is computed, to measure the spread of its time
  std::vector<std::optional<double>> spacings;  // voxel spacings, mm; an empty entry: the volume's own spacing
  std::vector<DescribedPose> poses;
  std::vector<Technique> techniques;
  QualityLimits gates{.least_voxels = 500};
};

// Reads the description of a study from a JSON file. Throws Error for a wrong value, with its key in the message.
Study read_study(const Path& path);

// Returns the built-in study of elbow flexion: an arm at 2, 3 and 4 mm whose elbow is bent by 0, 45, 60 and 90 degrees
// more than at rest, by the techniques lbs, dqs, fem and fem-contact. Throws Error if the folder lacks the volume or
// the armature.
//   folder  contains man-arm-2mm.mha (or other man-arm-*mm volumes) and its armature; empty: uses the procedural arm
Study paper_study(const Path& folder = {});

// Returns the study as JSON for the file of results. Keys that were left at their defaults are written too.
//   name_of  returns the name by which the text mentions a file; empty: the file's name without its folder
std::string to_json(const Study& study, const std::function<std::string(const Path&)>& name_of = {});

// Returns "2 mm", or "as it is" for the volume's own spacing.
std::string spacing_text(const std::optional<double>& spacing);

}  // namespace limber
