// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/passes/pass_resources.h"

#include <algorithm>
#include <utility>

#include <epoxy/gl.h>

#include "core/base/error.h"
#include "render/gl/egl_context.h"

namespace limber::render {

namespace {

int texture_limit(int largest_texture) {
  require_opengl_3_3();
  GLint most = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &most);
  return largest_texture > 0 ? std::min<int>(most, largest_texture) : most;
}

// Returns true if a weak pointer refers to the object that `owner` shares. The comparison also works after the object
// has been destroyed.
template <class T, class Owner>
bool same(const std::weak_ptr<T>& key, const Owner& owner) {
  return !key.owner_before(owner) && !owner.owner_before(key);
}

}  // namespace

PassResources::PassResources(int largest) : limits{texture_limit(largest)} {}

PassResources::Body& PassResources::body(const std::shared_ptr<const LabelVolume>& volume) {
  auto found = std::find_if(bodies_.begin(), bodies_.end(), [&](const auto& body) { return same(body->key, volume); });
  if (found == bodies_.end()) {
    forget_expired();
    std::unique_ptr<Body> fresh;
    if (arriving_ && same(arriving_->key, volume)) {  // finishes the pending uploads now, because the volume is needed
      fresh = std::move(arriving_);
      fresh->volume->upload(nullptr);
      for (const auto& layer : fresh->layers) layer->upload(*fresh->volume, nullptr);
    } else {
      fresh = std::make_unique<Body>();
      fresh->revision = ++revisions_, ++uploads_;
      fresh->key = volume;
      fresh->volume = std::make_unique<VolumeTexture>(volume, limits);
    }
    found = bodies_.insert(bodies_.end(), std::move(fresh));
  }
  note = (*found)->volume->note();
  return **found;
}

void PassResources::forget_expired() {
  std::erase_if(bodies_, [](const auto& body) { return body->key.expired(); });
  if (arriving_ && arriving_->key.expired()) arriving_.reset();
}

bool PassResources::has(const std::shared_ptr<const LabelVolume>& volume) const {
  return std::any_of(bodies_.begin(), bodies_.end(), [&](const auto& body) { return same(body->key, volume); });
}

void PassResources::relabel(const std::shared_ptr<const LabelVolume>& before,
                            const std::shared_ptr<const LabelVolume>& now, const VoxelBox& box, Surface surface) {
  const auto found =
      std::find_if(bodies_.begin(), bodies_.end(), [&](const auto& body) { return same(body->key, before); });
  if (found == bodies_.end() || (before != now && has(now))) return;
  Body& body = **found;
  std::vector<std::uint8_t> changed;
  if (!body.volume->relabel(now, box, changed)) {
    bodies_.erase(found);
    return;
  }
  body.key = now;
  for (Looks& known : looks_)
    if (same(known.volume, before)) known.volume = now;
  body.changed.resize(body.layers.size());
  for (auto& slots : body.changed) {
    slots.resize(changed.size(), 0);
    for (std::size_t s = 0; s < changed.size(); ++s) slots[s] |= changed[s];
  }
  body.surface_waits = surface == Surface::Waits;
  body.weights.reset();
  body.pose.reset();
  body.posed_hulls.clear();
  body.revision = ++revisions_;
}

int PassResources::revision_of(const std::shared_ptr<const LabelVolume>& volume) const {
  for (const auto& body : bodies_)
    if (same(body->key, volume)) return body->revision;
  return 0;
}

bool PassResources::upload(PreparedBody& prepared) {
  if (has(prepared.original)) return true;
  if (!arriving_ || !same(arriving_->key, prepared.original)) {
    forget_expired();
    arriving_.reset();
    auto fresh = std::make_unique<Body>();
    fresh->revision = ++revisions_, ++uploads_;
    fresh->key = prepared.original;
    fresh->volume = std::make_unique<VolumeTexture>(std::move(prepared.volume));
    arriving_ = std::move(fresh);
  }
  try {
    if (!upload_part(*arriving_, prepared)) return false;
  } catch (...) {
    arriving_.reset();
    throw;
  }
  bodies_.push_back(std::move(arriving_));
  return true;
}

bool PassResources::upload_part(Body& body, PreparedBody& prepared) {
  UploadTime* time = upload_time ? &*upload_time : nullptr;
  body.volume->upload(time);
  if (!body.volume->complete()) return false;
  for (PreparedField& field : std::exchange(prepared.layers, {}))
    body.layers.push_back(std::make_unique<VisibleField>(*body.volume, std::move(field)));
  for (const auto& layer : body.layers) {
    layer->upload(*body.volume, time);
    if (!layer->complete()) return false;
  }
  return true;
}

const LooksTexture& PassResources::looks(const Body& body, const std::shared_ptr<const LabelLooks>& looks,
                                         Display display) {
  for (const Looks& known : looks_)
    if (same(known.key, looks) && same(known.volume, body.volume->original()) && known.display == display)
      return *known.texture;
  std::erase_if(looks_, [](const Looks& known) { return known.key.expired() || known.volume.expired(); });
  auto texture = std::make_unique<LooksTexture>(*looks, display, body.volume->exposure());
  return *looks_.emplace_back(Looks{looks, body.volume->original(), display, std::move(texture)}).texture;
}

const VisibleField& PassResources::layer(Body& body, const LooksTexture& looks, size_t layer) {
  if (body.layers.size() <= layer) body.layers.resize(layer + 1);
  auto& field = body.layers[layer];
  const LabelSet& set = looks.layers()[layer];
  if (body.changed.size() <= layer) body.changed.resize(layer + 1);
  std::vector<std::uint8_t>& changed = body.changed[layer];
  const bool relabelled = !body.surface_waits && std::find(changed.begin(), changed.end(), 1) != changed.end();
  if (!field) field = std::make_unique<VisibleField>(*body.volume, set);
  else if (field->set() != set || relabelled) field->update(*body.volume, set, changed);
  else return *field;
  changed.clear();
  return *field;
}

const PosedTexture* PassResources::pose(Body& body, const std::shared_ptr<const PreviewMap>& map) {
  if (!map) return nullptr;
  if (const auto volume = body.volume->original().lock(); !volume || !(map->grid == volume->grid))
    throw Error("the pose was made for another volume", "preview of a posed body", "pose the volume that is shown");
  if (!body.pose) body.pose = std::make_unique<PosedTexture>();
  if (body.pose->map() != map) body.pose->upload(map, limits.side);
  return body.pose.get();
}

WeightTexture* PassResources::weights(Body& body, const std::optional<ShownWeights>& shown, Extent extent) {
  if (!shown) return nullptr;
  if (const auto volume = body.volume->original().lock(); !volume || shown->tissue->grid_size() != volume->grid.size)
    throw Error("the weights were made for another volume", "display of weights",
                "show the volume that they belong to");
  if (!body.weights) body.weights = std::make_unique<WeightTexture>(*body.volume);
  body.weights->update(*body.volume, *shown, extent == Extent::InTime && upload_time ? &*upload_time : nullptr);
  return body.weights.get();
}

const PosedHull* PassResources::posed_hull(Body& body, size_t layer, const std::shared_ptr<const PreviewMap>& map) {
  if (!map) return nullptr;
  if (body.posed_hulls.size() <= layer) body.posed_hulls.resize(layer + 1);
  auto& hull = body.posed_hulls[layer];
  if (!hull) hull = std::make_unique<PosedHull>();
  hull->update(map, *body.volume, *body.layers[layer]);
  return hull.get();
}

GreyTexture* PassResources::grey(const std::optional<ShownGrey>& shown, Extent extent) {
  if (!shown || !shown->image) return nullptr;
  constexpr std::size_t kMost = 2;
  auto found = std::find_if(greys_.begin(), greys_.end(),
                            [&](const auto& grey) { return same(grey->original(), shown->image); });
  if (found == greys_.end()) {
    // Frees the textures of destroyed images before the next image needs memory.
    std::erase_if(greys_, [](const auto& grey) { return grey->original().expired(); });
    if (greys_.size() == kMost) greys_.erase(greys_.begin());
    found = greys_.insert(greys_.end(), std::make_unique<GreyTexture>(shown->image, limits.side));
  }
  (*found)->upload(extent == Extent::InTime && upload_time ? &*upload_time : nullptr);
  return found->get();
}

VolumePass& PassResources::volume_pass(const VolumeTexture& volume, VolumePass::Space space) {
  auto& pass = volume_passes_[{volume.layout().atlases, space}];
  if (!pass) pass = std::make_unique<VolumePass>(volume.layout().atlases, space);
  return *pass;
}

}  // namespace limber::render
