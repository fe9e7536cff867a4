// SPDX-License-Identifier: AGPL-3.0-or-later
// A batch poses several bodies in several poses, or frames of motions, by several techniques (ways of posing). Each
// combination of these is a cell, computed by one run of `limber resample`. A batch is described in a JSON file, in
// which paths are relative to the file's folder:
//   {"name"?: "Seated workers",
//    "bodies": [{"name": "man", "volume": "man.nii.gz", "rig": "man.json", "tissues"?: "t.json", "bones"?: [111, 209],
//                "bone_map"?: FILE, "seams"?: FILE|"none", "weights"?: "heat"|"geodesic"|"rigid"|FILE,
//                "spacing_mm"?: 2, "with"?: "ct.nii.gz", "landmarks"?: "points.csv"},
//               {"name": "arm", "phantom": "arm"|"body", "spacing_mm"?: 3}],
//    "poses": [{"name": "seated", "pose_name": "sit"}, {"name": "walk", "motion": "walk.bvh", "frames": "0:60:5"},
//              ... (described_pose.h)],
//    "methods"?: ["dqs", "fem-contact", "lbs-mass-exact", ...],
//    "volumes"?: ["displacement", "jacobian", "overlap"], "format"?: ".nii.gz", "mesh"?: ".vtu",
//    "exports"?: [".stl", {"ending": ".in", "frequency_hz": 9e8, "properties"?: "p.csv"}],
//    "quality"?: "draft"|"normal"|"fine", "glide"?: "voxel", "fit_joints"?: true, "nearest"?: true}
// Without methods the batch is posed by dqs. "volumes" are written beside the posed volume, in "format". "mesh" is the
// ending of the tet mesh of solves by finite elements.
#pragma once

#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/batch/cell_store.h"
#include "core/batch/described_body.h"
#include "core/batch/described_pose.h"
#include "core/batch/technique.h"

namespace limber {

// A file in another format, made of the posed volume of each cell.
struct BatchExport {
  std::string ending;    // file ending that selects the format, as in `limber convert`: ".stl"
  double frequency = 0;  // frequency of the field to simulate, Hz; 0: none
  Path properties;       // table of the tissues' dielectric properties; empty: the program's own
};

struct Batch {
  std::string name;
  Path description;  // the file that the batch was read from
  std::vector<DescribedBody> bodies;
  std::vector<DescribedPose> poses;
  std::vector<Technique> techniques;
  std::vector<BatchExport> exports;
  CellSettings settings;
};

// One cell of a batch, as indices into the batch's lists.
struct BatchCell {
  int body = 0, pose = 0, technique = 0;
};

// Reads the description of a batch from a JSON file. Throws Error for a wrong value, with its key in the message.
Batch read_batch(const Path& path);

// Returns the cells in the order of their numbers: by body, then pose, then technique.
std::vector<BatchCell> cells_of(const Batch& batch);
std::string text_of(const Batch& batch, const BatchCell& cell);  // returns text such as "man, walk 0005, dqs"

}  // namespace limber
