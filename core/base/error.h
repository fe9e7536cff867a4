// SPDX-License-Identifier: AGPL-3.0-or-later
// Defines Error, the exception for failures that a user can act on. It has three parts, shown as one line:
//   limber: WHAT is wrong: WHERE (file, label, bone): WHAT TO DO
// An Error is caught in exactly three places: the command line's main, the editor's operator runner and the end of a
// job. An exception of a library is converted to an Error where that library is called.
#pragma once

#include <stdexcept>
#include <string>

namespace limber {

class Error : public std::runtime_error {
 public:
  Error(const std::string& what, const std::string& where, const std::string& what_to_do)
      : std::runtime_error(what + ": " + where + ": " + what_to_do) {}
};

// Exception that is thrown when the user has cancelled the work. The user never sees it as an error.
class Cancelled : public std::exception {
 public:
  const char* what() const noexcept override { return "cancelled"; }
};

}  // namespace limber
