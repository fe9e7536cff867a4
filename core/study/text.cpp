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
  for (std::size_t i = 0; i < text.size(); ++i) {
    // Replaces U+FFFE and U+FFFF, which XML forbids, by U+FFFD.
    if (text.compare(i, 3, "\xef\xbf\xbe") == 0 || text.compare(i, 3, "\xef\xbf\xbf") == 0) {
      result += "\ufffd";
      i += 2;
      continue;
    }
    const char c = text[i];
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

std::string base64(const std::string& bytes) {
  static const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? letters[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace limber
