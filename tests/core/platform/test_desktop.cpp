// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/desktop.h"

#include <cstdlib>
#include <optional>
#include <string>

#include <doctest/doctest.h>

using namespace limber;

namespace {
// Sets an environment variable as long as this object lives; nullptr removes the variable.
struct Variable {
  const char* name;
  std::optional<std::string> before;
  Variable(const char* variable, const char* value) : name(variable) {
    if (const char* old = std::getenv(name)) before = old;
    value ? ::setenv(name, value, 1) : ::unsetenv(name);
  }
  ~Variable() { before ? ::setenv(name, before->c_str(), 1) : ::unsetenv(name); }
};
}  // namespace

TEST_CASE(
    "desktop: a user's folders are those of the XDG variables, else lie in the home, and relative ones are ignored") {
  const Variable home("HOME", "/home/me");
  {
    const Variable state("XDG_STATE_HOME", "/elsewhere"), cache("XDG_CACHE_HOME", nullptr),
        config("XDG_CONFIG_HOME", "relative");
    CHECK(user_folder(UserFolder::State) == "/elsewhere");
    CHECK(user_folder(UserFolder::Cache) == "/home/me/.cache");
    CHECK(user_folder(UserFolder::Config) == "/home/me/.config");
    CHECK(home_folder() == "/home/me");
  }
  const Variable nowhere("HOME", nullptr), state("XDG_STATE_HOME", nullptr);
  CHECK(user_folder(UserFolder::State).empty());
  CHECK(home_folder() == "/");
}
