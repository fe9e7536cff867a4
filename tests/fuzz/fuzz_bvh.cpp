// SPDX-License-Identifier: AGPL-3.0-or-later
// Fuzzes the BVH reader: a text is refused with Error, or it is read, posed, written, and read again unchanged.
#include <cstdlib>
#include <string>

#include "core/base/error.h"
#include "core/motion/bvh.h"
#include "core/motion/retarget.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* bytes, std::size_t size) {
  using namespace limber;
  try {
    const Motion motion = parse_bvh(std::string(reinterpret_cast<const char*>(bytes), size), "fuzz");
    forward_kinematics(motion, motion.frame_count - 1);
    const Motion again = parse_bvh(bvh_text(motion), "written");
    if (again.joints.size() != motion.joints.size() || again.values != motion.values) std::abort();
    const Armature rig = armature_of(motion);
    if (motion.frame_count > 0) Retarget(motion, rig, match_by_names(motion, rig)).at(0);
  } catch (const Error&) {
  }
  return 0;
}
