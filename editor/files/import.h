// SPDX-License-Identifier: AGPL-3.0-or-later
// Opens and imports files. The kind of a file is found from its name and content. Tasks read files while the editor
// stays responsive; a file changes the project only if it is complete and fits the project. A volume or a project
// replaces the open one; any other file is imported as an edit of the open project.
#pragma once

#include <string>
#include <vector>

#include "editor/files/file_kind.h"
#include "editor/files/project_session.h"

namespace limber::editor {

struct Context;

// Opens files that were dropped on the window, given on the command line, or selected in the Open dialog. Finds out the
// kind of each file first.
void open_files(Context& context, std::vector<Path> paths, Then then = {});
void open_volume(Context& context, const Path& path, Then then = {});

// Imports a file into the open project as one edit. A volume replaces the open volume and removes the rig, weights and
// other data made for the old volume. A grey image that cannot be labels is shown with the body (open_image); one that
// might be labels is first shown in a dialog (editor/volume/grey_image_panel.h), and the user decides.
void import_file(Context& context, FileKind kind, const Path& path, Then then = {});

// Shows a grey image (CT, MR; a file or a DICOM folder) with the open body. If no body is open, opens a project for the
// image: a volume without tissue on the image's grid, from which labels can be made.
void open_image(Context& context, const Path& path);

enum class Sample { Arm, ArmXray, Body, BodyTissues };
struct SampleFacts {
  const char *name, *facts, *picture;  // name, a line about the content, picture file in assets/samples
};
const SampleFacts& facts_of(Sample sample);
void open_sample(Context& context, Sample sample, Then then = {});

// Opens the files that were dropped or given on the command line and are not open yet.
void open_waiting_files(Context& context);

}  // namespace limber::editor
