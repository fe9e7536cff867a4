// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/weight_display.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/parallel.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/platform_window.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/labels/label_brush.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/painted_region.h"
#include "editor/skin/painting.h"
#include "editor/ui/ui.h"
#include "render/scene/weight_colormap.h"

namespace limber::editor {

namespace {

// Largest number of tissue voxels whose weights are summed in the editor's thread (some milliseconds). The weights of a
// larger body are summed in another thread.
constexpr std::int64_t kCountedAtOnce = 1'500'000;

void add(const SkinWeights::Chunk& chunk, std::vector<std::int64_t>& sums, int sign) {
  for (const Influence& influence : chunk)
    for (int i = 0; i < 4; ++i) sums[influence.bone[i]] += sign * std::int64_t{influence.weight[i]};
}

std::shared_ptr<const LabelVolume> without_regions(const LabelVolume& volume, const TissueVoxels& tissue,
                                                   const SkinWeights& weights, const std::set<std::string>& hidden) {
  std::vector<std::uint8_t> is_hidden;
  for (const std::string& bone : weights.bones()) is_hidden.push_back(hidden.contains(bone));
  auto rest = std::make_shared<LabelVolume>(volume);
  parallel_for(std::ssize(tissue.bricks()), 64, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t b = begin; b < end; ++b) {
      const SkinWeights::Chunk& chunk = weights.chunk(b);
      tissue.for_each(b, b + 1, [&](std::int64_t place, const glm::ivec3& voxel) {
        if (is_hidden[chunk[place - tissue.bricks()[b].first].bone[0]]) rest->at(voxel) = 0;
      });
    }
  });
  return rest;
}

// Returns a colour for each bone of `weights`, in the order of weights.bones().
const std::shared_ptr<const std::vector<glm::vec3>>& swatches(Context& context, const SkinWeights& weights) {
  auto& known = context.skin->swatches;
  const auto& armature = context.document().armature;
  if (known.colours && known.armature == armature && known.bones == weights.bones()) return known.colours;
  const std::vector<glm::vec3> of_rig = render::bone_swatches(*armature);
  std::vector<glm::vec3> colours;
  for (const std::string& name : weights.bones()) {
    const auto bone = armature->find(name);
    colours.push_back(bone ? of_rig[*bone] : render::kExactZero);
  }
  known = {armature, weights.bones(), std::make_shared<const std::vector<glm::vec3>>(std::move(colours))};
  return known.colours;
}

void show_regions(Context& context, const std::shared_ptr<const SkinWeights>& weights) {
  SkinDisplay& skin = *context.skin;
  render::Scene& scene = context.views->scene;
  auto& region = skin.region;
  if (skin.hidden.empty()) return void(region = {});
  const auto volume = scene.volume;
  // `weights` are the document's weights, not those of a running stroke. So the tissue under the brush stays visible
  // until the stroke ends, even if the stroke gives it to a bone whose region is hidden.
  const bool stale = region.from != volume || region.hidden != skin.hidden || region.weights != weights;
  if (stale && !(skin.region_task && context.background->tasks.contains(*skin.region_task))) {
    const auto make = [volume, weights, hidden = skin.hidden,
                       tissue = tissue_voxels(*context.views, context.document()),
                       old = region.from == volume ? region.volume : nullptr] {
      auto made = without_regions(*volume, *tissue, *weights, hidden);
      // If the old volume has the same voxels as the new one, return the old one: this avoids an upload to the GPU.
      return old && old->voxels == made->voxels ? old : made;
    };
    const auto keep = [volume, weights, hidden = skin.hidden](Context& c, std::shared_ptr<const LabelVolume> made) {
      if (!c.skin->hidden.empty()) c.skin->region = {volume, std::move(made), weights, hidden};
      c.ui->touch();
    };
    if (weights->size() <= skin.painting->edited_at_once) keep(context, make());
    else
      skin.region_task = start_task(context, "", [make, keep](Progress&) -> Finish {
        return [keep, made = make()](Context& c) { keep(c, made); };
      });
  }
  if (region.from == volume) scene.volume = region.volume;
}

}  // namespace

SkinDisplay::SkinDisplay() : painting(std::make_unique<Painting>()) {}
SkinDisplay::~SkinDisplay() = default;

WeightShares::Counted WeightShares::count(const std::shared_ptr<const SkinWeights>& weights) {
  constexpr std::int64_t kGrain = 512;  // number of bricks that one parallel work block sums
  const std::int64_t blocks = (weights->chunk_count() + kGrain - 1) / kGrain;
  std::vector<std::vector<std::int64_t>> sums(static_cast<std::size_t>(blocks));
  parallel_for(weights->chunk_count(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    auto& sum = sums[static_cast<std::size_t>(begin / kGrain)];
    sum.assign(weights->bones().size(), 0);
    for (std::int64_t brick = begin; brick < end; ++brick) add(weights->chunk(brick), sum, 1);
  });
  Counted counted{weights, std::vector<std::int64_t>(weights->bones().size())};
  for (const auto& sum : sums)
    for (std::size_t bone = 0; bone < sum.size(); ++bone) counted.sums[bone] += sum[bone];
  return counted;
}

void WeightShares::update(const std::shared_ptr<const SkinWeights>& weights, const std::function<void()>& wake) {
  if (counting_.valid()) {
    if (counting_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    counted_ = counting_.get();
  }
  if (counted_.weights == weights) return;
  if (!weights) return void(counted_ = {});
  const bool same_body = counted_.weights && counted_.weights->size() == weights->size() &&
                         counted_.weights->chunk_count() == weights->chunk_count() &&
                         counted_.weights->bones().size() == weights->bones().size();
  std::int64_t other = 0;
  for (std::int64_t brick = 0; same_body && brick < weights->chunk_count(); ++brick)
    if (weights->shared_chunk(brick) != counted_.weights->shared_chunk(brick))
      other += std::ssize(weights->chunk(brick));
  if (same_body && other < kCountedAtOnce) {
    for (std::int64_t brick = 0; brick < weights->chunk_count(); ++brick) {
      if (weights->shared_chunk(brick) == counted_.weights->shared_chunk(brick)) continue;
      add(counted_.weights->chunk(brick), counted_.sums, -1);
      add(weights->chunk(brick), counted_.sums, 1);
    }
    counted_.weights = weights;
  } else if (weights->size() < kCountedAtOnce) {
    counted_ = count(weights);
  } else {
    counted_ = {};
    counting_ = std::async(std::launch::async, [weights, wake] {
      Counted counted = count(weights);
      wake();
      return counted;
    });
  }
}

std::optional<double> WeightShares::of(int bone) const {
  if (!counted_.weights || bone < 0 || bone >= std::ssize(counted_.sums) || counted_.weights->size() == 0)
    return std::nullopt;
  return static_cast<double>(counted_.sums[static_cast<std::size_t>(bone)]) /
         (static_cast<double>(counted_.weights->size()) * kFullWeight);
}

std::shared_ptr<const SkinWeights> seen_weights(const Context& context) {
  const Document& document = context.document();
  const auto& weights = context.views->preview_weights ? context.views->preview_weights : document.weights;
  return document.volume && document.armature ? weights : nullptr;
}

int weights_bone(const SkinWeights& weights, const std::string& name) {
  const auto found = std::find(weights.bones().begin(), weights.bones().end(), name);
  return found == weights.bones().end() ? -1 : static_cast<int>(found - weights.bones().begin());
}

Colour swatch_of(Context& context, int bone) {
  if (skin_bone(context) == bone) return context.ui->look.theme.select;
  const auto weights = seen_weights(context);
  const int place =
      weights ? weights_bone(*weights, context.document().armature->bones[static_cast<std::size_t>(bone)].name) : -1;
  if (place < 0) return context.ui->look.theme.text3;
  const glm::vec3 colour = (*swatches(context, *weights))[static_cast<std::size_t>(place)];
  return rgb(colour.r, colour.g, colour.b);
}

void show_weights(Context& context) {
  render::Scene& scene = context.views->scene;
  follow_label_edits(*context.views, *context.skin->painting->labels, context.document().volume);
  scene.weights.reset();
  if (context.workspace() != Workspace::Skin) return;
  const auto bone = skin_bone(context);
  if (scene.armature) {
    scene.bone_shape = render::BoneShape::Stick;
    scene.bones_in_front = true;
    if (bone && *bone < std::ssize(scene.bones))
      scene.bones[static_cast<std::size_t>(*bone)].active = scene.bones[static_cast<std::size_t>(*bone)].selected =
          true;
  }
  if (context.skin->painting->labels->on) return show_label_stroke(*context.views, *context.skin->painting->labels);
  const auto weights = seen_weights(context);
  context.skin->shares.update(weights, [&host = *context.host] { host.wake(); });
  if (context.skin->shares.busy()) context.ui->touch();
  if (!weights || !bone || scene.volume != context.document().volume) return;
  if (tissue_voxels(*context.views, context.document())->size() != weights->size()) return;
  if (context.document().weights) show_regions(context, context.document().weights);
  if (!context.skin->display) return;
  scene.outlined.reset();  // selected tissues get no outline, so that it does not hide the colours of the weights
  scene.weights = render::ShownWeights{
      .weights = weights,
      .tissue = tissue_voxels(*context.views, context.document()),
      .display = *context.skin->display,
      .bone = weights_bone(*weights, context.document().armature->bones[static_cast<std::size_t>(*bone)].name),
      .swatches = swatches(context, *weights),
      .region = painted_region(context),
      .contours = context.skin->contours};
}

bool is_of_document(const Context& context, const std::shared_ptr<const LabelVolume>& volume) {
  if (context.skin->painting->labels->paints(volume)) return true;
  return volume && (volume == context.document().volume ||
                    (volume == context.skin->region.volume && context.skin->region.from == context.document().volume));
}

double depth_of(const LabelVolume& volume, const glm::ivec3& voxel) {
  const Grid& grid = volume.grid;
  const glm::dvec3 s = grid.spacing;
  double nearest = 1e300;  // squared distance to the nearest air voxel found so far, mm2
  // Search for air around `voxel` with growing distance along each axis. Skip voxels that are farther away than the
  // nearest air voxel found so far.
  const auto within = [&](int off, int axis) { return (off * s[axis]) * (off * s[axis]) < nearest; };
  for (int dz = 0; within(dz, 2); ++dz) {
    bool any = false;
    for (const int z : {voxel.z - dz, voxel.z + dz}) {
      any |= z >= -1 && z <= grid.size.z;
      if (z < -1 || z > grid.size.z) continue;
      for (int dy = 0; within(dy, 1) && (dy * s.y) * (dy * s.y) + (dz * s.z) * (dz * s.z) < nearest; ++dy) {
        if (voxel.y - dy < -1 && voxel.y + dy > grid.size.y) break;
        for (const int y : {voxel.y - dy, voxel.y + dy}) {
          if (y < -1 || y > grid.size.y) continue;
          const double rest = (dy * s.y) * (dy * s.y) + (dz * s.z) * (dz * s.z);
          for (int dx = 0; rest + (dx * s.x) * (dx * s.x) < nearest; ++dx)
            if (volume.at_or_air({voxel.x - dx, y, z}) == 0 || volume.at_or_air({voxel.x + dx, y, z}) == 0)
              nearest = rest + (dx * s.x) * (dx * s.x);
        }
      }
    }
    if (!any) break;
  }
  // `nearest` is measured to the centre of the air voxel, so half of this voxel's edge is subtracted.
  return std::max(0.0, std::sqrt(nearest) - std::min({s.x, s.y, s.z}) / 2);
}

bool is_locked(const Document& document, const std::string& bone) {
  return document.locks && document.locks->bones.contains(bone);
}

void set_locks(Context& context, const std::string& label, std::set<std::string> bones) {
  const std::set<std::string> before =
      context.document().locks ? context.document().locks->bones : std::set<std::string>{};
  if (bones == before) return;
  Document next = context.document();
  next.locks = std::make_shared<const WeightLocks>(WeightLocks{std::move(bones)});
  commit(context, label, std::move(next));
}

void toggle_lock(Context& context, int bone) {
  const std::string name = context.document().armature->bones[static_cast<std::size_t>(bone)].name;
  std::set<std::string> bones = context.document().locks ? context.document().locks->bones : std::set<std::string>{};
  const bool locked = bones.erase(name) > 0;
  if (!locked) bones.insert(name);
  set_locks(context, (locked ? "Unlock " : "Lock ") + name, std::move(bones));
}

void lock_all_but(Context& context, int bone) {
  const Armature& armature = *context.document().armature;
  const std::string name = armature.bones[static_cast<std::size_t>(bone)].name;
  std::set<std::string> others;
  for (const Bone& other : armature.bones)
    if (other.name != name) others.insert(other.name);
  const bool so_already = context.document().locks && context.document().locks->bones == others;
  set_locks(context, so_already ? "Unlock all bones" : "Lock all but " + name,
            so_already ? std::set<std::string>{} : others);
}

void hide_region(Context& context, const std::string& bone, bool hidden) {
  if (hidden) context.skin->hidden.insert(bone);
  else context.skin->hidden.erase(bone);
  context.ui->touch();
}

void isolate_regions(Context& context, const std::set<std::string>& bones) {
  std::set<std::string> others;
  for (const Bone& bone : context.document().armature->bones)
    if (!bones.contains(bone.name)) others.insert(bone.name);
  context.skin->hidden = context.skin->hidden == others ? std::set<std::string>{} : others;
  context.ui->touch();
}

const char* name_of(const std::optional<render::WeightDisplay>& display) {
  if (!display) return "Tissues";
  switch (*display) {
    case render::WeightDisplay::Active: return "Active bone weight";
    case render::WeightDisplay::Dominant: return "Dominant bones";
    case render::WeightDisplay::Mixed: return "All influences";
    case render::WeightDisplay::Count:
    case render::WeightDisplay::Field: break;
  }
  return "Number of influences";
}

}  // namespace limber::editor
