// SPDX-License-Identifier: AGPL-3.0-or-later
// Parses headers of NIfTI-1 and NIfTI-2 files (.nii, .hdr + .img, gzipped or not) in both byte orders. The grid comes
// from the sform, else from the qform, else from the voxel sizes alone (method 1). World coordinates are converted from
// NIfTI's RAS to LPS, mm. A singular sform is ignored with a warning when there is a qform. [NIfTI-1: Cox et al. 2004;
// NIfTI-2: 2011]
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/volume_io/volume_header.h"

namespace limber {

constexpr std::size_t kNiftiHeaderBytes = 540;  // size of a NIfTI-2 header, bytes; a NIfTI-1 header is smaller

bool looks_like_nifti_header(std::string_view bytes);

// Parses a header. When the voxels are in a file of their own (`is_pair`), the caller sets that file's name. Throws
// Error unless the header describes one scalar 3-D volume.
//   bytes       the first kNiftiHeaderBytes bytes of the (decompressed) file, fewer when the file is shorter
//   file_bytes  the size of an uncompressed file with header and voxels; empty for any other file. With it, the parser
//               can tell a wrong vox_offset from missing data
//   where       the file, for messages
struct NiftiHeader {
  VolumeHeader volume;
  bool is_pair = false;
};
NiftiHeader parse_nifti_header(std::string_view bytes, std::optional<std::int64_t> file_bytes,
                               const std::string& where);

// Returns the header's bytes, little-endian. For a single file, they include the padding before the voxels, which begin
// at byte 352 in version 1 and at byte 544 in version 2.
std::string make_nifti_header(const Grid& grid, VoxelType type, int channels, int version, bool is_pair);

}  // namespace limber
