// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes and reads a clip's constraints and the keys of their weights as bytes, which follow the clip's other bytes.
#pragma once

#include "core/base/bytes.h"
#include "core/motion/clip.h"

namespace limber {

// Returns whether the clip has anything that put_constraints() would write.
bool has_constraints(const Clip& clip);
void put_constraints(ByteWriter& out, const Clip& clip);
// Reads what put_constraints() has written. Leaves out keys of constraints that do not exist.
void get_constraints(ByteReader& in, Clip& clip);

}  // namespace limber
