// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/resample/resample_inputs.h"

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/bones/bone_map.h"
#include "core/pose/pose_io.h"
#include "core/rig_io/rig_io.h"
#include "core/seams/seams_io.h"
#include "core/skin/weights_io.h"
#include "core/volume_io/volume_io.h"
#include "editor/volume/body_seams.h"

namespace limber::editor {

void write_body(const Document& body, const ScratchFolder& folder, Progress& progress) {
  progress.update("write inputs", 0);
  FileType type = body.volume_type ? *body.volume_type : FileType{};
  type.format = "NRRD";
  type.compressed = false;
  write_volume(*body.volume, folder / "volume.nrrd", *body.tissues, type);
  progress.update("write inputs", 0.5);
  write_tissue_table(*body.tissues, folder / "tissues.json");
  write_armature(*body.armature, folder / "rig.json");
  write_weights(*body.weights, *body.volume, TissueVoxels(*body.volume), folder / "weights.nrrd");
  if (body.seams) write_seams(*body.seams, body.volume->grid, folder / "seams.nrrd");
  const BoneMap bone_map = usable_bone_map(seam_source(body));
  if (!bone_map.empty()) write_bone_map(bone_map, folder / "bones.json");
}

void write_job(const Document& body, const Pose& pose, const ResamplingSettings& settings, const PoseFiles& files,
               const ScratchFolder& folder) {
  write_pose(pose, *body.armature, folder / files.pose);
  nlohmann::ordered_json job{{"command", "resample"},     {"volume", "volume.nrrd"},   {"rig", "rig.json"},
                             {"tissues", "tissues.json"}, {"weights", "weights.nrrd"}, {"pose", files.pose},
                             {"method", settings.method}, {"output", files.posed}};
  if (!files.report.empty()) job["report"] = files.report;
  if (!files.overlap.empty()) job["overlap"] = files.overlap;
  if (body.seams) job["seams"] = "seams.nrrd";
  if (!usable_bone_map(seam_source(body)).empty()) job["bone-map"] = "bones.json";
  if (settings.spacing > 0) job["spacing"] = settings.spacing;
  if (settings.bones_apart) job["glide"] = "joint";
  if (settings.mass_exact) job["mass-exact"] = true;
  if (!files.image.empty()) job["with"] = files.image.string() + "=" + files.posed_image.string();
  if (settings.method == kFiniteElements) {
    job["quality"] = settings.quality;
    if (!files.steps.empty()) job["steps"] = files.steps;
    if (settings.contact) job["contact"] = true;
  }
  std::string text;
  try {
    text = job.dump(1);
  } catch (const nlohmann::json::type_error&) {
    throw Error("the image's file name is not valid UTF-8", files.image.string(),
                "rename the file or its folder, or close the image");
  }
  write_file_atomically(folder / files.job, text + "\n");
}

std::shared_ptr<const LabelVolume> read_posed(const Path& path, const TissueTable& tissues, Progress& progress) {
  VolumeFile file = read_volume(path, progress);
  const FileValueIndex ours(tissues);
  std::vector<Label> label_of(65536, 0);
  for (const Tissue& tissue : file.tissues.tissues) {
    const Tissue* known = ours.find(tissue.file_value);
    if (!known)
      throw Error("the posed volume has a label that the volume at rest lacks", std::to_string(tissue.file_value),
                  "please report it");
    label_of[tissue.label] = known->label;
  }
  for (Label& label : file.volume.voxels) label = label_of[label];
  return std::make_shared<const LabelVolume>(std::move(file.volume));
}

}  // namespace limber::editor
