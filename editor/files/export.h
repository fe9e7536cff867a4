// SPDX-License-Identifier: AGPL-3.0-or-later
// Files go out, beside the live editor; each whole or not at all.
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

enum class ExportKind { Volume, Tissues, Rig, Weights, Pose, Motion, Gltf };
std::string why_not_export(const Editor& editor, ExportKind kind);  // "" when there is something to write
void export_file(Editor& editor, ExportKind kind, const Path& path);
// As the name says: a volume, surfaces, what a simulation takes (which may ask for its frequency first), or the posed
// mesh.
void export_result(Editor& editor, const std::shared_ptr<const Result>& result, const Path& path);
// .html: a page of all results, which the desktop's browser then shows. JSON as it is, or by another ending a text to
// read.
void export_report(Editor& editor, const std::shared_ptr<const Result>& result, const Path& path);

// The active view as it is shown now, without the window around it.
void export_picture(Editor& editor, const Path& path);
// NAME-0000.png and on: the 3D view turned all around, one picture a frame so that the editor stays live.
void export_turntable(Editor& editor, const Path& path, int pictures = 36);

}  // namespace limber::editor
