// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes and reads a clip's strips as bytes, which follow the clip's other bytes. A strip refers to its clip by an
// index.
#pragma once

#include <memory>
#include <vector>

#include "core/base/bytes.h"
#include "core/motion/strips.h"

namespace limber {

// Writes strips.
//   clips  the clips of the strips, as clips_of() returns them
void put_strips(ByteWriter& out, const Strips& strips, const std::vector<std::shared_ptr<const Clip>>& clips);
// Reads what put_strips() has written. Each of the clips must belong to a strip, and have no strips of its own.
Strips get_strips(ByteReader& in, const std::vector<std::shared_ptr<const Clip>>& clips);

}  // namespace limber
