// SPDX-License-Identifier: AGPL-3.0-or-later
// What limber_reader does (volume_reader.h): parses one volume for the program that started it, in a sandbox.
#pragma once

#include <functional>
#include <memory>

#include "core/volume_io/voxel_source.h"

namespace limber {

using OpenFromFiles = std::function<OpenedVolume(std::shared_ptr<VolumeFiles>, Holding)>;

// Its `main`: arguments are the program's process, the memory it may take (bytes) and, for images of DICOM, "dicom".
// Takes its order from the standard input and answers on the standard output. Returns the exit code.
//   open  parses the header, and what it returns delivers the voxels; runs in the sandbox
int serve_volume(int argc, char** argv, const OpenFromFiles& open = open_volume_here);

}  // namespace limber
