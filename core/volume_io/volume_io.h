// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes label and grey volumes: NRRD (.nrrd .nhdr .seg.nrrd; raw, gzip, bzip2, ascii, hex), MetaImage (.mha
// .mhd), NIfTI-1 and -2 (.nii .nii.gz, .hdr + .img), VTK image data (.vti), DICOM (a folder with one series, or one
// image; read only) and Virtual Family (.raw + .txt).
//
// Only complete files are accepted. Limber's own parsers read the header (nrrd, metaimage, nifti, vti, virtual_family),
// because the libraries that were tried silently accept truncated data, negative spacing and data files outside the
// header's folder. Voxels are decompressed and converted to labels chunk by chunk, so that one pass checks the data and
// a volume is in memory only once. Only DICOM is read by a library, GDCM. A file is refused with a one-line Error for
// missing bytes, damaged compression, impossible spacing or direction, more than one volume, colours, or a size that
// does not fit in memory. A file with a wrong header field but complete data is read with a warning.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

// Format and voxel type of the file that was read, so that a result can be written in the same way.
struct FileType {
  // Name of the format: "NRRD", "MetaImage", "NIfTI-1", "NIfTI-2", "VTK image", "DICOM", "Virtual Family".
  std::string format;
  std::string voxel_type;  // type of the voxels: "uint8" ... "int64", "float32", "float64"
  bool compressed = false;
};

struct VolumeFile {
  LabelVolume volume;
  TissueTable tissues;  // one entry for each label of the volume, with what the file states about it
  FileType type;
  // Warnings: one line for each wrong header field in a file whose data are complete, and one for a volume without
  // tissue.
  std::vector<std::string> warnings;
};

// A grey volume (CT, MR) with float values. The commands `resample --with` and `info` read it.
struct GreyVolume {
  Grid grid;
  std::vector<float> voxels;
  FileType type;
  std::vector<std::string> warnings;
};

// The facts that the command `info` shows about a label or grey volume: header, value range and label counts, without
// the voxels.
struct VolumeSummary {
  Grid grid;
  FileType type;
  bool is_label = true;     // false: a value is not a whole number, or there are more than 65 535 labels
  bool looks_grey = false;  // true: not labels, or most neighbouring voxels differ, as in a grey image
  struct Count {
    double value;
    std::int64_t voxels;
    std::string name;
  };
  std::vector<Count> labels;  // number of voxels of each value, sorted by value, 0 included
  double minimum = 0, maximum = 0;
  std::vector<std::string> warnings;
};

// Reads a label volume. Throws Error when the file is not a complete label volume; the comment at the top of this file
// lists the reasons.
VolumeFile read_volume(const Path& path, Progress& progress = no_progress());
GreyVolume read_grey_volume(const Path& path, Progress& progress = no_progress());
VolumeSummary summarize_volume(const Path& path);
bool is_volume_path(const Path& path);  // true for a volume's file name and for a folder with DICOM

// Returns true if the file contains skin weights. Weights are also stored in NRRD files (skin/weights_io); the key
// `limber_bones` distinguishes them from volumes.
bool is_weights_path(const Path& path);
struct WeightsSummary {
  std::string bones;  // names of the bones, as JSON
  std::int64_t voxels = 0;
};
WeightsSummary summarize_weights(const Path& path);

// Returns one tissue for each label except air. `values` lists the labels of a volume with their values in files.
// `named` holds what is known about such values, as a file's header states it.
TissueTable tissues_of_values(const std::vector<std::pair<Label, double>>& values, const TissueTable& named);

// Throws Error when no volume can be written to `path`: no format has its extension, or its folder is missing. Commands
// call this first, so that no computed result is lost.
void check_writable(const Path& path);

// Writes a label volume in the format of the path's extension. The file contains the tissues' original file values.
// Their type is `type.voxel_type`, or a wider type when a value does not fit. Names and colours are written where the
// format can store them (as segments in .seg.nrrd, as key/value pairs in other NRRD files).
void write_volume(const LabelVolume& volume, const Path& path, const TissueTable& tissues = {},
                  const FileType& type = {});
void write_grey_volume(const GreyVolume& volume, const Path& path);
// Writes a displacement field: three floats per voxel, mm, world axes.
void write_vector_volume(const Grid& grid, std::span<const glm::vec3> voxels, const Path& path);
void write_scalar_volume(const Grid& grid, std::span<const float> voxels, const Path& path);

}  // namespace limber
