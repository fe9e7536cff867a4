// SPDX-License-Identifier: AGPL-3.0-or-later
// Fuzzes the readers of rig files. The first byte selects the file format.
#include <string>

#include "core/base/error.h"
#include "core/rig_io/bender_rig.h"
#include "core/rig_io/gltf_rig.h"
#include "core/rig_io/obj_summary.h"
#include "core/rig_io/rig_io.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* bytes, std::size_t size) {
  using namespace limber;
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(bytes) + 1, size - 1);
  try {
    switch (bytes[0] % 6) {
      case 0: parse_bender_vtk(bender_vtk_text(parse_bender_vtk(text, "fuzz")), "written"); break;
      case 1: parse_bender_arm(text, "fuzz"); break;
      case 2: parse_armature_json(text, "fuzz"); break;
      case 3: parse_gltf(text, false, "fuzz"); break;
      case 4: parse_gltf(text, true, "fuzz"); break;
      case 5: parse_obj_summary(text, "fuzz"); break;
    }
  } catch (const Error&) {
  }
  return 0;
}
