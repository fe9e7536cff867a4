// SPDX-License-Identifier: AGPL-3.0-or-later
// How the Skin workspace shows weights: the colouring, and the hidden regions (a bone's region is the tissue where the
// bone has the largest weight), with caches of both. Also edits the locks of bones, which are part of the document.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/project/document.h"
#include "core/skin/skin_weights.h"
#include "editor/ui/theme.h"
#include "render/scene/scene.h"

namespace limber::editor {

struct Context;

// Computes the share of each bone in the sum of all weights of the body. The first update sums the weights of all
// voxels, in a thread of its own if the body is large. Later updates sum only the chunks that have changed since.
class WeightShares {
 public:
  void update(const std::shared_ptr<const SkinWeights>& weights, const std::function<void()>& wake);
  // Returns the share of a bone (index into the weights' bones), [0, 1]; none: not computed yet.
  std::optional<double> of(int bone) const;
  bool busy() const { return counting_.valid(); }

 private:
  struct Counted {
    std::shared_ptr<const SkinWeights> weights;
    std::vector<std::int64_t> sums;  // sum of each bone's weights over all voxels, in units of 1/65535
  };
  static Counted count(const std::shared_ptr<const SkinWeights>& weights);

  Counted counted_;
  std::future<Counted> counting_;
};

struct Painting;

struct SkinDisplay {
  SkinDisplay();
  ~SkinDisplay();

  // What the colours of the body show; no value: its tissues.
  std::optional<render::WeightDisplay> display = render::WeightDisplay::Active;
  bool contours = true;
  std::set<std::string> hidden;  // bones whose regions are hidden
  float ring = 0;                // radius of the brush's ring, pixels; the weights readout stays outside it

  std::string search;  // search text of the bone list
  bool searching = false, focus_search = false;
  std::optional<int> revealed;  // the active bone that the list last scrolled to

  std::unique_ptr<Painting> painting;  // brush settings and running stroke, declared in painting.h; never null

  WeightShares shares;
  // Cache of the volume without the hidden regions (`volume`), with the inputs from which it was computed.
  struct {
    std::shared_ptr<const LabelVolume> from, volume;
    std::shared_ptr<const SkinWeights> weights;
    std::set<std::string> hidden;
  } region;
  // The task that computes `region` again for a large body; the views show the old volume meanwhile.
  std::optional<int> region_task;
  // Cache of a colour for each bone of the weights, with the inputs from which the colours were computed.
  struct {
    std::shared_ptr<const Armature> armature;
    std::vector<std::string> bones;
    std::shared_ptr<const std::vector<glm::vec3>> colours;
  } swatches;
};

// Returns the weights of the running stroke, or else the document's weights; null without a volume and a rig.
std::shared_ptr<const SkinWeights> seen_weights(const Context& context);
// Returns the bone's index in the weights; -1: no bone has that name.
int weights_bone(const SkinWeights& weights, const std::string& name);
// Returns the bone's colour in lists; the active bone is orange.
Colour swatch_of(Context& context, int bone);

// Prepares this frame's scene for the Skin workspace: sets the weights, the volume without hidden regions, and the
// bones as sticks with the active bone marked.
void show_weights(Context& context);

// Returns true if `volume` is the document's volume, a copy of it without the hidden regions, or the volume that a
// stroke of the label brush paints.
bool is_of_document(const Context& context, const std::shared_ptr<const LabelVolume>& volume);

// Returns the distance from the centre of a tissue voxel to the nearest face of an air voxel, mm.
double depth_of(const LabelVolume& volume, const glm::ivec3& voxel);

bool is_locked(const Document& document, const std::string& bone);
// Sets the locked bones as one edit; if nothing changes, makes no edit.
void set_locks(Context& context, const std::string& label, std::set<std::string> bones);
void toggle_lock(Context& context, int bone);
// Locks all bones except this one; if exactly these bones are already locked, unlocks all.
void lock_all_but(Context& context, int bone);

// Hides or shows a bone's region, which is the tissue where the bone has the largest weight.
void hide_region(Context& context, const std::string& bone, bool hidden);
// Shows only the regions of these bones; a second call shows all regions again.
void isolate_regions(Context& context, const std::set<std::string>& bones);

const char* name_of(const std::optional<render::WeightDisplay>& display);

}  // namespace limber::editor
