// SPDX-License-Identifier: AGPL-3.0-or-later
// Headers of NIfTI-1 and NIfTI-2 files (.nii, .hdr + .img, gzipped or not), both byte orders. The sform leads, then the
// qform, then the voxel sizes alone (method 1); world is turned from NIfTI's RAS to LPS, mm. A singular sform beside a
// qform is passed over with a warning. [NIfTI-1: Cox et al. 2004; NIfTI-2: 2011]
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/volume_io/volume_header.h"

namespace limber {

constexpr std::size_t kNiftiHeaderBytes = 540;  // of the longer version

bool looks_like_nifti_header(std::string_view bytes);

//   bytes       the (inflated) file's first bytes, kNiftiHeaderBytes if there are as many
//   file_bytes  size of a single file that is not compressed: tells a wrong vox_offset from missing data
//   where       the file, for messages
// The data of a header/image pair are not yet named, see `is_pair`. Throws Error for anything but one scalar 3-D
// volume.
struct NiftiHeader {
  VolumeHeader volume;
  bool is_pair = false;
};
NiftiHeader parse_nifti_header(std::string_view bytes, std::optional<std::int64_t> file_bytes,
                               const std::string& where);

// Header bytes, little endian, up to where the data of a single file begin (352 or 544 bytes).
std::string make_nifti_header(const Grid& grid, VoxelType type, int channels, int version, bool is_pair);

}  // namespace limber
