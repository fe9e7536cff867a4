// SPDX-License-Identifier: AGPL-3.0-or-later
// Exports parts of the project, results, reports and pictures. Tasks write the files while the editor stays responsive;
// a file is written completely or not at all.
#pragma once

#include "core/project/document.h"

namespace limber::editor {

struct Context;

enum class ExportKind { Volume, Tissues, Rig, Weights, Pose, Motion, Gltf };
// Returns why this part of the project cannot be exported now; "" when it can.
std::string why_not_export(const Document& document, ExportKind kind);
void export_file(Context& context, ExportKind kind, const Path& path);
// Writes the result in the format of the file's ending: a volume, surfaces, the posed mesh, or the input of a
// simulation program. For some programs, a dialog first asks for the frequency of the simulated field.
void export_result(Context& context, const std::shared_ptr<const Result>& result, const Path& path);
// Writes the grey image that was posed together with the result. Throws Error if there is none.
void export_posed_image(Context& context, const std::shared_ptr<const Result>& result, const Path& path);
// Writes a report in the format of the file's ending. `.html`: a page of all results, which the browser then opens.
// `.json`: the result's report as stored. Any other ending: the result's report as readable text.
void export_report(Context& context, const std::shared_ptr<const Result>& result, const Path& path);

// Writes a picture of the active view, without the window around it, in full quality.
void export_picture(Context& context, const Path& path);
// Writes the pictures NAME-0000.png, NAME-0001.png and so on, in which the camera turns once around the body, or a
// video when the name ends in .mp4 or .webm. Throws Error when a video needs ffmpeg and that is not installed.
void export_turntable(Context& context, const Path& path, int pictures = 36);

}  // namespace limber::editor
