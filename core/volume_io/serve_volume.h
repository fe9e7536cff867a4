// SPDX-License-Identifier: AGPL-3.0-or-later
// Implements limber_reader (volume_reader.h): parses one volume in a sandbox for the program that started it.
#pragma once

#include <functional>
#include <memory>

#include "core/volume_io/voxel_source.h"

namespace limber {

using OpenFromFiles = std::function<OpenedVolume(std::shared_ptr<VolumeFiles>, Holding)>;

// Runs limber_reader and returns its exit code. The arguments are the process ID of the program that started it, its
// memory limit in bytes and, for DICOM images, "dicom". It receives messages on the standard input and sends messages
// on the standard output (reader_messages.h).
//   open  parses the header and returns the source of the voxels; runs in the sandbox
int serve_volume(int argc, char** argv, const OpenFromFiles& open = open_volume_here);

}  // namespace limber
