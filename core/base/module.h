// SPDX-License-Identifier: AGPL-3.0-or-later
// Code that is loaded while the program runs, always by its whole path: by a bare name the loader would also look where
// the environment says (LD_LIBRARY_PATH, PATH), and an empty entry there is the working folder, where anybody's file
// may lie.
#pragma once

#include <optional>
#include <string>

#include "core/base/file.h"

namespace limber {

// Opens NAME.so beside the program, or in ../lib/limber from there. nullptr where neither holds one that can be opened.
// It stays open until the program ends.
void* open_module(const std::string& name);

// The program NAME in the same two places, which is part of Limber and no command. Nothing where neither holds it, as
// in another program that uses Limber as a library.
std::optional<Path> find_own_program(const std::string& name);

// The program of that name in the first folder of PATH that has it; folders that are not named from the root are passed
// over.
std::optional<Path> find_program(const std::string& name);

}  // namespace limber
