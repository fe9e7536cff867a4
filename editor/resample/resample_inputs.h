// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the files from which a worker process resamples a pose of the document's body, and reads the posed volume that
// the worker writes. All files lie in one temporary folder.
#pragma once

#include <memory>
#include <string>

#include "core/base/progress.h"
#include "core/project/document.h"
#include "editor/context/resampling_settings.h"
#include "editor/file_browser/temp_folder.h"

namespace limber::editor {

// Writes the body without its pose: volume, tissues, rig, weights, seams and bone map.
void write_body(const Document& body, const ScratchFolder& folder, Progress& progress);

// The names of the files that belong to one pose. The worker does not write files whose names are empty.
struct PoseFiles {
  std::string job = "job.json", pose = "pose.json", posed = "posed.nrrd", overlap = "overlap.nrrd", report;
  std::string steps;        // base name of the files that the FEM solver writes after each of its steps
  Path image, posed_image;  // a grey image to pose with the body, and its posed image; empty: there is none
};
// Writes the pose and the job that resamples the body of write_body() in this pose. Throws Error if the file name of
// the image is not valid UTF-8.
void write_job(const Document& body, const Pose& pose, const ResamplingSettings& settings, const PoseFiles& files,
               const ScratchFolder& folder);
// Reads the posed volume and converts the values in the file to the document's labels.
std::shared_ptr<const LabelVolume> read_posed(const Path& path, const TissueTable& tissues, Progress& progress);

}  // namespace limber::editor
