// SPDX-License-Identifier: AGPL-3.0-or-later
// Fuzzes the readers of comma-separated tables: landmarks, and a user's dielectric properties. A table is read into
// finite numbers, or refused with Error.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include <unistd.h>

#include "core/base/error.h"
#include "core/tissue/dielectric.h"
#include "core/volume_io/landmarks.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace limber;
  static const Path path = std::filesystem::temp_directory_path() / ("fuzz-csv-" + std::to_string(::getpid()));
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    for (const Landmark& landmark : read_landmarks(path))
      if (!std::isfinite(landmark.position.x + landmark.position.y + landmark.position.z)) std::abort();
  } catch (const Error&) {
  }
  try {
    const DielectricTable table = read_dielectric_table(path);
    for (std::size_t row = 0; row < table.user_rows; ++row)
      for (const double frequency : {kLowestFrequency, 1e9, kHighestFrequency}) {
        const Dielectric found = dielectric_at(table.parameters[row], frequency);
        if (!std::isfinite(found.permittivity) || !std::isfinite(found.conductivity)) std::abort();
      }
  } catch (const Error&) {
  }
  return 0;
}
