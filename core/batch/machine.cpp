// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/batch/machine.h"

#include <cmath>
#include <thread>

#include "core/platform/host.h"

namespace limber {

std::string machine_text() {
  const SystemName system = system_name();
  const unsigned cores = std::thread::hardware_concurrency();
  return processor_name() + ", " + std::to_string(cores) + (cores == 1 ? " core, " : " cores, ") +
         std::to_string(std::lround(double(physical_memory()) / 1e9)) + " GB, " + system.name + " " + system.release;
}

}  // namespace limber
