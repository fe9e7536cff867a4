// SPDX-License-Identifier: AGPL-3.0-or-later
// Describes the machine and the system that run this process.
#pragma once

#include <cstdint>
#include <string>

namespace limber {

struct SystemName {
  std::string name, release, architecture;  // for example "Linux", "6.1.0-18-amd64", "x86_64"
};
SystemName system_name();

bool has_avx2();  // returns true if the processor has the instruction set AVX2

std::string host_name();         // the machine's name in its network
std::string processor_name();    // the processor's model, or "unknown processor"
std::int64_t physical_memory();  // size of the machine's memory, bytes

}  // namespace limber
