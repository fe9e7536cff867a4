// SPDX-License-Identifier: AGPL-3.0-or-later
// Messages between the program and the reader, which is the process that parses a volume (volume_reader.h,
// serve_volume.h). A message is a head of 16 bytes, followed by as many bytes as the head states. Program and reader
// belong to one build on one machine, so numbers are sent as they are in memory. The program checks everything that it
// receives.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/bytes.h"
#include "core/platform/sandbox.h"
#include "core/volume_io/volume_header.h"
#include "core/volume_io/volume_location.h"
#include "core/volume_io/voxel_source.h"

namespace limber {

enum class Message : std::uint32_t {
  // Messages from the program to the reader: first Order, which says what to read, then an answer to each question. An
  // Opened message comes with the descriptor of the opened file.
  Order,
  Done,     // answers CheckData; contains nothing
  Opened,   // answers OpenHeader and OpenData; contains the file's size, 64 bits
  Present,  // answers HasData; contains 0 or 1
  Refused,  // answers any question; contains an Error's text
  // Messages from the reader to the program: first Hello, then Header, then as many voxels as the header promises, then
  // End.
  Hello,  // contains kMessageVersion and the Protection in force
  Header,
  Voxels,  // contains the next voxels: their number of bytes, 64 bits, then the packed bytes (sparse_bytes.h)
  // Contains FileBytes: the range of the next voxels in the file of the last Opened message. The program reads them.
  PlainVoxels,
  End,     // last message; contains the reader's warnings
  Failed,  // contains an Error's text
  OutOfMemory,
  // Questions from the reader to the program; see VolumeFiles.
  OpenHeader,  // contains the index of the header file, 64 bits
  CheckData,   // contains names of data files
  OpenData,    // contains the name of a data file
  HasData,     // contains the name of a data file
};

struct MessageHead {
  Message kind;
  std::uint32_t unused = 0;
  std::uint64_t size = 0;  // number of bytes that follow the head
};

// Version of the message format. Every change of the format needs a new version.
constexpr std::uint32_t kMessageVersion = 3;

struct Order {
  VolumeLocation location;
  Holding holding = Holding::Volume;
};

std::string bytes_of(const Order& order);
std::string bytes_of(const Protection& protection);
std::string bytes_of(const VolumeHeader& header);
std::string bytes_of(const std::vector<std::string>& texts);

// Each function decodes a message. A function calls `damaged`, which must throw, for bytes that no reader of this build
// would send. A header must pass the same checks as in a parser, and a protection must come with kMessageVersion.
Order order_from(std::string_view bytes, const std::function<void()>& damaged);
Protection protection_from(std::string_view bytes, const std::function<void()>& damaged);
VolumeHeader header_from(std::string_view bytes, const std::string& where, const std::function<void()>& damaged);
std::vector<std::string> texts_from(std::string_view bytes, const std::function<void()>& damaged);

}  // namespace limber
