// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/files/file_kind.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <system_error>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/project/project_io.h"
#include "core/tissue/tissue_table.h"
#include "core/volume_io/dicom.h"
#include "core/volume_io/volume_io.h"

namespace limber::editor {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kLargestJson = 64 << 20;  // a larger JSON file of a rig or pose is an error, bytes

FileKind kind_of_json(const Path& path) {
  if (is_tissue_table(path)) return FileKind::Tissues;
  const auto json = nlohmann::json::parse(checked_json(read_file(path, kLargestJson), path.string()), nullptr, false);
  if (json.is_object() && json.contains("bones")) return json["bones"].is_array() ? FileKind::Rig : FileKind::Pose;
  throw Error("this JSON file is neither a rig, a pose nor a tissue table", path.string(), "select another file");
}

}  // namespace

std::string extension_of(const Path& path) {
  std::string end = path.extension().string();
  std::transform(end.begin(), end.end(), end.begin(), [](unsigned char c) { return std::tolower(c); });
  return end;
}

FileKind kind_of(const Path& path) {
  std::error_code error;
  if (!fs::exists(path, error))
    throw Error("there is no such file", path.string(), "it may have been moved or deleted");
  if (fs::is_directory(path, error)) {
    if (is_dicom_folder(path)) return FileKind::Volume;
    throw Error("this folder holds no DICOM images", path.string(),
                "select the folder that contains the images themselves");
  }
  if (is_project(path)) return FileKind::Project;
  const std::string end = extension_of(path);
  if (end == ".limber")
    throw Error("this is not a Limber project, or its beginning is damaged", path.string(), "select another file");
  if (end == ".json") return kind_of_json(path);
  if (end == ".bvh") return FileKind::Motion;
  if (end == ".vtk" || end == ".arm" || end == ".gltf" || end == ".glb") return FileKind::Rig;
  if (is_weights_path(path)) return FileKind::Weights;
  if (is_volume_path(path)) return FileKind::Volume;
  // A file of an unknown kind is passed to the volume reader, whose error message says what is wrong with the file.
  return is_tissue_table(path) ? FileKind::Tissues : FileKind::Volume;
}

}  // namespace limber::editor
