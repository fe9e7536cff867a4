// SPDX-License-Identifier: AGPL-3.0-or-later
// What the editor tells the user without being asked: toasts for the moment, a console log for later, one error message
// for an act of the user's own that failed.
#pragma once

#include <deque>
#include <string>
#include <vector>

namespace limber::editor {

enum class Severity { Info, Ok, Warning, Error };

struct Toast {
  Severity severity;
  std::string line, detail;
  std::string action;   // an operator's id: the one thing to do about it
  std::string failure;  // an Error's line that can be read whole; then its details are the one thing to do
  double since = -1;    // first shown; set when drawn
  int times = 1;
};

struct LogLine {
  Severity severity;
  std::string text;
};

// An error as the user reads it: title, where, what to do.
struct ErrorMessage {
  std::string what, where, what_to_do;
  std::string line;    // as the program puts it: for the details and for the clipboard
  std::string during;  // what the user had begun; may be empty
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
  // Beside the work: what failed without the user having just asked for it, as in a job.
  void toast_error(std::string line, std::string detail = "", std::string action = "") {
    add({Severity::Error, std::move(line), std::move(detail), std::move(action)});
  }
  // The same from an Error's line; the whole of it can be read again.
  void toast_failure(const std::string& text, const std::string& where);
  // In the middle of the window: the user's own act failed. The same error again counts up. `text` is an Error's line.
  void show_error(const std::string& text, const std::string& during = "");
  // The same of one that is in the log already.
  void show_again(const std::string& text, const std::string& during = "");

  std::deque<Toast> toasts;
  std::vector<LogLine> log;
  std::vector<ErrorMessage> errors;  // the first is shown
  std::string last_failure;          // of a job: an Error's line

 private:
  void add(Toast toast);
};

// "what: where: what to do" in its three parts, of which the middle may hold a chain of others; a text of another shape
// is all `what`.
ErrorMessage parts_of(const std::string& text);

}  // namespace limber::editor
