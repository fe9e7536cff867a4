// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds modules to load and programs to start, always by an absolute path. For a bare name the system would also search
// the folders of LD_LIBRARY_PATH or PATH. An empty entry there means the working folder, which may hold a stranger's
// file.
#pragma once

#include <optional>
#include <string>

#include "core/platform/path.h"

namespace limber {

// Returns the path of the shared object that contains this code, for example of a Python module. Empty if the program
// itself contains the code.
Path own_shared_object();

// Opens the module NAME.so, a shared library. Searches the folder of own_shared_object(), the program's folder,
// ../lib/limber relative to it and where Limber was installed. Returns nullptr when no folder has a module that can be
// opened. The module stays open until the program ends.
void* open_module(const std::string& name);

// Returns the path of the helper program NAME, which is a part of Limber and not a command. Searches the same folders
// as open_module(). Returns nothing when no folder has the program.
std::optional<Path> find_own_program(const std::string& name);

// Returns the path of the program `name` in the first folder of PATH that has it; nothing if none has it. Skips
// relative folders of PATH.
std::optional<Path> find_program(const std::string& name);

// Returns the path of the running program; empty where the system does not tell it.
Path running_program_path();

// Returns a path that starts the running program again, even if another version has replaced its file in the meantime.
Path running_program();

// Returns the address of a C function of an open module, or nullptr.
void* symbol_of(void* module, const char* name);

// Returns the address of a C function of this program and the libraries that it is linked with, or nullptr.
void* symbol_of_program(const char* name);

}  // namespace limber
