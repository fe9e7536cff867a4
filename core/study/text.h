// SPDX-License-Identifier: AGPL-3.0-or-later
// Formats numbers, names and files for a report.
#pragma once

#include <cstdint>
#include <string>

namespace limber {

std::string number(double value);               // returns a number with at most six digits: "0.05"
std::string fixed(double value, int decimals);  // returns text such as "12.30"; never "-0.00"
// Returns text such as "+1.20"; minus is U+2212, as wide as a plus.
std::string signed_number(double value, int decimals);
// Returns text such as "646 912", with narrow no-break spaces between thousands, from five digits on.
std::string grouped(std::int64_t value);
std::string minutes_text(double seconds);      // returns text such as "about 14 min"
std::string escaped(const std::string& text);  // escapes the text for HTML
std::string base64(const std::string& bytes);

}  // namespace limber
