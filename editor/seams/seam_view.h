// SPDX-License-Identifier: AGPL-3.0-or-later
// Shows and edits seams in the Skin workspace. A seam is a set of voxel faces at which two body parts, such as arm and
// trunk, touch without being joined. It is drawn as a surface in 3D and as lines in slices, and its faces are counted
// per pair of body parts. A stroke of the seam brush cuts like a knife: in 3D along the line of sight, as deep as the
// brush's radius; in a slice by this radius to both sides. With Ctrl it erases seams within a ball of this radius. A
// stroke is one edit.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/seams/seam_edits.h"
#include "core/seams/seam_pairs.h"
#include "editor/context/editor.h"
#include "editor/volume/body_seams.h"

namespace limber::editor {

enum class SeamStroke { Cut, Join };

// The drawn geometry of seams, world coordinates in mm: rectangles of voxel faces that lie in one plane, and the line
// segments of the seams' rims.
struct SeamSheet {
  std::vector<std::array<glm::dvec3, 4>> rectangles;
  std::vector<std::array<glm::dvec3, 2>> rims;
};
SeamSheet sheet_of(const Seams& seams, const Grid& grid);

struct SeamView {
  bool shown = true;   // whether the Skin workspace draws seams
  bool brush = false;  // whether strokes change seams instead of weights

  // The stroke of the seam brush in progress.
  struct Running {
    std::shared_ptr<const LabelVolume> volume;
    LabelSet soft;
    std::shared_ptr<Seams> seams;
    SeamStroke stroke = SeamStroke::Cut;
    ViewPlace view;
    glm::vec2 pixel{0};
    std::optional<Blade> blade;  // the knife after the last step that cut; nothing: none
    std::int64_t faces = 0;      // number of voxel faces that the stroke has changed
  };
  std::shared_ptr<Running> running;  // null: no stroke in progress

  // The geometry that was drawn last, with the seams (`of`) and the number of faces changed by the stroke (`strokes`)
  // for which it was computed.
  struct {
    std::shared_ptr<const Seams> of;
    std::int64_t strokes = 0;
    SeamSheet sheet;
  } drawn;

  // The last count of faces per pair of body parts, with the document parts and seams that were counted.
  struct Counted {
    SeamSource source;
    std::shared_ptr<const Seams> seams;
    std::vector<SeamPair> pairs;
  } counted;
  std::optional<int> counting, searching;  // ids of the background tasks that count and find seams

  // The document parts (such as seams and bone map) from which the weights were computed; nothing: unknown.
  std::optional<SeamSource> weights_from;
};

// Stores the seams and the bone map from which the current weights were computed. Call it before the document's seams
// or bone map change.
void note_weights_source(Editor& editor);
// Returns why the weights are out of date, such as "Weights are older than the seams"; "" when they are not, or when
// this is unknown.
std::string why_weights_are_old(const Editor& editor);

// Returns the seams that the views show: those of the stroke in progress, else the document's edited seams, else those
// that were found automatically. Returns std::nullopt while the search has not run, and a null pointer when there are
// no seams.
std::optional<std::shared_ptr<const Seams>> shown_seams(const Editor& editor);
// Returns the tissue voxels of the open volume. Voxels on both sides of a shown seam are not neighbours, so that
// brushes and edits of weights do not cross seams.
std::shared_ptr<const TissueVoxels> parted_tissue(Editor& editor);
// Returns the number of faces of the shown seams per pair of body parts. Starts a background task if they are not
// counted yet, and returns null until it has ended.
const std::vector<SeamPair>* counted_pairs(Editor& editor);

std::string why_no_seams(const Editor& editor);  // why seams cannot be searched now; "": they can
// Starts a background task that finds the seams again. When it ends, seams that were changed by hand are discarded in
// one edit.
void find_seams_again(Editor& editor);
void clear_seams(Editor& editor);

void draw_seams(Editor& editor, const ViewPlace& view);

}  // namespace limber::editor
