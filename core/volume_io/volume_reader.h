// SPDX-License-Identifier: AGPL-3.0-or-later
// Parses volumes in a separate process, limber_reader, because volumes may come from strangers. That process has no
// rights (sandbox.h): it cannot open files, use the network or start programs. So a malicious file can harm only that
// process, even through an error in a parser or in GDCM.
//
//   program                                    limber_reader
//   finds the files by their names    Order -> enters its sandbox before it reads a byte of them
//   opens a file that belongs to the  <- Open  parses the header, decodes the voxels
//   volume, and sends it open         File ->
//   checks header and sizes again     <- Header, voxels, End or an Error's text
//
// If voxels are stored without an encoding, the reader only says where they are in the file that it received last. The
// program checks that the file has these bytes, and reads them itself.
//
// Other voxels come through a pipe of 1 MB, so that the volume is in memory only once and decoding runs in parallel
// with the program's own work. The program checks at least every 20 ms whether the user has cancelled. It kills a
// reader that sends nothing for too long (see ReaderSettings). When a reader crashes, is killed or breaks the protocol,
// the program throws one Error.
//
// When the program does not find limber_reader (Limber used as a library in another program), files are parsed in this
// process, and DICOM is refused, because GDCM ends its process on some damaged files.
#pragma once

#include <cstddef>

#include "core/base/progress.h"
#include "core/platform/sandbox.h"
#include "core/volume_io/voxel_source.h"

namespace limber {

constexpr const char* kReaderName = "limber_reader";

struct ReaderSettings {
  Path program;                                       // path of limber_reader
  std::size_t memory_bytes = std::size_t{256} << 20;  // memory limit; it grows with the stated size of DICOM images
  double busy_seconds = 20;     // the reader is killed after this processor time without sending data
  double silent_seconds = 120;  // the reader is killed after this elapsed time without sending data
};

// Starts a reader process and returns when it has sent the volume's header. The result's member `voxels` receives the
// voxels; its destructor ends the reader.
//   progress  must live as long as `voxels`
//   throws Cancelled, and an Error that says what is wrong with the file or how the reader ended
OpenedVolume open_in_reader(const VolumeLocation& location, Holding holding, Progress& progress,
                            const ReaderSettings& settings);

// Starts a reader process and returns which sandbox protections are in force for it on this machine. Returns no
// protections when limber_reader is missing.
Protection reader_protection();

}  // namespace limber
