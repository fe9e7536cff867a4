// SPDX-License-Identifier: AGPL-3.0-or-later
// Prints everything that the command line shows. Names and texts come from files by unknown authors, and a control
// character in them would be a command to the terminal, so control characters are replaced. Only this file writes to
// the program's stdout and stderr, except a worker's sign of life (core/project/worker.cpp).
#pragma once

#include <string>
#include <string_view>

namespace limber::cmd {

// Returns the text with control characters (C0 except line feed and tab, DEL, C1) and bytes that are not UTF-8
// replaced by '?'.
std::string printable(std::string_view text);
// Returns the text as one line: as printable() does, but with blanks for line feeds, carriage returns and tabs.
std::string one_line(std::string_view text);

// Print to stdout. The text is passed through printable() first.
void print(const char* format, ...) __attribute__((format(printf, 1, 2)));
void print_text(std::string_view text);
// Prints JSON to stdout. Control characters, which can only occur in strings of the JSON, are written as \u00XX, so
// that no character is lost.
void print_json(std::string_view json);

// Prints one line to stderr, and erases a progress bar on that line first.
void tell(std::string_view line);
// Prints to stderr without replacing control characters. It is only for progress bars, which contain only the program's
// own words and terminal commands.
void draw_bar(std::string_view text);

// Flushes stdout. Returns false when some of the output could not be written, for example on a full disk.
bool all_is_printed();

}  // namespace limber::cmd
