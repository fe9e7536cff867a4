// SPDX-License-Identifier: AGPL-3.0-or-later
// What the Skin workspace shows of skin weights: by which display, of which bone, the regions of which bones; and the
// locks of bones, which belong to the document.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/skin/skin_weights.h"
#include "editor/shown/test_pose.h"

namespace limber::editor {

// The share that each bone has of all weight. Counted once for a body, beside the editor where that is large; from then
// on only what differs from the weights counted last.
class WeightShares {
 public:
  void update(const std::shared_ptr<const SkinWeights>& weights, const std::function<void()>& wake);
  std::optional<double> of(int bone) const;  // of the weights' bones, [0, 1]; nothing yet: not counted
  bool busy() const { return counting_.valid(); }

 private:
  struct Counted {
    std::shared_ptr<const SkinWeights> weights;
    std::vector<std::int64_t> sums;  // #bones, in 1/65535
  };
  static Counted count(const std::shared_ptr<const SkinWeights>& weights);

  Counted counted_;
  std::future<Counted> counting_;
};

struct Painting;

struct SkinDisplay {
  SkinDisplay();
  ~SkinDisplay();

  std::optional<render::WeightDisplay> display = render::WeightDisplay::Active;  // nothing: the tissues
  bool contours = true;
  std::set<std::string> hidden;  // bones whose regions are hidden
  float ring = 0;                // pixels about the pointer that a brush takes: the read-out keeps off

  std::string search;  // of the list of bones
  bool searching = false, focus_search = false;
  std::optional<int> revealed;  // the active bone that the list came to last

  std::unique_ptr<Painting> painting;  // of painting.h; never null

  WeightShares shares;
  // The volume without the hidden regions, and what it was made of.
  struct {
    std::shared_ptr<const LabelVolume> from, volume;
    std::shared_ptr<const SkinWeights> weights;
    std::set<std::string> hidden;
  } region;
  std::optional<int> region_task;  // makes it anew for a large body; the old one is seen meanwhile
  // The colours of the weights' bones, and what they were made for.
  struct {
    std::shared_ptr<const Armature> armature;
    std::vector<std::string> bones;
    std::shared_ptr<const std::vector<glm::vec3>> colours;
  } swatches;
};

// What is painted, or else the document's; null without a volume and a rig.
std::shared_ptr<const SkinWeights> seen_weights(const Editor& editor);
int weights_bone(const SkinWeights& weights, const std::string& name);  // -1: none of that name
// As lists show it: the active bone's is orange.
Colour swatch_of(Editor& editor, int bone);

// Puts weights, regions and the Skin workspace's bones into the scene of this frame.
void show_weights(Editor& editor);

// Whether the voxels of the scene are the document's, whole or in part.
bool is_of_document(const Editor& editor, const std::shared_ptr<const LabelVolume>& volume);

// mm from the middle of a tissue voxel to where air begins.
double depth_of(const LabelVolume& volume, const glm::ivec3& voxel);

bool is_locked(const Document& document, const std::string& bone);
// An edit; none where nothing changes.
void set_locks(Editor& editor, const std::string& label, std::set<std::string> bones);
void toggle_lock(Editor& editor, int bone);
// All bones but this one; where that is so already, none.
void lock_all_but(Editor& editor, int bone);

// The region of a bone is where it has the largest weight.
void hide_region(Editor& editor, const std::string& bone, bool hidden);
// Only these; a second time shows all again.
void isolate_regions(Editor& editor, const std::set<std::string>& bones);

const char* name_of(const std::optional<render::WeightDisplay>& display);

}  // namespace limber::editor
