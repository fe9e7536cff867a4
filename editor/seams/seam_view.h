// SPDX-License-Identifier: AGPL-3.0-or-later
// Shows and edits seams in the Skin workspace. A seam is a set of voxel faces at which two body parts, such as arm and
// trunk, touch without being joined. Seams are drawn as surfaces in 3D and as lines in slices; their faces are counted
// for each pair of body parts. A stroke of the seam brush cuts tissue like a knife: in 3D along the line of sight, as
// deep as the brush's radius; in a slice to both sides of the slice by this radius. While Ctrl is held, the stroke
// erases seams within a ball of this radius instead. Each stroke is one edit.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/seams/seam_edits.h"
#include "core/seams/seam_pairs.h"
#include "editor/context/view_place.h"
#include "editor/volume/body_seams.h"

namespace limber::editor {

struct Context;

enum class SeamStroke { Cut, Join };

// The drawn geometry of seams, world coordinates in mm: rectangles of voxel faces that lie in one plane, and the line
// segments of the seams' rims.
struct SeamSheet {
  std::vector<std::array<glm::dvec3, 4>> rectangles;
  std::vector<std::array<glm::dvec3, 2>> rims;
};
SeamSheet sheet_of(const Seams& seams, const Grid& grid);

struct SeamView {
  bool shown = true;   // true: the Skin workspace draws seams
  bool brush = false;  // true: strokes change seams instead of weights

  // The stroke of the seam brush in progress.
  struct Running {
    std::shared_ptr<const LabelVolume> volume;
    LabelSet soft;
    std::shared_ptr<Seams> seams;
    SeamStroke stroke = SeamStroke::Cut;
    ViewPlace view;
    glm::vec2 pixel{0};
    // Line segment that cuts tissue, at the pointer's last position on tissue; none: the pointer is beside the tissue.
    std::optional<Blade> blade;
    std::int64_t faces = 0;  // number of voxel faces that the stroke has changed
  };
  std::shared_ptr<Running> running;  // the stroke in progress; null: no stroke is in progress

  // Cache of the seam geometry that was drawn last (`sheet`). of: the seams for which it was computed; strokes: the
  // number of voxel faces that the stroke in progress had changed at that time, -1: no stroke.
  struct {
    std::shared_ptr<const Seams> of;
    std::int64_t strokes = 0;
    SeamSheet sheet;
  } drawn;

  // Cache of the number of seam faces for each pair of body parts, with the seams and other inputs of the count.
  struct Counted {
    SeamSource source;
    std::shared_ptr<const Seams> seams;
    std::vector<SeamPair> pairs;
  } counted;
  std::optional<int> counting, searching;  // ids of the background tasks that count and find seams

  // The seams and other inputs, such as the bone map, from which the weights were computed; nothing: unknown.
  std::optional<SeamSource> weights_from;
};

// Stores the seams and the bone map from which the current weights were computed. Call it before the document's seams
// or bone map change.
void note_weights_source(Context& context);
// Returns why the weights are out of date, such as "Weights are older than the seams". Returns "" if the weights are up
// to date, or if it is unknown from which seams they were computed.
std::string why_weights_are_old(const Context& context);

// Returns the seams that the views show: during a stroke of the seam brush the changed seams, otherwise the document's
// edited seams, and without these the seams that were found automatically. Returns std::nullopt if there was no search
// for seams yet, and a null pointer if there are no seams.
std::optional<std::shared_ptr<const Seams>> shown_seams(const Context& context);
// Returns the tissue voxels of the open volume for brushes and edits of weights. Two voxels with a seam between them do
// not count as neighbours, so that brushes and edits do not cross seams.
std::shared_ptr<const TissueVoxels> parted_tissue(Context& context);
// Returns the number of seam faces for each pair of body parts that a seam separates. If they are not counted yet,
// starts a background task that counts them, and returns null until the task has ended.
const std::vector<SeamPair>* counted_pairs(Context& context);

std::string why_no_seams(
    const Context& context);  // returns why a search for seams is impossible now; "": it is possible
// Starts a background task that searches for seams again. When it ends, one edit removes seams that were changed by
// hand, so that the found seams are used.
void find_seams_again(Context& context);
void clear_seams(Context& context);

void draw_seams(Context& context, const ViewPlace& view);

}  // namespace limber::editor
