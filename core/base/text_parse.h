// SPDX-License-Identifier: AGPL-3.0-or-later
// Parses small texts such as file headers. No function throws, and none allocates more memory than the length of its
// input. A text with further characters after a number is not accepted as a number.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace limber {

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }

inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

// Converts ASCII letters to lower case, independently of the locale.
inline std::string lower_case(std::string_view text) {
  std::string low(text);
  for (char& c : low)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return low;
}

inline std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t i = 0; i < text.size();) {
    while (i < text.size() && is_blank(text[i])) ++i;
    std::size_t end = i;
    while (end < text.size() && !is_blank(text[end])) ++end;
    if (end > i) words.push_back(text.substr(i, end - i));
    i = end;
  }
  return words;
}

// Removes the next line from the front of `rest` and returns it without its end (LF, CRLF or CR).
inline std::string_view take_line(std::string_view& rest) {
  const std::size_t end = std::min(rest.find_first_of("\r\n"), rest.size());
  const std::string_view line = rest.substr(0, end);
  std::size_t next = end;
  if (next < rest.size()) next += rest.substr(next, 2) == "\r\n" ? 2 : 1;
  rest.remove_prefix(next);
  return line;
}

template <class Number>
std::optional<Number> number_of(std::string_view text) {
  text = trimmed(text);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || text.empty()) return std::nullopt;
  return value;
}

// Returns the words of a text converted to numbers, or nothing when one of the words is not a number.
template <class Number>
std::optional<std::vector<Number>> numbers_of(std::string_view text) {
  std::vector<Number> numbers;
  for (std::string_view word : words_of(text)) {
    const auto number = number_of<Number>(word);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

// Returns the shortest text from which exactly this number can be read back. Whole numbers have no exponent.
inline std::string text_of(double number) {
  constexpr double kExact = 9007199254740992;  // 2^53: up to here a double represents every whole number exactly
  if (number >= -kExact && number <= kExact && number == static_cast<double>(static_cast<std::int64_t>(number)))
    return std::to_string(static_cast<std::int64_t>(number));
  char buffer[40];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, number);
  return std::string(buffer, end);
}

// Returns text from a file in quotes, for an error message: at most 60 characters of the text, with "?" in place of
// unprintable characters.
inline std::string in_quotes(std::string_view text) {
  std::string shown;
  for (char c : text.substr(0, 60)) shown += c >= ' ' && c <= '~' ? c : '?';
  return "\"" + shown + (text.size() > 60 ? "...\"" : "\"");
}

}  // namespace limber
