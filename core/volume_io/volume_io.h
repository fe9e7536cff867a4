// SPDX-License-Identifier: AGPL-3.0-or-later
// Label and grey volumes from and to files: NRRD (.nrrd .nhdr .seg.nrrd; raw, gzip, bzip2, ascii, hex), MetaImage (.mha
// .mhd), NIfTI-1 and -2 (.nii .nii.gz, .hdr + .img), DICOM (a folder with one series, or one image; read only) and
// Virtual Family (.raw + .txt).
//
// A file is believed only where it is whole: the header is read by parsers of our own (nrrd_header, meta_header,
// nifti_header, virtual_family; the libraries that were tried accept truncated data, negative spacing and data files
// outside the header's folder without a word), and the voxels are inflated straight into the labels, so that
// counting the bytes costs no second pass and a volume is held in memory once. Only DICOM goes through a library, GDCM.
// Refused with one line: missing bytes, damaged compression, spacing or direction that cannot be, more than one volume,
// colours, what does not fit in memory. Read with a warning: data that are whole despite a wrong header field.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

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
  bool is_label = true;     // false when values are fractional or more than 65 535 distinct
  bool looks_grey = false;  // not a label volume, or one whose neighbouring voxels mostly differ, as in an image
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

// Weights are kept in NRRD files too (see skin/weights_io): what tells them from volumes is their `limber_bones`.
bool is_weights_path(const Path& path);
struct WeightsSummary {
  std::string bones;  // names, as JSON
  std::int64_t voxels = 0;
};
WeightsSummary summarize_weights(const Path& path);

// Throws Error when no volume can be written under this name (unknown extension, missing folder). Commands ask first,
// before they compute.
void check_writable(const Path& path);

// Format by extension; voxels carry the tissues' file values in `type.voxel_type` (widened when they do not fit).
// Names and colours go along where the format can hold them (.seg.nrrd; other NRRD as key/value pairs).
void write_volume(const LabelVolume& volume, const Path& path, const TissueTable& tissues = {},
                  const FileType& type = {});
void write_grey_volume(const GreyVolume& volume, const Path& path);
// Three floats a voxel, mm, world axes (a displacement field).
void write_vector_volume(const Grid& grid, std::span<const glm::vec3> voxels, const Path& path);
void write_scalar_volume(const Grid& grid, std::span<const float> voxels, const Path& path);

}  // namespace limber
