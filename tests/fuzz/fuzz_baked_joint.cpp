// SPDX-License-Identifier: AGPL-3.0-or-later
// Fuzzes the reader of baked joints: a file is read into shifts of nodes that lie in their box, and writing these gives
// the same joint again; or it is refused with Error. If the first byte is even, the other bytes are the file; if it is
// odd, they are the file's content before it is compressed.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/bake/baked_joint_io.h"
#include "core/base/deflate.h"
#include "core/base/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace limber;
  if (size == 0) return 0;
  std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] % 2 == 1) {
    std::string file = "limber baked joint 1\n";
    Deflater deflater(Deflater::Wrap::Zlib,
                      [&](const void* more, std::size_t count) { file.append(static_cast<const char*>(more), count); });
    deflater.write(bytes.data(), bytes.size());
    deflater.end();
    bytes = std::move(file);
  }
  try {
    const BakedJoint joint = decode_baked_joint(bytes, "fuzz");
    const std::int64_t places = std::int64_t{joint.size.x} * joint.size.y * joint.size.z;
    for (const std::int32_t node : joint.nodes)
      if (node < 0 || node >= places) std::abort();
    for (const auto& shifts : joint.shifts)
      for (const glm::vec3& shift : shifts)
        if (!std::isfinite(shift.x + shift.y + shift.z)) std::abort();
    if (!(decode_baked_joint(encode(joint), "again") == joint)) std::abort();
  } catch (const Error&) {
  }
  return 0;
}
