// SPDX-License-Identifier: AGPL-3.0-or-later
// What the operators of files have in common.
#pragma once

#include "editor/directory.h"
#include "editor/editor.h"

namespace limber::editor {

inline constexpr int kRecentOperators = 10;
// "file.recent_1" and on: one operator for each of the latest files.
void name_recent_operators(Editor& editor);

inline FileFilter volume_files() { return {"Volumes", {".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz", ".hdr", ".img", ".img.gz", ".dcm", ".raw"}}; }
inline std::vector<FileFilter> writable_volumes() { return {{"NRRD", {".nrrd", ".nhdr"}}, {"MetaImage", {".mha", ".mhd"}}, {"NIfTI", {".nii.gz", ".nii"}}}; }
inline FileFilter readable_files() {
  return {"All that can be opened",
          {".limber", ".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz", ".hdr", ".img", ".img.gz", ".dcm", ".raw", ".bvh", ".json", ".vtk", ".arm", ".gltf", ".glb", ".ctbl"}};
}

}  // namespace limber::editor
