// SPDX-License-Identifier: AGPL-3.0-or-later
// Fuzzes the readers of the program's JSON files: poses, rigs, maps of motions to rigs, and bone maps. The first byte
// selects one of the readers.
#include <string>

#include "core/base/error.h"
#include "core/bones/bone_identity.h"
#include "core/motion/retarget.h"
#include "core/pose/pose_io.h"
#include "core/rig_io/rig_io.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* bytes, std::size_t size) {
  using namespace limber;
  static const Armature rig{{{"upper", -1, {0, 0, 0}, {0, 0, 10}},
                             {"lower", 0, {0, 0, 10}, {0, 3, 20}},
                             {"LeftThigh", 0, {3, 0, 0}, {3, 0, -10}},
                             {"LeftShank", 2, {3, 0, -10}, {3, 1, -20}}}};
  static const Motion motion =
      parse_bvh("HIERARCHY ROOT base { OFFSET 0 0 0 CHANNELS 0 JOINT tip { OFFSET 0 1 0 CHANNELS 0 } }", "motion");
  static const TissueTable bones = [] {
    TissueTable table;
    table.tissues.resize(1);
    table.tissues[0].label = 1;
    table.tissues[0].kind = TissueKind::Bone;
    table.tissues[0].name = "femur";
    return table;
  }();
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(bytes) + 1, size - 1);
  try {
    switch (bytes[0] % 4) {
      case 0: posed_from_rest(rig, parse_pose(text, "fuzz", rig)); break;
      case 1: parse_armature_json(text, "fuzz"); break;
      case 2: parse_retarget_map(text, "fuzz", motion, rig); break;
      case 3: bones_of_labels(bones, rig, parse_bone_map(text, "fuzz")); break;
    }
  } catch (const Error&) {
  }
  return 0;
}
