// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/text.h"

#include <cmath>
#include <cstdio>

namespace limber {

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string fixed(double value, int decimals) {
  char text[400];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  const bool is_zero = std::string(text).find_first_of("123456789") == std::string::npos;
  return text[0] == '-' && is_zero ? text + 1 : text;
}

std::string signed_number(double value, int decimals) {
  const std::string text = fixed(value, decimals);
  if (text[0] == '-') return "−" + text.substr(1);
  return text.find_first_of("123456789") == std::string::npos ? text : "+" + text;
}

std::string grouped(std::int64_t value) {
  std::string digits = std::to_string(std::abs(value)), text;
  const std::size_t length = digits.size();
  for (std::size_t i = 0; i < length; ++i) {
    if (i > 0 && length > 4 && (length - i) % 3 == 0) text += "\u202f";
    text += digits[i];
  }
  return value < 0 ? "−" + text : text;
}

std::string minutes_text(double seconds) {
  if (seconds < 50) return "less than a minute";
  const double minutes = seconds / 60;
  if (minutes < 90) return "about " + std::to_string(std::lround(minutes)) + " min";
  char text[40];
  std::snprintf(text, sizeof text, "about %.1f h", minutes / 60);
  return text;
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      default:
        if (static_cast<unsigned char>(c) >= ' ' || c == '\n') result += c;
    }
  }
  return result;
}

}  // namespace limber
