// SPDX-License-Identifier: AGPL-3.0-or-later
// All that the command line shows. Names and texts come from files that anybody may have made: a control character in
// them would be an order to the terminal, so none goes out. This is the only place of the program that writes to stdout
// and stderr.
#pragma once

#include <string>
#include <string_view>

namespace limber::cmd {

// The text as it may be shown: control characters (C0 but for line feed and tab, DEL, C1) and bytes that are no UTF-8
// become '?'.
std::string printable(std::string_view text);
// The same in one line: line feeds and tabs become blanks.
std::string one_line(std::string_view text);

// To stdout, made printable.
void print(const char* format, ...) __attribute__((format(printf, 1, 2)));
void print_text(std::string_view text);
// JSON to stdout: what is not printable can only stand in its strings, where it is written as \u00XX, so that no letter
// is lost.
void print_json(std::string_view json);

// To stderr, in one line, in place of the bar where one stands.
void tell(std::string_view line);
// To stderr, as it is: for a bar, which is made of the program's own words and orders, and for lines of JSON.
void draw_bar(std::string_view text);

// What was printed so far is handed over. False when some of it could not be written, as on a full disk.
bool all_is_printed();

// Where the program was started without stdin, stdout or stderr, files that it opens would take their places and get
// its messages: this fills them with what nothing can be written to.
void keep_standard_streams();

}  // namespace limber::cmd
