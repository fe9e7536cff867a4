// SPDX-License-Identifier: AGPL-3.0-or-later
// Fuzzes the readers of surface files: a file is refused with Error, or read into triangles whose vertices exist, are
// finite and are all used. The first byte selects the format, so that mutated seeds keep their format.
#include <cmath>
#include <cstdlib>
#include <string>

#include "core/base/error.h"
#include "core/mesh/surface_file.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* bytes, std::size_t size) {
  using namespace limber;
  if (size == 0) return 0;
  static constexpr const char* kNames[] = {"fuzz.stl", "fuzz.obj", "fuzz.ply", "fuzz.gltf", "fuzz.glb"};
  const Path path = Path("/nowhere") / kNames[bytes[0] % 5];
  try {
    const TriangleMesh mesh = parse_surface(std::string(reinterpret_cast<const char*>(bytes) + 1, size - 1), path);
    if (mesh.F.empty() || mesh.F.size() > kMostSurfaceTriangles) std::abort();
    std::vector<bool> used(mesh.V.size());
    for (const glm::ivec3& f : mesh.F)
      for (int i = 0; i < 3; ++i) {
        if (f[i] < 0 || f[i] >= static_cast<int>(mesh.V.size()) || f[i] == f[(i + 1) % 3]) std::abort();
        used[f[i]] = true;
      }
    for (std::size_t v = 0; v < mesh.V.size(); ++v) {
      if (!used[v]) std::abort();
      for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(mesh.V[v][axis]) <= kFarthestSurfacePoint)) std::abort();
    }
  } catch (const Error&) {
  }
  return 0;
}
