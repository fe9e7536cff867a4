// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/view.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include <epoxy/gl.h>

#include "core/deform/preview_map.h"
#include "render/passes/pass_resources.h"

namespace limber::render {

namespace {

constexpr double kRest = 0.1;          // time without a change after which the picture is refined, seconds
constexpr double kFrame = 0.024;       // time limit for drawing the body while something moves, seconds
constexpr double kTileBudget = 0.018;  // time limit for refining the picture in one call, seconds
constexpr int kTile = 128;             // edge length of the square tiles in which the picture is refined, pixels
constexpr int kLightTile = 64;         // edge length of a tile in pictures with light by rays, pixels
// Edge length of a tile of a grey image, whose rays take ten times as long, pixels.
constexpr int kImageTile = 40;
constexpr int kCoarsestImage = 8;  // coarsest scale of a moving picture of a grey image
constexpr int kImagePictures = 2;  // at most this many pictures of a grey image are averaged
// Length of the steps of rays through a grey image, in voxels of the image: in a picture in full resolution, and while
// something moves.
constexpr double kFineStep = 0.7, kCoarseStep = 1.4;
// While something moves, the steps are at least this long compared with the distance between neighbouring rays.
constexpr double kStepOfPixel = 0.7;

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// Restores the caller's framebuffer binding when it is destroyed, and resets depth, scissor and blend states.
class KeepFramebuffer {
 public:
  KeepFramebuffer() { glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound_); }
  ~KeepFramebuffer() {
    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(bound_));
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
  }
  KeepFramebuffer(const KeepFramebuffer&) = delete;
  KeepFramebuffer& operator=(const KeepFramebuffer&) = delete;

 private:
  GLint bound_ = 0;
};

// A texture, and a framebuffer that draws into it.
class Target {
 public:
  void resize(const glm::ivec2& size, GLint internal) {
    if (size == size_) return;
    if (!framebuffer_) framebuffer_ = gl::Framebuffer::create(), texture_ = gl::Texture::create();
    size_ = size;
    glBindTexture(GL_TEXTURE_2D, texture_.name());
    glTexImage2D(GL_TEXTURE_2D, 0, internal, size.x, size.y, 0, GL_RGBA,
                 internal == GL_RGBA8 ? GL_UNSIGNED_BYTE : GL_FLOAT, nullptr);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      glTexParameteri(GL_TEXTURE_2D, axis, GL_CLAMP_TO_EDGE);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_.name(), 0);
  }
  // Attaches the hull depth of a buffer of the same size, so that passes can skip the pixels that the hull does not
  // cover.
  void share_depth(const gl::Texture& depth) const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth.name(), 0);
  }
  void bind() const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, size_.x, size_.y);
  }
  void clear() const {
    bind();
    glDisable(GL_SCISSOR_TEST);
    const float nothing[4] = {0, 0, 0, 0};
    glClearBufferfv(GL_COLOR, 0, nothing);
  }
  const gl::Texture& texture() const { return texture_; }
  GLuint framebuffer() const { return framebuffer_.name(); }
  const glm::ivec2& size() const { return size_; }

 private:
  gl::Framebuffer framebuffer_;
  gl::Texture texture_;
  glm::ivec2 size_{0};
};

Image read_back(const Target& target, bool premultiplied) {
  const KeepFramebuffer keep;
  Image image;
  image.size = target.size();
  std::vector<std::uint8_t> rows(static_cast<size_t>(image.size.x) * image.size.y * 4);
  target.bind();
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, image.size.x, image.size.y, GL_RGBA, GL_UNSIGNED_BYTE, rows.data());
  gl::check_gl("reading a picture");
  image.rgba.resize(rows.size());
  const size_t row = static_cast<size_t>(image.size.x) * 4;
  for (int y = 0; y < image.size.y; ++y)
    std::copy_n(rows.data() + static_cast<size_t>(image.size.y - 1 - y) * row, row,
                image.rgba.data() + static_cast<size_t>(y) * row);
  if (premultiplied)
    for (size_t i = 0; i < image.rgba.size(); i += 4) {
      const int alpha = image.rgba[i + 3];
      for (size_t c = i; c < i + 3; ++c)
        image.rgba[c] = static_cast<std::uint8_t>(alpha ? std::min(255, (image.rgba[c] * 255 + alpha / 2) / alpha) : 0);
    }
  return image;
}

// Everything on which the hits of the body's rays depend. Equal pointers mean equal contents.
struct BodyKey {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const PreviewMap> pose;
  std::shared_ptr<const LabelLooks> looks;
  Display display{};
  std::optional<std::array<glm::dvec3, 2>> box, plane;
  Camera camera;
  glm::ivec2 size{0};
  bool places = false;            // true: the rest position of each pixel is needed, to look up its weights
  std::optional<ShownGrey> grey;  // the grey image that is drawn instead of the body; empty: the body is drawn
  int revision = 0;               // revision of the volume's labels (PassResources::relabel())

  bool operator==(const BodyKey&) const = default;
};
// Returns true if the 3D view shows the grey image instead of the body.
bool shows_image(const Scene& scene) { return scene.display == Display::Image && scene.grey && scene.grey->image; }
// Returns the settings on which the rendering of the image depends. Level and width are included only if the rendering
// uses them.
std::optional<ShownGrey> rendered_image(const Scene& scene) {
  if (!shows_image(scene)) return std::nullopt;
  ShownGrey grey = *scene.grey;
  grey.tissues = 0;
  if (grey.rendering != GreyRendering::Window && grey.rendering != GreyRendering::Maximum) grey.level = grey.width = 0;
  return grey;
}
BodyKey key_of(const Scene& scene, const Camera& camera, const glm::ivec2& size, bool places) {
  return {scene.volume,     scene.pose, scene.looks, scene.display, scene.clip.box,
          scene.clip.plane, camera,     size,        places,        rendered_image(scene)};
}

// These functions return true if two scenes have the same posed bones, the same bone highlights, and the same overlays
// on top of the body.
bool same_pose(const std::vector<RigidTransform>& a, const std::vector<RigidTransform>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& p, const auto& q) {
    return p.rotation == q.rotation && p.translation == q.translation;
  });
}
bool same_looks(const std::vector<BoneLook>& a, const std::vector<BoneLook>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& p, const auto& q) {
    return p.selected == q.selected && p.active == q.active && p.hovered == q.hovered;
  });
}
bool same_overlay(const Scene& a, const Scene& b) {
  return a.armature == b.armature && same_pose(a.posed_from_rest, b.posed_from_rest) && same_looks(a.bones, b.bones) &&
         a.bone_shape == b.bone_shape && a.bones_in_front == b.bones_in_front && a.line_scale == b.line_scale &&
         a.grid == b.grid && a.dark_background == b.dark_background &&
         a.transparent_background == b.transparent_background && a.outlined == b.outlined && a.mesh == b.mesh;
}

// Returns the colour and width of the lines of a tet mesh, drawn on tissue colours or (on_tissue = false) on a slice
// that shows only outlines. Lines are fainter where the tets appear smaller, since they would hide what is below.
LinePass::Ink ink_of_mesh(const Scene& scene, const std::vector<Segment>& lines, bool on_tissue,
                          double millimetres_per_pixel) {
  // Mean lengths of the drawn lines, pixels at line scale 1: at kFaint and below they are faintest, at kClear and
  // above clearest.
  constexpr double kFaint = 1.5, kClear = 12;
  double length = 0;
  for (const Segment& line : lines) length += glm::distance(line[0], line[1]);
  const double pixels = length / std::max<double>(1, double(lines.size())) / (millimetres_per_pixel * scene.line_scale);
  const float share = static_cast<float>(std::clamp((pixels - kFaint) / (kClear - kFaint), 0.08, 1.0));
  return {on_tissue ? glm::vec3(0.05f, 0.055f, 0.07f) : glm::vec3(0.9f), share * (on_tissue ? 0.7f : 0.4f),
          scene.line_scale};
}

Background background_of(const Scene& scene) {
  return scene.transparent_background ? Background::Transparent
         : scene.dark_background      ? Background::Dark
                                      : Background::Light;
}

// Returns the box around the volume, or around the armature if there is no volume, in the world, mm.
std::array<glm::dvec3, 2> box_of(const Scene& scene) {
  glm::dvec3 low(1e300), high(-1e300);
  const auto take = [&](const glm::dvec3& p) { low = glm::min(low, p), high = glm::max(high, p); };
  if (scene.volume) {
    const AffineTransform to_world = world_from_voxel(scene.volume->grid);
    const glm::dvec3 size(scene.volume->grid.size);
    for (int corner = 0; corner < 8; ++corner)
      take(to_world * (glm::dvec3(corner & 1 ? size.x : 0, corner & 2 ? size.y : 0, corner & 4 ? size.z : 0) - 0.5));
  } else if (scene.armature) {
    for (const Bone& bone : scene.armature->bones) take(bone.head), take(bone.tail);
  }
  if (low.x > high.x) return {glm::dvec3(-500), glm::dvec3(500)};
  return {low, high};
}

// Returns element i of the Halton sequence. For any n, its first n elements are spread evenly over [0, 1).
double halton(int i, int base) {
  double result = 0, f = 1;
  for (; i > 0; i /= base) f /= base, result += f * (i % base);
  return result;
}
// Returns the offset of the rays of averaged picture `sample` from the pixel centres, pixels; 0 for the first picture.
glm::dvec2 jitter_of(int sample) {
  return sample == 0 ? glm::dvec2(0) : glm::dvec2(halton(sample, 2) - 0.5, halton(sample, 3) - 0.5);
}

// Returns the offset of the positions at which averaged picture `sample` reads labels, voxels. Averaging pictures with
// different offsets blends the borders between voxels.
glm::vec3 label_shift_of(int sample) {
  constexpr float kReach = 0.8f;  // the offset is at most this large along each axis, voxels
  if (sample == 0) return glm::vec3(0);
  return glm::vec3(halton(sample, 3) - 0.5, halton(sample, 5) - 0.5, halton(sample, 7) - 0.5) * 2.0f * kReach;
}

}  // namespace

struct View3D::Impl {
  explicit Impl(Renderer& renderer) : resources(renderer.resources()) {}

  PassResources& resources;
  Target output, body, average;
  Target lit;  // average of the pictures with fine (ray-traced) light
  // Pictures of the grey image: the picture that is shown, and the next one, which is drawn tile by tile.
  Target image, next_image;
  using Layers = std::array<GBuffer, kMostLayers>;
  Layers shown;                                // hits of the rays of the shown picture, the outermost layer first
  Layers jittered;                             // hits of the rays of the picture that will be averaged next
  std::array<LightBuffer, kMostLayers> light;  // fine light at the hits of `jittered`
  BodyKey key;
  Scene scene;  // the scene that was drawn last
  bool drawn = false;
  double changed_at = 0;
  int moving_scale = 3;  // the body is drawn at every n-th pixel while something moves
  int shown_scale = 0;   // scale at which the body was drawn (every n-th pixel); 0: no body
  int sample = 0;        // number of pictures in the averages so far; the pictures with fine light come last
  bool fine = false;     // true: the last picture was drawn with fine light switched on
  // Index of the next tile of the picture that will be averaged next; kNotStarted: its buffers are not cleared yet.
  static constexpr int kNotStarted = -1;
  int next_tile = kNotStarted;
  bool refines = false;  // true: the picture will be refined to full resolution and averaged (scale 0)
  PixelRect rect;        // the rectangle that the body covers, in pixels of the picture drawn at shown_scale
  std::int64_t rays_followed = 0;
  int image_slices = 0;    // slices of the grey image that were uploaded when the picture was drawn last
  int weight_changes = 0;  // value of WeightTexture::changes() when the picture was drawn last
  bool has_all_weights = true, has_whole_image = true;

  struct Source {
    PassResources::Body* body = nullptr;
    const LooksTexture* looks = nullptr;
    std::vector<const VisibleField*> layers;
    const PosedTexture* pose = nullptr;
    const WeightTexture* weights = nullptr;
    const GreyTexture* image = nullptr;         // the grey image to draw instead of the body; null: the body is drawn
    std::vector<const PosedHull*> posed_hulls;  // hull of the posed body for each layer; null at rest

    const Hull& hull(size_t layer) const {
      return posed_hulls[layer] ? posed_hulls[layer]->hull() : layers[layer]->hull();
    }
  };
  std::optional<Source> source(const Scene& scene, PassResources::Extent extent) {
    if (!scene.volume || !scene.looks) return std::nullopt;
    Source result;
    result.body = &resources.body(scene.volume);
    if (shows_image(scene)) result.image = resources.grey(scene.grey, extent);
    result.looks =
        &resources.looks(*result.body, scene.looks, scene.display == Display::Image ? Display::Solid : scene.display);
    result.pose = resources.pose(*result.body, scene.pose);
    result.weights = resources.weights(*result.body, scene.weights, extent);
    for (size_t layer = 0; layer < result.looks->layers().size(); ++layer) {
      result.layers.push_back(&resources.layer(*result.body, *result.looks, layer));
      result.posed_hulls.push_back(resources.posed_hull(*result.body, layer, scene.pose));
    }
    return result;
  }

  // Returns the corners of the box around what the picture shows, in padded coordinates.
  static std::array<glm::vec3, 2> shown_box(const Source& source) {
    const Hull& outer = source.hull(0);
    if (!source.image) return {outer.low(), outer.high()};
    const auto [low, high] = ImagePass::box(*source.body->volume, source.pose, *source.image);
    if (outer.empty()) return {glm::vec3(low), glm::vec3(high)};
    return {glm::min(glm::vec3(low), outer.low()), glm::max(glm::vec3(high), outer.high())};
  }
  // Returns the rectangle that the body or the image can cover in a picture of `size` pixels.
  static PixelRect covered_by(const Source& source, const ViewRays& rays, const glm::ivec2& size) {
    if (!source.image) return VolumePass::covered(source.hull(0), rays, size);
    const auto [low, high] = shown_box(source);
    return VolumePass::covered(low, high, rays, size);
  }

  ViewRays rays_of(const Source& source, const glm::ivec2& size, int sample) const {
    const auto [low, high] = shown_box(source);
    ViewRays rays = view_rays(key.camera, source.body->volume->grid(), size, jitter_of(sample), low, high);
    rays.label_shift = label_shift_of(sample);
    rays.mirrored_taps = sample % 2 != 0;
    return rays;
  }

  VolumePass& volume_pass(const Source& source) {
    return resources.volume_pass(*source.body->volume,
                                 source.pose ? VolumePass::Space::Posed : VolumePass::Space::Rest);
  }

  void start(const Source& source, const ViewRays& rays, Layers& buffers, const glm::ivec2& size,
             const PixelRect& part) {
    VolumePass& pass = volume_pass(source);
    for (size_t layer = 0; layer < source.layers.size(); ++layer) {
      buffers[layer].resize(size, key.places);
      pass.draw_hull(source.hull(layer), rays, buffers[layer], part);
    }
  }
  void march(const Source& source, const ViewRays& rays, const Layers& buffers, const PixelRect& part) {
    VolumePass& pass = volume_pass(source);
    if (!part.empty()) rays_followed += std::int64_t{part.high.x - part.low.x} * (part.high.y - part.low.y);
    for (size_t layer = 0; layer < source.layers.size(); ++layer)
      pass.march(*source.body->volume, *source.layers[layer], source.pose, source.posed_hulls[layer],
                 source.looks->texture(), static_cast<int>(layer), scene.clip, rays, buffers[layer], part);
  }
  // Draws a rectangle of the grey image into a target.
  //   step  length of a ray's steps, voxels of the image
  void draw_image(const Source& source, const ViewRays& rays, const Target& target, double step,
                  const PixelRect& part) {
    target.bind();
    resources.image.draw(*source.body->volume, source.pose, *source.image, *scene.grey, scene.clip, rays, step, part,
                         target.size());
    image_slices = source.image->uploaded();
  }
  // Returns the length of a ray's steps while something moves, voxels of the image. Steps much shorter than the
  // distance between the rays of a picture of `size` pixels would only cost time.
  double coarse_step(const Source& source, const glm::ivec2& size) const {
    const double pixel = 2 * key.camera.distance * std::tan(key.camera.field_of_view / 2) / size.y;
    const glm::dvec3& spacing = source.image->grid().spacing;
    return std::max(kCoarseStep, kStepOfPixel * pixel / std::min({spacing.x, spacing.y, spacing.z}));
  }
  ShadePass::Colours colours() const {
    if (!scene.weights) return ShadePass::Colours::Tissues;
    if (!scene.weights->contours) return ShadePass::Colours::Weights;
    return scene.weights->display == WeightDisplay::Active  ? ShadePass::Colours::WeightsWithContours
           : scene.weights->display == WeightDisplay::Mixed ? ShadePass::Colours::Weights
                                                            : ShadePass::Colours::WeightsWithBorders;
  }
  // Follows rays from the hits to the light, for one rectangle of a picture with fine light.
  void trace_light(const Source& source, const ViewRays& rays, int picture, const PixelRect& part) {
    for (size_t layer = 0; layer < source.layers.size(); ++layer)
      if (!is_ghost(layer))
        resources.light.draw(*source.body->volume, *source.layers[layer], source.pose, source.posed_hulls[layer],
                             scene.clip, rays, jittered[layer], light[layer], picture, part);
  }
  bool is_ghost(size_t layer) const { return layer == 0 && scene.display == Display::XRay; }
  void clear_body(const Layers& buffers) {
    body.resize(buffers[0].size(), GL_RGBA8);
    body.share_depth(buffers[0].hull_depth);
    body.clear();
  }
  void shade(const Source& source, const ViewRays& rays, const Layers& buffers, const PixelRect& part) {
    weigh(source, rays, buffers, part);
    clear_body(buffers);
    shade_layers(source, rays, buffers, part, false);
  }
  void weigh(const Source& source, const ViewRays& rays, const Layers& buffers, const PixelRect& part) {
    for (size_t layer = 0; source.weights && layer < source.layers.size(); ++layer)
      resources.weigh.draw(*source.body->volume, *source.weights, rays, buffers[layer], part);
    weight_changes = source.weights ? source.weights->changes() : 0;
  }
  // Shades the layers (surfaces of sets of labels) in one rectangle and adds them to the picture of the body.
  void shade_layers(const Source& source, const ViewRays& rays, const Layers& buffers, const PixelRect& part,
                    bool lit_by_rays) {
    // A coarse picture is stretched later, so its lines are narrower here.
    const float line =
        scene.line_scale * static_cast<float>(buffers[0].size().x) / static_cast<float>(std::max(key.size.x, 1));
    glBindFramebuffer(GL_FRAMEBUFFER, body.framebuffer());
    for (size_t layer = source.layers.size(); layer-- > 0;)
      resources.shade.draw(*source.body->volume, *source.layers[layer], source.pose, buffers[layer],
                           source.looks->texture(), rays, part, static_cast<int>(layer), is_ghost(layer), colours(),
                           lit_by_rays ? &light[layer] : nullptr, line);
  }

  // Draws the whole body at once, with one ray for each `scale`-th pixel along each axis.
  void draw_at_once(const Source& source, int scale) {
    const glm::ivec2 size = glm::max((key.size + scale - 1) / scale, glm::ivec2(1));
    const ViewRays rays = rays_of(source, size, 0);
    rect = covered_by(source, rays, size);
    start(source, rays, shown, size, rect);
    march(source, rays, shown, rect);
    if (source.image) {
      image.resize(size, GL_RGBA8);
      image.clear();
      draw_image(source, rays, image, scale == 1 ? kFineStep : coarse_step(source, size), rect);
    } else {
      shade(source, rays, shown, rect);
    }
    shown_scale = scale;
  }

  // Draws the whole body at once at the scale that the last picture suggests, and finds the scale for the next one.
  void draw_in_time(const Source& source) {
    const double begin = seconds();
    const int at = moving_scale;
    draw_at_once(source, at);
    glFinish();
    // Tries a finer scale if its expected time, which is proportional to its pixels, is below 85 % of kFrame.
    const double cost = seconds() - begin;
    if (cost > kFrame) moving_scale = std::min(at + 1, shows_image(scene) ? kCoarsestImage : kCoarsest);
    else if (at > 1 && cost * at * at / ((at - 1) * (at - 1)) < kFrame * 0.85) moving_scale = at - 1;
  }

  // Draws some tiles of the next picture to average. Returns true if the picture is complete and was averaged.
  // Pictures with fine light use the same rays as the other pictures, in two rounds over the tiles: the first follows
  // the rays, the second shades each pixel by the light around it.
  bool refine(const Source& source) {
    const double begin = seconds();
    const bool with_light = sample >= pictures();
    const int picture = with_light ? sample - pictures() : sample;
    ViewRays rays = rays_of(source, key.size, picture);
    rays.smooth_cuts = with_light;
    const PixelRect part = covered_by(source, rays, key.size);
    if (next_tile == kNotStarted) {
      start_picture(source, rays, part, with_light);
      next_tile = 0;
      glFinish();
      if (seconds() - begin >= kTileBudget / 2) return false;  // the buffers of a new size are slow at first use
    }
    const int edge = source.image ? kImageTile : with_light ? kLightTile : kTile;
    const glm::ivec2 tiles = (part.high - part.low + edge - 1) / edge;
    const int round = part.empty() ? 0 : tiles.x * tiles.y, count = with_light ? 2 * round : round;
    do {
      if (next_tile >= count) break;
      const int at = next_tile % round;
      const glm::ivec2 low = part.low + glm::ivec2(at % tiles.x, at / tiles.x) * edge;
      const PixelRect tile = intersection(part, {low, low + edge});
      if (next_tile < round) march(source, rays, jittered, tile);
      else weigh(source, rays, jittered, tile), shade_layers(source, rays, jittered, tile, true);
      if (with_light && next_tile < round) trace_light(source, rays, picture, tile);
      if (source.image) draw_image(source, rays, next_image, kFineStep, tile);
      ++next_tile;
      glFinish();
    } while (seconds() - begin < kTileBudget);
    if (next_tile < count) return false;

    if (!source.image && !with_light) shade(source, rays, jittered, part);
    Target& sum = with_light ? lit : average;
    sum.resize(key.size, GL_RGBA16F);
    if (picture == 0) sum.clear();
    sum.bind();
    const gl::Texture& drawn_picture = source.image ? next_image.texture() : body.texture();
    resources.compose.accumulate(drawn_picture, key.size, 1.0f / float(picture + 1), part);
    if (sample == 0) {
      std::swap(shown, jittered);
      rect = part;
    }
    shown_scale = 1;
    next_tile = kNotStarted;
    ++sample;
    return true;
  }
  void start_picture(const Source& source, const ViewRays& rays, const PixelRect& part, bool with_light) {
    start(source, rays, jittered, key.size, part);
    if (source.image) {
      next_image.resize(key.size, GL_RGBA8);
      next_image.clear();
    }
    if (!with_light) return;
    // Light and outlines read pixels outside the drawn rectangle too. Clears the buffers, so that no hits of earlier
    // pictures remain there.
    for (size_t layer = 0; layer < source.layers.size(); ++layer) {
      jittered[layer].forget_hits();
      light[layer].resize(jittered[layer], source.pose ? 2 : 1);
    }
    clear_body(jittered);
  }

  // Shades the stored hits of the rays again, with other weights or with another display of the weights.
  //   only_weights  true: nothing but the weights themselves has changed
  void recolour(const Source& source, bool only_weights) {
    if (only_weights && source.weights->changes() == weight_changes) return;
    const ViewRays rays = rays_of(source, shown[0].size(), 0);
    PixelRect part = rect;
    const auto changed =
        only_weights && !source.pose && sample > 0 ? source.weights->changed_since(weight_changes) : std::nullopt;
    if (changed)
      part = intersection(
          part, VolumePass::covered(glm::vec3(changed->low), glm::vec3(changed->high), rays, shown[0].size()));
    shade(source, rays, shown, part);
    if (sample == 0) return;
    // Replaces the average in the changed rectangle by the new picture, and starts to refine it again.
    average.bind();
    resources.compose.accumulate(body.texture(), key.size, 1, part);
    sample = 1;
    next_tile = kNotStarted;
  }

  // Returns the rectangle of the output that the body can cover, with a margin for outlines and for pixels stretched at
  // a coarse scale.
  PixelRect shown_rect() const {
    const int margin = shown_scale + 1 + static_cast<int>(std::ceil(2 * scene.line_scale));
    return intersection({{0, 0}, key.size}, {rect.low * shown_scale - margin, rect.high * shown_scale + margin});
  }

  // The lines along which the clip plane and box cut the mesh, cached with the inputs from which they were computed.
  struct {
    CutMesh mesh;
    Clip clip;
    std::shared_ptr<const LabelVolume> volume;
    std::vector<Segment> lines;
  } cut;
  void draw_mesh() {
    if (!(cut.mesh == *scene.mesh) || cut.clip.box != scene.clip.box || cut.clip.plane != scene.clip.plane ||
        cut.volume != scene.volume)
      cut = {*scene.mesh, scene.clip, scene.volume, lines_on_cuts(*scene.mesh, scene.clip, scene.volume->grid)};
    // A cut face seen at a slant has several depths within one pixel of the body's picture, so `off` allows for two
    // such pixels.
    const double pixel = 2 * key.camera.distance * std::tan(key.camera.field_of_view / 2) / key.size.y;
    // Lines are drawn where their depth differs from the body's surface by at most this, mm.
    const float off = static_cast<float>(1 + 2 * pixel * shown_scale);
    resources.lines.draw(cut.lines, key.camera, key.size, shown[0].depth, off,
                         ink_of_mesh(scene, cut.lines, true, pixel));
  }

  void compose() {
    output.bind();
    resources.compose.background(background_of(scene), key.size);
    const auto [low, high] = box_of(scene);
    if (scene.grid && !scene.transparent_background)
      resources.compose.grid(key.camera, key.size, (low + high) / 2.0, low.z,
                             std::max(600.0, glm::length(high - low) * 1.5), scene.line_scale);
    const bool has_body = shown_scale > 0;
    const gl::Texture& first = shows_image(scene) ? image.texture() : body.texture();
    // While pictures with fine light are added, their average is blended in with growing weight.
    if (has_body && sample > pictures())
      resources.compose.bodies(average.texture(), lit.texture(), float(sample - pictures()) / float(lit_pictures()),
                               key.size, shown_rect());
    else if (has_body) resources.compose.body(sample > 0 ? average.texture() : first, key.size, shown_rect());
    if (has_body && scene.outlined)
      resources.compose.outline(shown[0], *scene.outlined, key.size, shown_rect(), scene.line_scale);
    if (has_body && scene.mesh) draw_mesh();
    resources.armature.draw(
        scene, key.camera, key.size,
        has_body && scene.display != Display::XRay && !shows_image(scene) ? &shown[0].depth : nullptr);
    gl::check_gl("drawing a picture");
  }

  // Returns the number of pictures to average. A grey image gets fewer, because they take ten times as long and have
  // no hard edges.
  int pictures() const {
    return shows_image(scene) ? std::min(kImagePictures, resources.pictures_at_rest) : resources.pictures_at_rest;
  }
  // Returns the number of pictures with fine light that are averaged after the other pictures.
  int lit_pictures() const { return resources.fine_light && !shows_image(scene) ? pictures() : 0; }
  bool complete() const {
    return drawn && has_all_weights && has_whole_image && fine == resources.fine_light &&
           (!refines || sample >= pictures() + lit_pictures());
  }
};

View3D::View3D(Renderer& renderer) : impl_(std::make_unique<Impl>(renderer)) {}
View3D::~View3D() = default;

void View3D::draw(const Scene& scene, const Camera& camera, const glm::ivec2& size, double now, int scale) {
  Impl& my = *impl_;
  BodyKey key = key_of(scene, camera, size, my.key.places || scene.weights.has_value());
  key.revision = my.resources.revision_of(scene.volume);
  const bool moved = !my.drawn || key != my.key || (scale > 0 && (my.shown_scale != scale || my.sample > 0));
  const bool overlay_changed = !my.drawn || !same_overlay(scene, my.scene);
  const bool recoloured = my.drawn && scene.weights != my.scene.weights;
  if (!moved && !recoloured && !overlay_changed && my.complete()) return;

  const KeepFramebuffer keep;
  // The drawing time of a new body is not known yet, so its first picture has the coarsest scale.
  const LabelVolume *last = my.scene.volume.get(), *next = scene.volume.get();
  if (next && (!last || last->grid.size != next->grid.size || shows_image(my.scene) != shows_image(scene)) &&
      my.resources.pictures_at_rest > 0)
    my.moving_scale = shows_image(scene) ? kCoarsestImage : kCoarsest;
  ShownWeights before = my.scene.weights.value_or(ShownWeights{});
  if (scene.weights) before.weights = scene.weights->weights;
  my.key = key;
  my.scene = scene;
  my.output.resize(size, GL_RGBA8);
  const auto source = my.source(scene, scale == 0 ? PassResources::Extent::InTime : PassResources::Extent::Whole);
  my.key.revision = my.resources.revision_of(scene.volume);  // drawing may have uploaded the volume
  my.refines = scale == 0 && source;
  my.has_all_weights = !source || !source->weights || source->weights->complete();
  my.has_whole_image = !source || !source->image || source->image->complete();
  const bool more_weights = my.drawn && source && source->weights && source->weights->changes() != my.weight_changes;
  const bool more_image = my.drawn && source && source->image && source->image->uploaded() != my.image_slices;
  bool redraw = overlay_changed || moved || recoloured || more_weights || more_image;
  if (my.fine != my.resources.fine_light) {
    my.fine = my.resources.fine_light;
    if (my.sample >= my.pictures()) my.sample = my.pictures(), my.next_tile = Impl::kNotStarted, redraw = true;
  }
  if (!source) {
    my.shown_scale = 0;
    my.sample = 0;
  } else if (moved || more_image) {
    my.changed_at = now;
    my.sample = 0;
    my.next_tile = Impl::kNotStarted;
    if (scale > 0 || my.resources.pictures_at_rest == 0) my.draw_at_once(*source, scale > 0 ? scale : my.moving_scale);
    else my.draw_in_time(*source);
  } else if ((recoloured || more_weights) && !source->image) {
    my.changed_at = now;
    my.recolour(*source, scene.weights == before);
  } else if (my.refines && my.sample == 0 && source->image && my.moving_scale < my.shown_scale) {
    my.draw_in_time(*source);  // the image is refined for seconds, so a less coarse picture is shown first
    redraw = true;
  } else if (my.refines && my.sample < my.pictures() + my.lit_pictures() && now - my.changed_at >= kRest) {
    redraw |= my.refine(*source);
  }
  my.drawn = true;
  if (redraw) my.compose();
}

bool View3D::complete() const { return impl_->complete(); }
int View3D::scale() const { return impl_->shown_scale; }
std::int64_t View3D::rays_followed() const { return impl_->rays_followed; }
unsigned View3D::texture() const { return impl_->output.texture().name(); }
Image View3D::read() const { return read_back(impl_->output, impl_->scene.transparent_background); }

std::vector<Label> View3D::shown_labels(int pixels) const {
  Impl& my = *impl_;
  if (!my.drawn || my.shown_scale == 0 || shows_image(my.scene)) return {};
  const KeepFramebuffer keep;
  const auto source = my.source(my.scene, PassResources::Extent::Whole);
  const LabelLooks& looks = *my.scene.looks;
  const glm::ivec2 size = my.shown[0].size();
  const size_t count = static_cast<size_t>(size.x) * static_cast<size_t>(size.y);
  std::vector<std::uint16_t> labels(count);
  std::vector<std::uint8_t> hidden(count);  // for each pixel, 1 if an opaque tissue lies in front
  std::vector<int> shown(65536);
  for (size_t layer = 0; layer < source->layers.size(); ++layer) {
    glBindFramebuffer(GL_FRAMEBUFFER, my.shown[layer].march_target.name());
    glReadBuffer(GL_COLOR_ATTACHMENT2);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, size.x, size.y, GL_RED_INTEGER, GL_UNSIGNED_SHORT, labels.data());
    glReadBuffer(GL_COLOR_ATTACHMENT0);
    const LabelSet* deeper = layer + 1 < source->layers.size() ? &source->looks->layers()[layer + 1] : nullptr;
    for (size_t i = 0; i < count; ++i) {
      const Label label = labels[i];
      if (label == 0 || hidden[i] || (deeper && (*deeper)[label])) continue;
      ++shown[label];
      hidden[i] = my.scene.display == Display::Solid ||
                  (!my.is_ghost(layer) && label < looks.size() && looks[label].opacity >= 1);
    }
  }
  gl::check_gl("reading the labels of a picture");
  std::vector<Label> result;
  const int scale = my.shown_scale * my.shown_scale;
  for (size_t label = 1; label < shown.size(); ++label)
    if (shown[label] * scale >= pixels) result.push_back(static_cast<Label>(label));
  return result;
}

std::vector<Label> View3D::pixel_labels() const {
  const Impl& my = *impl_;
  if (!my.drawn || my.shown_scale == 0 || shows_image(my.scene)) return {};
  const KeepFramebuffer keep;
  const glm::ivec2 size = my.shown[0].size();
  std::vector<Label> labels(static_cast<size_t>(size.x) * static_cast<size_t>(size.y));
  glBindFramebuffer(GL_FRAMEBUFFER, my.shown[0].march_target.name());
  glReadBuffer(GL_COLOR_ATTACHMENT2);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size.x, size.y, GL_RED_INTEGER, GL_UNSIGNED_SHORT, labels.data());
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  gl::check_gl("reading the labels of a picture");
  return labels;
}

std::optional<Hit> View3D::pick(const glm::ivec2& pixel) const {
  const Impl& my = *impl_;
  if (!my.drawn || my.shown_scale == 0 || !my.scene.volume) return std::nullopt;
  if (glm::any(glm::lessThan(pixel, glm::ivec2(0))) || glm::any(glm::greaterThanEqual(pixel, my.key.size)))
    return std::nullopt;
  const glm::ivec2 buffer_size = my.shown[0].size();
  const glm::ivec2 at(pixel.x * buffer_size.x / my.key.size.x,
                      (my.key.size.y - 1 - pixel.y) * buffer_size.y / my.key.size.y);

  const KeepFramebuffer keep;
  // Returns the hit that the buffer of one layer stores at the pixel.
  const auto hit_in = [&](const GBuffer& buffer) -> std::optional<Hit> {
    float depth = 0;
    std::uint16_t label = 0;
    std::uint32_t normal = 0;
    glBindFramebuffer(GL_FRAMEBUFFER, buffer.march_target.name());
    glReadBuffer(GL_COLOR_ATTACHMENT0);
    glReadPixels(at.x, at.y, 1, 1, GL_RED, GL_FLOAT, &depth);
    glReadBuffer(GL_COLOR_ATTACHMENT1);
    glReadPixels(at.x, at.y, 1, 1, GL_RGBA, GL_UNSIGNED_INT_2_10_10_10_REV, &normal);
    glReadBuffer(GL_COLOR_ATTACHMENT2);
    glReadPixels(at.x, at.y, 1, 1, GL_RED_INTEGER, GL_UNSIGNED_SHORT, &label);
    glReadBuffer(GL_COLOR_ATTACHMENT0);
    if (depth >= kNothingDepth * 0.5f || label == 0) return std::nullopt;
    Hit hit;
    hit.label = label;
    // The ray is computed for the centre of the buffer's pixel, since the stored hit belongs to that ray.
    const glm::dvec2 middle((at.x + 0.5) * my.key.size.x / buffer_size.x,
                            my.key.size.y - (at.y + 0.5) * my.key.size.y / buffer_size.y);
    const Ray ray = ray_through(my.key.camera, middle, my.key.size);
    const glm::dvec3 ahead = my.key.camera.world_from_view * glm::dvec3(0, 0, -1);
    hit.point = ray.origin + ray.direction * (double(depth) / glm::dot(ray.direction, ahead));
    const bool cap = normal >> 30 == 3;
    const glm::dvec3 view_normal =
        glm::dvec3(normal & 1023, normal >> 10 & 1023, normal >> 20 & 1023) / 1023.0 * 2.0 - 1.0;
    if (!cap) hit.normal = my.key.camera.world_from_view * glm::normalize(view_normal);

    // Finds the voxel of the hit: the first one with the hit's label, in small steps inward from the hit. Labels are
    // read at rest, as in the shader.
    const AffineTransform to_voxel = voxel_from_world(my.scene.volume->grid);
    const glm::dvec3 inward = to_voxel.linear * (cap ? ray.direction : -hit.normal);
    const glm::dvec3 step = inward / std::max({std::abs(inward.x), std::abs(inward.y), std::abs(inward.z)}) * 0.25;
    glm::dvec3 p = to_voxel * hit.point;
    const auto voxel_at = [&](const glm::dvec3& place) {
      const glm::dvec3 rest = my.scene.pose ? my.scene.pose->rest_at(place).value_or(place) : place;
      return glm::ivec3(glm::floor(rest + 0.5));
    };
    hit.voxel = voxel_at(p);
    for (int i = 0; i < 16; ++i, p += step) {
      const glm::ivec3 voxel = voxel_at(p);
      if (my.scene.volume->at_or_air(voxel) != label) continue;
      hit.voxel = voxel;
      break;
    }
    hit.voxel = glm::clamp(hit.voxel, glm::ivec3(0), my.scene.volume->grid.size - 1);
    return hit;
  };
  if (my.scene.display == Display::XRay)
    if (auto bone = hit_in(my.shown[1])) return bone;
  return hit_in(my.shown[0]);
}

std::optional<int> View3D::pick_bone(const glm::ivec2& pixel) const {
  const Impl& my = *impl_;
  if (!my.drawn) return std::nullopt;
  return bone_at(my.scene, my.key.camera, my.key.size, glm::dvec2(pixel) + 0.5);
}

std::vector<BoneHit> View3D::pick_bones(const glm::ivec2& pixel) const {
  const Impl& my = *impl_;
  if (!my.drawn) return {};
  return bones_at(my.scene, my.key.camera, my.key.size, glm::dvec2(pixel) + 0.5);
}

struct SliceView::Impl {
  explicit Impl(Renderer& renderer) : resources(renderer.resources()) {}
  PassResources& resources;
  Target output;
  bool has_all_weights = true, has_whole_image = true, transparent = false;
  // The lines along which the slice cuts the mesh, cached with the inputs from which they were computed.
  struct {
    CutMesh mesh;
    SliceCamera camera;
    std::vector<Segment> lines;
  } cut;

  void draw_mesh(const Scene& scene, const SliceCamera& camera, SliceDisplay display, const glm::ivec2& size) {
    const CutMesh& mesh = *scene.mesh;
    if (!(cut.mesh == mesh) || cut.camera.axis != camera.axis || cut.camera.centre != camera.centre) {
      const SliceFrame frame = frame_of(camera.axis);
      cut = {mesh, camera, plane_cut(*mesh.V, *mesh.faces, camera.centre, frame.normal)};
    }
    resources.lines.draw(cut.lines, camera, size,
                         ink_of_mesh(scene, cut.lines, display == SliceDisplay::Labels, camera.millimetres_per_pixel));
  }

  const WeightTexture* weights(PassResources::Body& body, const Scene& scene, const SliceCamera& camera) {
    WeightTexture* weights = resources.weights(body, scene.weights, PassResources::Extent::InTime);
    has_all_weights = !weights || weights->complete();
    if (!weights) return nullptr;
    const AffineTransform to_padded = padded_from_world(body.volume->grid());
    const glm::dvec3 across = glm::abs(to_padded.linear * frame_of(camera.axis).normal), at = to_padded * camera.centre;
    const int axis = across.x >= across.y && across.x >= across.z ? 0 : across.y >= across.z ? 1 : 2;
    weights->prefer(axis, static_cast<float>(at[axis]));
    return weights;
  }
};

SliceView::SliceView(Renderer& renderer) : impl_(std::make_unique<Impl>(renderer)) {}
SliceView::~SliceView() = default;

void SliceView::draw(const Scene& scene, const SliceCamera& camera, SliceDisplay display, const glm::ivec2& size) {
  Impl& my = *impl_;
  const KeepFramebuffer keep;
  my.has_all_weights = my.has_whole_image = true;
  my.output.resize(size, GL_RGBA8);
  my.output.bind();
  my.transparent = scene.transparent_background;
  my.resources.compose.background(background_of(scene), size);
  if (scene.volume && scene.looks) {
    auto& body = my.resources.body(scene.volume);
    const GreyTexture* grey = my.resources.grey(scene.grey, PassResources::Extent::InTime);
    my.has_whole_image = !grey || grey->complete();
    my.resources.slice.draw(*body.volume, my.resources.pose(body, scene.pose),
                            my.resources.looks(body, scene.looks, Display::Solid), my.weights(body, scene, camera),
                            scene.weights && scene.weights->contours, grey, scene.grey.value_or(ShownGrey{}), camera,
                            display, scene.outlined, scene.line_scale, size);
    if (scene.mesh) my.draw_mesh(scene, camera, display, size);
  }
  gl::check_gl("drawing a slice");
}

bool SliceView::complete() const { return impl_->has_all_weights && impl_->has_whole_image; }
unsigned SliceView::texture() const { return impl_->output.texture().name(); }
Image SliceView::read() const { return read_back(impl_->output, impl_->transparent); }

}  // namespace limber::render
