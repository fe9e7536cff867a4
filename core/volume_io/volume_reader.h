// SPDX-License-Identifier: AGPL-3.0-or-later
// Volumes from strangers are parsed in a process of their own, limber_reader, which has no rights (sandbox.h): it can
// open no file, reach no network and start no program. Whatever a file makes of its parser, or of GDCM, ends there.
//
//   program                                    limber_reader
//   finds the files by their names    Order -> enters its sandbox before it reads a byte of them
//   opens a file that belongs to the  <- Open  parses the header, decodes the voxels
//   volume, and sends it open         File ->
//   checks header and sizes again     <- Header, voxels, End or an Error's text
//
// Voxels come through a pipe of 1 MB, so that memory holds the volume once and decoding runs beside the program's own
// work. The program waits at most 20 ms before it asks whether the user has cancelled. It ends a reader that takes
// processor time without delivering anything, or is silent. A reader that crashes, is ended or breaks the rules is one
// Error.
//
// Where the program does not find limber_reader (Limber used as a library in another program) files are parsed in this
// process, and DICOM is refused: GDCM ends its process on some damaged files.
#pragma once

#include <cstddef>

#include "core/base/progress.h"
#include "core/base/sandbox.h"
#include "core/volume_io/voxel_source.h"

namespace limber {

constexpr const char* kReaderName = "limber_reader";

struct ReaderSettings {
  Path program;                                       // limber_reader
  std::size_t memory_bytes = std::size_t{256} << 20;  // at most; more for images of DICOM, by what they promise
  double busy_seconds = 20;                           // of processor time without anything delivered, until it is ended
  double silent_seconds = 120;                        // by the clock, likewise
};

// Starts the reader, and returns when it has delivered the header. `voxels` reads on; it ends the reader when it goes.
//   progress  lives as long as `voxels`
//   throws Error with the reader's own words or what became of it, and Cancelled
OpenedVolume open_in_reader(const VolumeLocation& location, Holding holding, Progress& progress,
                            const ReaderSettings& settings);

// What stands around the reader on this machine: it is started to be asked. Nothing where there is no limber_reader.
Protection reader_protection();

}  // namespace limber
