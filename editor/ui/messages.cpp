// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/messages.h"

#include <algorithm>
#include <cctype>

namespace limber::editor {

namespace {

constexpr std::size_t kLongestLog = 5000;  // upper limit on the lines of the log; older lines are dropped

// Returns the text with a capital letter at its beginning. The texts of Errors begin with a small letter, because the
// command line prints them after the program's name.
std::string description(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

}  // namespace

ErrorMessage parts_of(const std::string& text) {
  ErrorMessage message;
  message.line = text;
  const auto first = text.find(": ");
  const auto last = text.rfind(": ");
  message.what = text.substr(0, first);
  if (first != std::string::npos && last != first) {
    message.where = text.substr(first + 2, last - first - 2);
    message.what_to_do = text.substr(last + 2);
  } else if (first != std::string::npos) {
    message.where = text.substr(first + 2);
  }
  message.what = description(message.what);
  message.what_to_do = description(message.what_to_do);
  return message;
}

void Messages::add(Toast toast) {
  log.push_back({toast.severity, toast.detail.empty() ? toast.line : toast.line + ": " + toast.detail});
  if (log.size() > kLongestLog) log.erase(log.begin(), log.begin() + kLongestLog / 10);
  const auto same = std::find_if(toasts.begin(), toasts.end(),
                                 [&](const Toast& t) { return t.line == toast.line && t.detail == toast.detail; });
  if (same == toasts.end()) return toasts.push_back(std::move(toast));
  same->times += 1;
  same->since = -1;
}

void Messages::toast_failure(const std::string& text, const std::string& where) {
  const ErrorMessage message = parts_of(text);
  last_failure = text;
  add({.severity = Severity::Error,
       .line = message.what,
       .detail = message.where.empty() ? where : message.where,
       .failure = text});
  log.back().text = text;
}

void Messages::show_error(const std::string& text, const std::string& during) {
  log.push_back({Severity::Error, text});
  show_again(text, during);
}

void Messages::show_again(const std::string& text, const std::string& during) {
  ErrorMessage message = parts_of(text);
  message.during = during;
  const auto same = std::find(errors.begin(), errors.end(), message);
  if (same == errors.end()) errors.push_back(std::move(message));
  else same->times += 1;
}

}  // namespace limber::editor
