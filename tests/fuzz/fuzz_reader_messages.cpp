// SPDX-License-Identifier: AGPL-3.0-or-later
// Fuzzes the messages between the program and limber_reader, which a malicious file may control: a message is refused,
// or it is read as a value that is sent again in the same bytes. The first byte says which message:
//   O  an order     P  a protection     H  a header     T  texts
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/base/error.h"
#include "core/volume_io/reader_messages.h"

namespace {

using namespace limber;

void require(bool holds) {
  if (!holds) std::abort();
}

[[noreturn]] void refuse() { throw Error("damaged", "f", "send another"); }

void check(const VolumeHeader& header) {
  const Grid& grid = header.grid;
  for (int axis = 0; axis < 3; ++axis)
    require(grid.size[axis] > 0 && grid.spacing[axis] > 0 && std::isfinite(grid.spacing[axis]) &&
            std::isfinite(grid.origin[axis]));
  require(std::abs(glm::determinant(grid.direction)) > 0);
  require(header.slope != 0 && std::isfinite(header.slope) && std::isfinite(header.intercept));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    switch (data[0]) {
      case 'O': require(bytes_of(order_from(bytes, refuse)) == bytes); break;
      case 'P': require(bytes_of(protection_from(bytes, refuse)) == bytes); break;
      case 'T': require(bytes_of(texts_from(bytes, refuse)) == bytes); break;
      case 'H': {
        const VolumeHeader header = header_from(bytes, "f", refuse);
        check(header);
        // A message may have keys twice and in any order. The program sends each key once, sorted.
        const std::string sent = bytes_of(header);
        require(bytes_of(header_from(sent, "f", refuse)) == sent);
        break;
      }
    }
  } catch (const Error&) {
  }
  return 0;
}
