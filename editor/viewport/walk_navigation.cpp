// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/viewport/walk_navigation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/views.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

// Initial walking speed, as a fraction of the distance between the eye and the view's centre per second.
constexpr double kSpeed = 0.4;
constexpr double kFasterPerStep = 1.25;           // factor by which a wheel step changes the speed
constexpr double kSlowest = 0.1, kFastest = 1e5;  // the walking speed is clamped to this range, mm/s
constexpr double kHurry = 5, kCreep = 0.2;
// Rotation per pixel, relative to orbiting; smaller than 1, because looking around feels faster.
constexpr double kLookPerPixel = 0.35;

class Walk final : public Modal {
 public:
  explicit Walk(Context& context)
      : before_(context.views->body.camera),
        speed_(std::clamp(kSpeed * before_.distance, kSlowest, kFastest)) {
    context.views->body.move.reset();
    // Walking needs perspective, because moving forward changes nothing in a parallel projection.
    context.views->body.camera.projection = render::Projection::Perspective;
    context.views->body.name.clear();
  }

  bool moved(Context& context, const glm::vec2& pixels) override {
    render::Camera& camera = context.views->body.camera;
    camera = render::looked_round(camera, glm::dvec2(pixels) * (kLookPerPixel / context.ui->look.scale));
    return true;
  }

  bool wheel(Context&, float steps) override {
    speed_ = std::clamp(speed_ * std::pow(kFasterPerStep, steps), kSlowest, kFastest);
    return true;
  }

  bool button(Context& context, const ButtonChanged& event) override {
    if (!event.down || event.button == MouseButton::Middle) return true;
    if (event.button == MouseButton::Right) cancel(context);
    return false;
  }

  bool key(Context& context, const KeyChanged& event) override {
    if (const Way* way = way_of(event.key)) {
      // Stores the key's direction, so that a key that is pressed and released within one frame moves the eye too.
      if (event.down && !event.repeated) pressed_ += way->direction;
      going_ = direction(context) != glm::dvec3(0);
      return true;
    }
    if (!event.down) return true;
    if (event.key == Key::Escape) cancel(context);
    return event.key != Key::Escape && event.key != Key::Return && event.key != Key::NumEnter &&
           event.key != Key::Space;
  }

  bool frame(Context& context, double seconds) override {
    glm::dvec3 way = direction(context);
    going_ = way != glm::dvec3(0);
    if (!going_) way = pressed_;
    pressed_ = {};
    if (way == glm::dvec3(0)) return true;
    const double pace = context.ui->input.down(Key::Shift) ? kHurry : context.ui->input.down(Key::Alt) ? kCreep : 1;
    render::Camera& camera = context.views->body.camera;
    camera.centre +=
        (camera.world_from_view * glm::dvec3(way.x, 0, way.z) + glm::dvec3(0, 0, way.y)) * (speed_ * pace * seconds);
    return true;
  }

  bool hides_pointer() const override { return true; }
  bool moving() const override { return going_ || pressed_ != glm::dvec3(0); }
  void cancel(Context& context) override { context.views->body.camera = before_; }

  std::vector<KeyHint> hints(const Context&) const override {
    return {{{"W", "A", "S", "D"}, "Move"}, {{"E", "Q"}, "Up, down"}, {{"Wheel"}, "Speed"},
            {{"Shift"}, "Faster"},          {{"Enter"}, "Confirm"},   {{"Esc"}, "Cancel"}};
  }

  std::string title() const override {
    char text[48];
    std::snprintf(text, sizeof text, speed_ < 100 ? "Walking, %.1f mm/s" : "Walking, %.0f mm/s", speed_);
    return text;
  }

 private:
  struct Way {
    Key key;
    // Direction in which the key moves the eye: x right in the view, y up in the world, z backward in the view.
    glm::dvec3 direction;
  };

  static const Way* way_of(Key key) {
    static const Way kWays[] = {{Key::W, {0, 0, -1}},   {Key::S, {0, 0, 1}},    {Key::A, {-1, 0, 0}},
                                {Key::D, {1, 0, 0}},    {Key::E, {0, 1, 0}},    {Key::Q, {0, -1, 0}},
                                {Key::Up, {0, 0, -1}},  {Key::Down, {0, 0, 1}}, {Key::Left, {-1, 0, 0}},
                                {Key::Right, {1, 0, 0}}};
    for (const Way& way : kWays)
      if (way.key == key) return &way;
    return nullptr;
  }

  static glm::dvec3 direction(const Context& context) {
    glm::dvec3 sum(0);
    for (int key = 0; key < static_cast<int>(Key::Count); ++key)
      if (const Way* way = way_of(static_cast<Key>(key)); way && context.ui->input.down(way->key))
        sum += way->direction;
    return sum;
  }

  render::Camera before_;
  double speed_;  // speed while neither Shift nor Alt is held, mm/s
  bool going_ = false;
  glm::dvec3 pressed_{0};
};

}  // namespace

std::unique_ptr<Modal> begin_walk(Context& context) { return std::make_unique<Walk>(context); }

}  // namespace limber::editor
