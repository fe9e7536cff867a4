// SPDX-License-Identifier: AGPL-3.0-or-later
// The formats of volume files, as one table: who reads or writes a volume, filters a list of files or tells what can be
// read looks here. A new format is one source that makes its row, and that row's line in volume_format.cpp.
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
  std::string name;                  // "NRRD"; what FileType::format begins with
  std::vector<std::string> endings;  // of names that are taken for it, headers first: ".nhdr"

  // Whether a file is of this format, by its name in lower case or its first bytes. Null: never by itself.
  bool (*fits)(std::string_view name, std::string_view first_bytes) = nullptr;
  // Reads and checks the header of `file`, whose first bytes are at hand. Throws Error.
  VolumeHeader (*read_header)(VolumeFiles& files, const PlainFile& file, const std::string& first_bytes) = nullptr;
  // Opens the voxels that such a header promises. Null: as bytes of one of the encodings that VoxelStream knows.
  std::unique_ptr<VoxelSource> (*open_voxels)(const std::shared_ptr<VolumeFiles>& files,
                                              const VolumeHeader& header) = nullptr;

  // A name that can be written.
  struct Written {
    std::string ending;
    void (*write)(const Voxels& voxels, const Path& path);
    std::vector<std::string> beside = {};  // endings of the data files that may come with it
    bool is_offered = true;                // by file dialogs
  };
  std::vector<Written> written = {};
};

// In the order in which a file's content is looked at.
std::span<const VolumeFormat> volume_formats();

// How a volume of this name is written; null where it cannot be.
const VolumeFormat::Written* how_written(const Path& path);
// The name of the format that a volume of this name is written in; "" for none.
std::string format_written_as(const Path& path);
// ".nrrd, .nhdr, .mha": every ending that can be written.
std::string writable_endings();
// "NRRD, MetaImage, ...": every format that can be read.
std::string readable_formats();

}  // namespace limber
