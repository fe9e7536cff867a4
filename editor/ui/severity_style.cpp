// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/severity_style.h"

#include "editor/ui/icons.h"

namespace limber::editor {

Sign sign_of(const Theme& theme, Severity severity) {
  switch (severity) {
    case Severity::Info: return {icon::kInfo, theme.accent_text};
    case Severity::Ok: return {icon::kOk, theme.ok};
    case Severity::Warning: return {icon::kWarning, theme.warn};
    case Severity::Error: break;
  }
  return {icon::kError, theme.error};
}

}  // namespace limber::editor
