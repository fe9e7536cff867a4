// SPDX-License-Identifier: AGPL-3.0-or-later
// The messages of the editor to the user: toasts that are shown for a moment, the console's log, and error messages
// about the user's own actions that failed.
#pragma once

#include <deque>
#include <string>
#include <vector>

namespace limber::editor {

enum class Severity { Info, Ok, Warning, Error };

struct Toast {
  Severity severity;
  std::string line, detail;
  std::string action;   // the id of the operator that the toast's button runs; empty: no button
  std::string failure;  // an Error's whole line, which the toast's button "Details" shows; empty: none
  double since = -1;    // time at which it was drawn first, s; -1: not drawn yet
  int times = 1;
};

struct LogLine {
  Severity severity;
  std::string text;
};

// An error message, split into what the user reads: what failed, where, what to do about it.
struct ErrorMessage {
  std::string what, where, what_to_do;
  std::string line;    // the Error's whole line, for the details and the clipboard
  std::string during;  // the label of the user's action that failed; may be empty
  int times = 1;

  bool operator==(const ErrorMessage& other) const { return line == other.line; }
};

class Messages {
 public:
  void info(std::string line, std::string detail = "") { add({Severity::Info, std::move(line), std::move(detail)}); }
  void ok(std::string line, std::string detail = "", std::string action = "") {
    add({Severity::Ok, std::move(line), std::move(detail), std::move(action)});
  }
  void warn(std::string line, std::string detail = "") { add({Severity::Warning, std::move(line), std::move(detail)}); }
  // Shows a toast about something that failed but that the user did not ask for just now, such as a background job.
  void toast_error(std::string line, std::string detail = "", std::string action = "") {
    add({Severity::Error, std::move(line), std::move(detail), std::move(action)});
  }
  // Shows an error toast, with a button that shows the whole message. `text` is an Error's line. `where` is shown if
  // the line does not say where the error occurred.
  void toast_failure(const std::string& text, const std::string& where);
  // Shows an error in the middle of the window, since the user's own action failed. If the same error is already shown,
  // only its count increases. `text` is an Error's line.
  void show_error(const std::string& text, const std::string& during = "");
  // Does the same as show_error() for an error that is already in the log, so that it is not logged twice.
  void show_again(const std::string& text, const std::string& during = "");

  std::deque<Toast> toasts;
  std::vector<LogLine> log;
  std::vector<ErrorMessage> errors;  // the first is shown, the others wait
  std::string last_failure;          // the Error's line of the job that failed last

 private:
  void add(Toast toast);
};

// Splits an Error's line "what: where: what to do" at its first and its last ": "; `where` may itself contain ": ". A
// line with one ": " has no `what_to_do`; a line without any becomes `what`.
ErrorMessage parts_of(const std::string& text);

}  // namespace limber::editor
