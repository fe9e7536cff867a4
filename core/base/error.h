// SPDX-License-Identifier: AGPL-3.0-or-later
// What a user can act on. Thrown with three parts, shown as one line:
//   limber: WHAT is wrong: WHERE (file, label, bone): WHAT TO DO
// Caught in exactly three places: the command line's main, the editor's operator runner, the end of a job.
// A library's own exception becomes an Error at that library's door.
#pragma once

#include <stdexcept>
#include <string>

namespace limber {

class Error : public std::runtime_error {
 public:
  Error(const std::string& what, const std::string& where, const std::string& what_to_do)
      : std::runtime_error(what + ": " + where + ": " + what_to_do) {}
};

// The user asked to stop. Never shown as an error.
class Cancelled : public std::exception {
 public:
  const char* what() const noexcept override { return "cancelled"; }
};

}  // namespace limber
