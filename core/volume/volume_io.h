// SPDX-License-Identifier: AGPL-3.0-or-later
// Label and grey volumes from and to files: NRRD (.nrrd .nhdr .seg.nrrd), MetaImage (.mha .mhd), NIfTI-1/2 (.nii .nii.gz
// .hdr+.img), a folder with a DICOM series, Virtual Family RAW + .txt. Behind this door stand ITK and niftilib; before
// they are believed, headers and byte counts are checked here, because ITK 5.2 silently accepts truncated data,
// negative spacing and data files outside the header's folder.
#pragma once

#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/volume/label_volume.h"
#include "core/volume/tissue_table.h"

namespace limber {

// What the file was, so that a result can be written the same way.
struct FileType {
  std::string format;      // "NRRD", "MetaImage", "NIfTI-1", "NIfTI-2", "DICOM", "Virtual Family"
  std::string voxel_type;  // "uint8" ... "int64", "float32", "float64"
  bool compressed = false;
};

struct VolumeFile {
  LabelVolume volume;
  TissueTable tissues;  // one entry per label present, with what the file says of it
  FileType type;
  std::vector<std::string> warnings;  // one line each: whole data despite a wrong header field, no tissue at all
};

// A grey volume (CT, MR): values as float, read for `--with` and `info`.
struct GreyVolume {
  Grid grid;
  std::vector<float> voxels;
  FileType type;
  std::vector<std::string> warnings;
};

// Header and label counts without keeping the voxels; works for grey volumes too.
struct VolumeSummary {
  Grid grid;
  FileType type;
  bool is_label = true;  // false when values are fractional or more than 65 535 distinct
  struct Count {
    double value;
    std::int64_t voxels;
    std::string name;
  };
  std::vector<Count> labels;  // by value, 0 included
  double minimum = 0, maximum = 0;
  std::vector<std::string> warnings;
};

// Throws Error when the file is not a label volume that can be believed (see above), with what, where, what to do.
VolumeFile read_volume(const Path& path, Progress& progress = no_progress());
GreyVolume read_grey_volume(const Path& path, Progress& progress = no_progress());
VolumeSummary summarize_volume(const Path& path);
bool is_volume_path(const Path& path);  // by name, or a folder that holds DICOM

// Throws Error when no volume can be written under this name (unknown extension, missing folder). Commands ask first,
// before they compute.
void check_writable(const Path& path);

// Format by extension; voxels carry the tissues' file values in `type.voxel_type` (widened when they do not fit).
// Names and colours go along where the format can hold them (.seg.nrrd; other NRRD as key/value pairs).
void write_volume(const LabelVolume& volume, const Path& path, const TissueTable& tissues = {}, const FileType& type = {});
void write_grey_volume(const GreyVolume& volume, const Path& path);
// Three floats a voxel, mm, world axes (a displacement field).
void write_vector_volume(const Grid& grid, const std::vector<glm::vec3>& voxels, const Path& path);
void write_scalar_volume(const Grid& grid, const std::vector<float>& voxels, const Path& path);

}  // namespace limber
