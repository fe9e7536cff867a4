// SPDX-License-Identifier: AGPL-3.0-or-later
// Pages of the Help menu: every key, and what the program is made of.
#pragma once

#include <memory>
#include <string>

#include "editor/context/editor.h"

namespace limber::editor {

std::unique_ptr<Dialog> open_keys_page();
std::unique_ptr<Dialog> open_about_page();

// Version, driver, monitor scale: what a report of a mistake should hold.
std::string system_facts(const Editor& editor);

}  // namespace limber::editor
