// SPDX-License-Identifier: AGPL-3.0-or-later
// live_frames
// How long the frames of the editor take while the procedural arm at 2 mm follows the pose live: the real editor, in a
// window of 1280x720 that is a picture in memory, its elbow turned by the mouse, then left to rest while the picture is
// refined tile by tile, then a clip scrubbed on the ruler. Prints as JSON, for each of the three, the number of frames
// and, in milliseconds of CPU of the interface's own thread, what a frame takes: the median, the 95th percentile and
// the longest.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/binding/heat_diffusion.h"
#include "core/motion/clip.h"
#include "core/phantom/phantom.h"
#include "editor/app/headless_window.h"
#include "editor/app/script_player.h"
#include "editor/context/document_edits.h"
#include "editor/context/editor.h"
#include "editor/motion/timeline.h"
#include "editor/motion/timeline_tool.h"
#include "editor/shown/frame_all.h"

namespace {

using namespace limber;
using namespace limber::editor;

constexpr double kFrame = 1.0 / 60;  // s
constexpr int kMoves = 90;

double seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

Document arm_document() {
  Phantom phantom = make_arm_phantom(2);
  Document document;
  document.weights =
      std::make_shared<const SkinWeights>(diffuse_heat(phantom.volume, phantom.tissues, phantom.armature));
  document.volume = std::make_shared<const LabelVolume>(std::move(phantom.volume));
  document.tissues = std::make_shared<const TissueTable>(phantom.tissues);
  document.volume_type = std::make_shared<FileType>();
  document.armature = std::make_shared<const Armature>(phantom.armature);
  add_clip(document, clip_of(std::make_shared<const Motion>(std::move(phantom.motion)), "curl"));
  return document;
}

class ArmAtWork {
 public:
  ArmAtWork() : host_(open_offscreen({1280, 720})), editor_(*host_), player_(editor_, *host_) {
    player_.step();
    editor_.history.reset(arm_document(), "Open arm");
    editor_.name = "arm";
    frame_all(editor_, false);
    player_.play("key Ctrl+3\nkey Num3\nwait-job\nwait-idle");
    editor_.selection.bone = require_bone(*editor_.document().armature, "Forearm");
    editor_.selection.bones = {*editor_.selection.bone};
    begin_ = seconds(CLOCK_MONOTONIC);
    until_rest();
    milliseconds_.clear();
  }

  void drag() {
    const glm::vec2 middle = editor_.layout.place_of(ViewId::Body)->centre();
    move(middle);
    push(KeyChanged{Key::R, true});
    push(KeyChanged{Key::R, false});
    for (int i = 0; i < kMoves; ++i) move(middle + glm::vec2(120 * std::sin(0.05 * i), 40));
    push(ButtonChanged{MouseButton::Left, true});
    push(ButtonChanged{MouseButton::Left, false});
    report("elbow turned");
  }
  void refine() {
    until_rest();
    report("refined at rest");
  }
  void scrub() {
    const auto on_ruler = [&](int frame) {
      return glm::vec2(x_of(*editor_.timeline, frame), editor_.timeline->ruler.centre().y);
    };
    const int last = editor_.document().shown_clip()->end();
    move(on_ruler(0));
    push(ButtonChanged{MouseButton::Left, true});
    for (int i = 0; i < kMoves; ++i) move(on_ruler(last * i / kMoves));
    push(ButtonChanged{MouseButton::Left, false});
    report("clip scrubbed");
  }

 private:
  void push(const Event& event) {
    host_->events.push(event);
    frame();
  }
  void move(const glm::vec2& place) { push(PointerMoved{place}); }

  // Draws a frame and waits until the next one is due.
  void frame() {
    const double before = seconds(CLOCK_THREAD_CPUTIME_ID);
    editor_.frame(player_.now() + seconds(CLOCK_MONOTONIC) - begin_);
    milliseconds_.push_back(1e3 * (seconds(CLOCK_THREAD_CPUTIME_ID) - before));
    posed_ += editor_.views->scene.pose != nullptr;
    std::this_thread::sleep_for(std::chrono::duration<double>(kFrame));
  }
  void until_rest() {
    do frame();
    while (!editor_.at_rest());
  }
  void report(const char* what) {
    std::vector<double> all = std::exchange(milliseconds_, {});
    std::sort(all.begin(), all.end());
    std::printf(
        "%s{\"frames\": \"%s\", \"count\": %zu, \"with_a_posed_volume\": %d, \"median_cpu_ms\": %.1f, \"p95_cpu_ms\": "
        "%.1f, \"longest_cpu_ms\": %.1f}",
        is_first_ ? "" : ",\n ", what, all.size(), std::exchange(posed_, 0), all[all.size() / 2],
        all[all.size() * 95 / 100], all.back());
    is_first_ = false;
  }

  std::unique_ptr<Offscreen> host_;
  Editor editor_;
  Player player_;
  double begin_ = 0;
  std::vector<double> milliseconds_;
  int posed_ = 0;
  bool is_first_ = true;
};

}  // namespace

int main() {
  try {
    ArmAtWork session;
    std::printf("[");
    session.drag();
    session.refine();
    session.scrub();
    session.refine();
    std::printf("]\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
