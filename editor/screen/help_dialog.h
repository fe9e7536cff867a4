// SPDX-License-Identifier: AGPL-3.0-or-later
// The dialogs of the Help menu: the list of keys, and the version, licence and libraries of the program.
#pragma once

#include <memory>
#include <string>

namespace limber::editor {

class Dialog;
struct Context;

std::unique_ptr<Dialog> open_keys_page();
std::unique_ptr<Dialog> open_about_page();

// Returns version, driver and monitor scale as text for a bug report.
std::string system_facts(const Context& context);

}  // namespace limber::editor
