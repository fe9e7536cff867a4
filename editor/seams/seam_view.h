// SPDX-License-Identifier: AGPL-3.0-or-later
// Seams as the Skin workspace shows and changes them: a sheet in 3D and lines in slices where tissue touches without
// being one, how many faces lie between which parts of the body, and a brush. A stroke of the brush cuts like a knife
// as deep as the brush's radius, along the line of sight in 3D and to both sides of a slice; with Ctrl it erases what
// lies within the ball. A stroke is one edit.
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

// Of seams, in the world, mm: rectangles of faces that lie in one plane, and the edges that bound the sheets.
struct SeamSheet {
  std::vector<std::array<glm::dvec3, 4>> rectangles;
  std::vector<std::array<glm::dvec3, 2>> rims;
};
SeamSheet sheet_of(const Seams& seams, const Grid& grid);

struct SeamView {
  bool shown = true;   // over the views of the Skin workspace
  bool brush = false;  // strokes change seams in place of weights

  // A stroke that is being painted.
  struct Running {
    std::shared_ptr<const LabelVolume> volume;
    LabelSet soft;
    std::shared_ptr<Seams> seams;
    SeamStroke stroke = SeamStroke::Cut;
    ViewPlace view;
    glm::vec2 pixel{0};
    std::optional<Blade> blade;  // where the knife was
    std::int64_t faces = 0;      // that were changed
  };
  std::shared_ptr<Running> running;  // while a button paints

  // What was drawn last, and what it was made of.
  struct {
    std::shared_ptr<const Seams> of;
    std::int64_t strokes = 0;
    SeamSheet sheet;
  } drawn;

  // The pairs of parts that were counted last.
  struct Counted {
    SeamSource source;
    std::shared_ptr<const Seams> seams;
    std::vector<SeamPair> pairs;
  } counted;
  std::optional<int> counting, searching;  // tasks

  // What the weights were computed from, once it is known.
  std::optional<SeamSource> weights_from;
};

// Before seams or the bone map change: the weights that there are know of them as they were.
void note_weights_source(Editor& editor);
std::string why_weights_are_old(const Editor& editor);  // "" when they are not, or nobody knows

// What is painted, else the document's, else what was found; nothing where nobody looked for them yet, null where there
// are none.
std::optional<std::shared_ptr<const Seams>> shown_seams(const Editor& editor);
// The tissue of the open volume, parted at those: brushes and edits of weights do not cross them.
std::shared_ptr<const TissueVoxels> parted_tissue(Editor& editor);
// Null while they are being counted, which this begins.
const std::vector<SeamPair>* counted_pairs(Editor& editor);

std::string why_no_seams(const Editor& editor);  // why none can be looked for; "" when they can
// Looks for them anew, beside the editor; edits of them are dropped by one edit.
void find_seams_again(Editor& editor);
void clear_seams(Editor& editor);

void draw_seams(Editor& editor, const ViewPlace& view);

}  // namespace limber::editor
