// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads DICOM images: a folder with one series, or a single file, plain or compressed (JPEG, JPEG 2000, RLE). Slices
// are sorted along their normal and must be evenly spaced. GDCM, the DICOM library that ITK also uses, decodes the
// pixels (dicom_codec.h). GDCM ends the process on some damaged files, so open_volume() runs it in a separate process.
#pragma once

#include "core/volume_io/voxel_source.h"

namespace limber {

// Returns true if the file is DICOM: the letters "DICM" follow its first 128 bytes. Returns false for a file that
// cannot be opened.
bool is_dicom_file(const Path& path);
// Returns true if the folder contains at least one DICOM file.
bool is_dicom_folder(const Path& path);
// Returns the folder's DICOM files sorted by name. Throws Error when there are none.
std::vector<Path> dicom_files(const Path& folder);

// Loads the library GDCM. Returns false when GDCM is missing. A process must call this before it enters its sandbox,
// because it cannot open the library there.
bool load_dicom_library();

// Opens a series or a single image. Throws Error for several series, for missing or unevenly spaced slices, for colour
// images and for files with several frames.
OpenedVolume open_dicom(std::shared_ptr<VolumeFiles> files);

}  // namespace limber
