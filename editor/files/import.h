// SPDX-License-Identifier: AGPL-3.0-or-later
// Files come in: told apart by their content, read beside the live editor, and taken only when they are whole and fit
// what is open. A volume or a project takes the open one's place; everything else is an edit of the open project.
#pragma once

#include <string>
#include <vector>

#include "editor/context/editor.h"
#include "editor/files/project_session.h"

namespace limber::editor {

// In the order in which files that come together are taken in.
enum class FileKind { Project, Volume, Tissues, Rig, Weights, Motion, Pose };
// Throws Error for what is missing, or is of no kind that is read.
FileKind kind_of(const Path& path);

// Dropped, given on the command line, or chosen in Open: what they are is found out first.
void open_files(Editor& editor, std::vector<Path> paths, Then then = {});
void open_volume(Editor& editor, const Path& path, Then then = {});

// Into the open project, as one edit. A volume replaces the open one and all that was made for it. A grey image is only
// shown (panels/grey_image.h), here and in open_volume, until an answer takes it as labels all the same.
void import_file(Editor& editor, FileKind kind, const Path& path, Then then = {});

enum class Sample { Arm, ArmXray, Body, BodyTissues };
struct SampleFacts {
  const char *name, *facts, *picture;  // of assets/samples
};
const SampleFacts& facts_of(Sample sample);
void open_sample(Editor& editor, Sample sample, Then then = {});

// The files that were dropped or given on the command line.
void open_waiting_files(Editor& editor);

}  // namespace limber::editor
