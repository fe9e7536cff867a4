// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/files/file_filters.h"

#include "core/volume_io/volume_format.h"

namespace limber::editor {

FileFilter volume_files() {
  FileFilter filter{"Volumes", {}};
  for (const VolumeFormat& format : volume_formats())
    filter.ends.insert(filter.ends.end(), format.endings.begin(), format.endings.end());
  return filter;
}

std::vector<FileFilter> writable_volumes() {
  std::vector<FileFilter> filters;
  for (const VolumeFormat& format : volume_formats()) {
    FileFilter filter{format.name, {}};
    for (const VolumeFormat::Written& written : format.written)
      if (written.is_offered) filter.ends.push_back(written.ending);
    if (!filter.ends.empty()) filters.push_back(std::move(filter));
  }
  return filters;
}

FileFilter readable_files() {
  FileFilter filter{"All supported files", {".limber"}};
  const std::vector<std::string> volumes = volume_files().ends;
  filter.ends.insert(filter.ends.end(), volumes.begin(), volumes.end());
  for (const char* ending : {".bvh", ".json", ".vtk", ".arm", ".gltf", ".glb", ".ctbl"}) filter.ends.push_back(ending);
  return filter;
}

}  // namespace limber::editor
