// SPDX-License-Identifier: AGPL-3.0-or-later
// The table of volume file formats. It is used to read and write volumes, to filter lists of files and to name the
// formats that can be read. A new format needs one source file with its table entry, and a line in volume_format.cpp.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/volume_io/voxel_source.h"
#include "core/volume_io/voxel_writer.h"

namespace limber {

struct VolumeFormat {
  std::string name;                  // for example "NRRD"; FileType::format begins with this name
  std::vector<std::string> endings;  // file name endings of this format, headers first: ".nhdr"

  // Returns true if a file has this format, judging by its lower-case name and its first bytes. Null for DICOM, which
  // is recognized elsewhere.
  bool (*fits)(std::string_view name, std::string_view first_bytes) = nullptr;
  // Reads and checks the header of `file`, whose first bytes are given. Throws Error when the header is not valid.
  VolumeHeader (*read_header)(VolumeFiles& files, const PlainFile& file, const std::string& first_bytes) = nullptr;
  // Opens the voxels of a file with this header. Null: VoxelStream reads them.
  std::unique_ptr<VoxelSource> (*open_voxels)(const std::shared_ptr<VolumeFiles>& files,
                                              const VolumeHeader& header) = nullptr;

  // A file name ending under which a volume can be written in this format.
  struct Written {
    std::string ending;
    void (*write)(const Voxels& voxels, const Path& path);
    std::vector<std::string> beside = {};  // endings of the data files that may be written beside it
    bool is_offered = true;                // true: file dialogs offer this ending
  };
  std::vector<Written> written = {};
};

// Returns all formats, in the order in which a file is tested for them.
std::span<const VolumeFormat> volume_formats();

// Returns the table entry for writing a volume to `path`, found by the ending of its name. Returns null when no format
// has that ending.
const VolumeFormat::Written* how_written(const Path& path);
// Returns the name of the format in which a volume is written to `path`, or "" when no format has the ending of `path`.
std::string format_written_as(const Path& path);
// Returns all file name endings under which volumes can be written, as text: ".nrrd, .nhdr, .mha".
std::string writable_endings();
// Returns the names of the formats that can be read, as text: "NRRD, MetaImage, ...".
std::string readable_formats();

}  // namespace limber
