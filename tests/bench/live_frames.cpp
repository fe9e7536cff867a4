// SPDX-License-Identifier: AGPL-3.0-or-later
// live_frames
// Measures how long the editor's frames take while an arm at 2 mm follows the pose live: the arm of the paper if
// LIMBER_SHARED names the folder that contains it, else the procedural one. The real editor runs in an offscreen window
// of 1600x900 and draws at most 60 frames a second: the mouse turns the elbow, then the picture is refined tile by tile
// at rest, then a clip is scrubbed on the ruler. For each of the three, prints as JSON the number of frames, the frames
// a second that the window showed, and the median, the 95th percentile and the maximum of a frame's CPU time on the
// interface's own thread, in milliseconds.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <numeric>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "core/phantom/phantom.h"
#include "core/project/history.h"
#include "editor/app/editor.h"
#include "editor/app/headless_window.h"
#include "editor/app/script_player.h"
#include "editor/context/document_edits.h"
#include "editor/context/open_project.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/motion/timeline.h"
#include "editor/motion/timeline_tool.h"
#include "editor/shown/frame_all.h"
#include "tests/bench/arm_document.h"

namespace {

using namespace limber;
using namespace limber::editor;

constexpr double kFrame = 1.0 / 60;  // time from one frame to the next, s
constexpr int kMoves = 90;

double seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

// Returns the arm with a clip that curls it.
Document arm_with_clip() {
  Document document = bench::arm_document();
  add_clip(document, clip_of(std::make_shared<const Motion>(make_arm_phantom(8).motion), "curl"));
  return document;
}

class ArmAtWork {
 public:
  ArmAtWork() : host_(open_offscreen({1600, 900})), editor_(*host_), player_(editor_, *host_) {
    player_.step();
    editor_.history->reset(arm_with_clip(), "Open arm");
    editor_.project->name = "arm";
    frame_all(editor_, false);
    player_.play("key Ctrl+3\nkey Num3\nwait-job\nwait-idle");
    editor_.selection->bone = require_bone(*editor_.document().armature, "Forearm");
    editor_.selection->bones = {*editor_.selection->bone};
    begin_ = seconds(CLOCK_MONOTONIC);
    until_rest();
    milliseconds_.clear();
    whole_.clear();
  }

  void drag() {
    const glm::vec2 middle = editor_.screen->layout.place_of(ViewId::Body)->centre();
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

  // Draws a frame, waits until OpenGL has finished its picture, and then until the next frame is due.
  void frame() {
    const double start = seconds(CLOCK_MONOTONIC), before = seconds(CLOCK_THREAD_CPUTIME_ID);
    editor_.frame(player_.now() + start - begin_);
    milliseconds_.push_back(1e3 * (seconds(CLOCK_THREAD_CPUTIME_ID) - before));
    posed_ += editor_.views->scene.pose != nullptr;
    host_->finish();
    std::this_thread::sleep_for(std::chrono::duration<double>(start + kFrame - seconds(CLOCK_MONOTONIC)));
    whole_.push_back(seconds(CLOCK_MONOTONIC) - start);
  }
  void until_rest() {
    do frame();
    while (!editor_.at_rest());
  }
  void report(const char* what) {
    std::vector<double> all = std::exchange(milliseconds_, {}), whole = std::exchange(whole_, {});
    std::sort(all.begin(), all.end());
    std::sort(whole.begin(), whole.end());
    const double total = std::accumulate(whole.begin(), whole.end(), 0.0);
    std::printf(
        "%s{\"frames\": \"%s\", \"count\": %zu, \"with_a_posed_volume\": %d, \"frames_per_second\": %.1f, "
        "\"p95_frame_ms\": %.1f, \"longest_frame_ms\": %.1f, \"median_cpu_ms\": %.1f, \"p95_cpu_ms\": %.1f, "
        "\"longest_cpu_ms\": %.1f}",
        is_first_ ? "" : ",\n ", what, all.size(), std::exchange(posed_, 0), double(whole.size()) / total,
        1e3 * whole[whole.size() * 95 / 100], 1e3 * whole.back(), all[all.size() / 2], all[all.size() * 95 / 100],
        all.back());
    is_first_ = false;
  }

  std::unique_ptr<Offscreen> host_;
  Editor editor_;
  Player player_;
  double begin_ = 0;
  std::vector<double> milliseconds_;  // CPU time of the interface's own thread in each frame, ms
  std::vector<double> whole_;         // from the start of each frame to the start of the next, s
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
