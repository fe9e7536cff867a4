// SPDX-License-Identifier: AGPL-3.0-or-later
// Numbers and names as a report writes them.
#pragma once

#include <cstdint>
#include <string>

namespace limber {

std::string number(double value);               // as short as it goes: "0.05"
std::string fixed(double value, int decimals);  // "12.30"; never "-0.00"
std::string signed_number(double value,
                          int decimals);   // "+1.20", "−0.31", "0.00": a true minus sign, which is as wide as a plus
std::string grouped(std::int64_t value);   // "646 912", by narrow no-break spaces from five digits on
std::string minutes_text(double seconds);  // "about 14 min"
std::string escaped(const std::string& text);  // for HTML

}  // namespace limber
