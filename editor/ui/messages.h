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
  std::string action;  // id of the operator that the toast's button runs; empty: no button
  // An Error's whole line, which the toast's button "Details" shows; empty: there is no such button.
  std::string failure;
  double since = -1;  // time at which the toast was drawn first, s; -1: not drawn yet
  int times = 1;
};

struct LogLine {
  Severity severity;
  std::string text;
};

// An error message, split into three parts: what failed, where it failed, and what the user can do.
struct ErrorMessage {
  std::string what, where, what_to_do;
  std::string line;    // the Error's whole text in one line, for the details and the clipboard
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
  // Shows a toast about a failure of something that the user did not ask for just now, such as a background job.
  void toast_error(std::string line, std::string detail = "", std::string action = "") {
    add({Severity::Error, std::move(line), std::move(detail), std::move(action)});
  }
  // Shows an error toast, with a button that shows the whole message. `text` is the text of an Error. `where` is shown
  // if this text does not say where the error occurred.
  void toast_failure(const std::string& text, const std::string& where);
  // Shows an error in the middle of the window, since an action of the user's failed. If the same error is already
  // shown, only its count increases. `text` is the text of an Error.
  void show_error(const std::string& text, const std::string& during = "");
  // Shows an error like show_error(), but without logging it: the error is already in the log.
  void show_again(const std::string& text, const std::string& during = "");

  std::deque<Toast> toasts;
  std::vector<LogLine> log;
  std::vector<ErrorMessage> errors;  // error messages: the first one is shown, the others wait
  bool details_open = false;         // true: the details of the shown error are unfolded
  std::string last_failure;          // text of the Error of the job that failed last

 private:
  void add(Toast toast);
};

// Splits the text of an Error, "what: where: what to do", at its first and its last ": ". `where` may itself contain ":
// ". A text with one ": " has no `what_to_do`; a text without any becomes `what`.
ErrorMessage parts_of(const std::string& text);

}  // namespace limber::editor
