// SPDX-License-Identifier: AGPL-3.0-or-later
// DICOM images: a folder with one series, or a single file, plain or compressed (JPEG, JPEG 2000, RLE). Slices are
// ordered along their normal and must be evenly spaced. The pixels are decoded by GDCM, the DICOM library that ITK
// itself wraps, behind dicom_codec. GDCM ends the process on some damaged files: open_volume() has it work in a process
// apart.
#pragma once

#include "core/volume_io/voxel_source.h"

namespace limber {

// By content: the mark "DICM" after 128 bytes. False for what cannot be opened.
bool is_dicom_file(const Path& path);
// True when the folder holds at least one DICOM file.
bool is_dicom_folder(const Path& path);
// The folder's DICOM files in order of their names. Throws Error where there is none.
std::vector<Path> dicom_files(const Path& folder);

// Loads GDCM, which a process that may not open files must do before it enters its sandbox. False where it is missing.
bool load_dicom_library();

// Throws Error for several series of the same rank, missing or unevenly spaced slices, colours, more than one frame.
OpenedVolume open_dicom(std::shared_ptr<VolumeFiles> files);

}  // namespace limber
