// SPDX-License-Identifier: AGPL-3.0-or-later
// What the program and the process that parses a volume say to each other (volume_reader.h, serve_volume.h): heads of
// 16 bytes, each with as many bytes behind it as it says. Both are of one build and one machine, so numbers are sent as
// they lie in memory. The program believes nothing of what it gets.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/bytes.h"
#include "core/base/sandbox.h"
#include "core/volume_io/volume_header.h"
#include "core/volume_io/volume_location.h"
#include "core/volume_io/voxel_source.h"

namespace limber {

enum class Message : std::uint32_t {
  // To the reader: what to read; then an answer to each question. A file travels with the head of its Opened.
  Order,
  Done,     // to CheckData
  Opened,   // to OpenHeader and OpenData: size, 64 bits
  Present,  // to HasData: 0 or 1
  Refused,  // to any: an Error's text
  // From the reader. First Hello, then Header, then voxels, as many as it promises, then End.
  Hello,  // version, protection
  Header,
  Voxels,  // bytes in storage order
  End,     // warnings
  Failed,  // an Error's text
  OutOfMemory,
  // Questions of the reader.
  OpenHeader,  // index, 64 bits
  CheckData,   // names
  OpenData,    // a name
  HasData,     // a name
};

struct MessageHead {
  Message kind;
  std::uint32_t unused = 0;
  std::uint64_t size = 0;  // of what follows
};

// Raised with every change of what is said.
constexpr std::uint32_t kMessageVersion = 1;

struct Order {
  VolumeLocation location;
  Holding holding = Holding::Volume;
};

std::string bytes_of(const Order& order);
std::string bytes_of(const Protection& protection);
std::string bytes_of(const VolumeHeader& header);
std::string bytes_of(const std::vector<std::string>& texts);

// `damaged` must throw; it is called for what no reader of ours says. A header has passed the checks that every parsed
// header passes; a protection is one of this version.
Order order_from(std::string_view bytes, const std::function<void()>& damaged);
Protection protection_from(std::string_view bytes, const std::function<void()>& damaged);
VolumeHeader header_from(std::string_view bytes, const std::string& where, const std::function<void()>& damaged);
std::vector<std::string> texts_from(std::string_view bytes, const std::function<void()>& damaged);

}  // namespace limber
