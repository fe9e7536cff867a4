// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes baked joints as files NAME.bake: a line that names the format, then one zlib stream with the members
// of BakedJoint. The shifts of the lattice's nodes are half floats, angle by angle, all x before all y before all z.
// The nodes themselves are stored as runs of consecutive indices.
#pragma once

#include <string>

#include "core/base/file.h"
#include "core/deform/baked_joint.h"

namespace limber {

inline constexpr const char* kBakeEnding = ".bake";

std::string encode(const BakedJoint& joint);
// Throws Error when the bytes are no baked joint, are cut off or contradict each other. Takes memory in proportion to
// the bytes.
//   where  names the file in messages
BakedJoint decode_baked_joint(const std::string& bytes, const std::string& where);

BakedJoint read_baked_joint(const Path& path);  // throws Error as decode_baked_joint() does
void write_baked_joint(const BakedJoint& joint,
                       const Path& path);  // throws Error if the file cannot be written or could not be read again

}  // namespace limber
