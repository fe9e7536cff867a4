// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes and reads the shapes of a clip's keys as bytes, which follow the clip's keys and markers.
#pragma once

#include "core/base/bytes.h"
#include "core/motion/keyframes.h"

namespace limber {

void put_shapes(ByteWriter& out, const Keys& keys);
// Reads what put_shapes() has written. Leaves out the shapes of keys that do not exist.
void get_shapes(ByteReader& in, Keys& keys);

}  // namespace limber
