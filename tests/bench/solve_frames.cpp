// SPDX-License-Identifier: AGPL-3.0-or-later
// solve_frames
// Measures how long the editor's frames take while finite elements are solved, and how long a cancel takes. The real
// editor runs in an offscreen window of 1280x720, on the arm of the Bender project where LIMBER_SHARED names it, else
// on the procedural one, its elbow bent by 90 degrees. The mouse turns the view while the body follows the pose by
// blending: before a solve, while a worker process of low priority solves with contact, and after the solve; then in
// the Resample workspace while it shows the steps of a solve, and there while it shows the result of blending and
// nothing is solved. Frames are drawn 60 a second or as fast as they can. For each case, prints as JSON the number of
// frames and the median, the 95th percentile and the maximum of a whole frame (with the window painted and OpenGL
// done), in milliseconds. Then cancels solves in each of their stages, and prints the milliseconds from the request to
// the end of the worker.
//
//   solve_frames [SECONDS]    seconds of frames for each case, 10 by default; 0: only the cancels
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "core/base/error.h"
#include "core/rig/pose.h"
#include "editor/app/headless_window.h"
#include "editor/app/script_player.h"
#include "editor/context/background_task.h"
#include "editor/context/document_edits.h"
#include "editor/context/frame_timing.h"
#include "editor/context/open_project.h"
#include "editor/context/operator.h"
#include "editor/context/resampling_settings.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/resample/results.h"
#include "editor/shown/fem_live_view.h"
#include "editor/shown/frame_all.h"
#include "tests/bench/arm_document.h"

namespace {

using namespace limber;
using namespace limber::editor;

constexpr double kFrame = 1.0 / 60;  // time from one frame to the next, s

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

Document bent_arm() {
  Document document = bench::arm_document();
  Pose pose = rest_pose(*document.armature);
  flex(pose, *document.armature, require_bone(*document.armature, "Forearm"), 90);
  document.pose = std::make_shared<const Pose>(pose);
  return document;
}

class ArmSolved {
 public:
  explicit ArmSolved(double length)
      : length_(length),
        host_(open_offscreen({1280, 720})),
        editor_(*host_),
        player_(editor_, *host_) {
    player_.step();
    editor_.background->worker_program = LIMBER_PROGRAM;
    editor_.history->reset(bent_arm(), "Open arm");
    editor_.project->name = "arm";
    frame_all(editor_, false);
    editor_.resampling->method = "dqs";
    if (length_ > 0) player_.play("key Ctrl+4\nkey Ctrl+Return\nwait-job\nwait-idle");
    editor_.resampling->method = "fem";
    editor_.resampling->quality = "fine";  // makes the solve last long enough
    editor_.resampling->contact = true;
    editor_.resampling->bones_apart = true;
  }

  void run() {
    std::printf("{\"frames\": [");
    if (length_ > 0) {
      turn("pose", "key Ctrl+3");
      solve();
      turn("pose, solving", "key Ctrl+3");
      turn("settling", "key Ctrl+4");
      cancel();
      turn("pose, once more", "key Ctrl+3");
      show_result(editor_, editor_.document().results.front()->name);
      turn("result", "key Ctrl+4");
    }
    std::printf("],\n \"cancel_ms\": [");
    const char* before = "";
    for (const char* stage : {"solving", "tetrahedra", ""})
      for (const double later : {0.0, 0.3, 0.9}) {  // time from the start of the stage to the cancel, s
        ask_for_solve();
        wait_for([&] { return stage_of_solve() == stage || stage_of_solve() == "solving"; });
        for (const double until = seconds() + later; seconds() < until;) frame();
        const std::string reached = stage_of_solve();
        std::printf("%s{\"stage\": \"%s\", \"ms\": %.0f}", before, reached.empty() ? "write inputs" : reached.c_str(),
                    cancel());
        std::fflush(stdout);
        before = ", ";
      }
    std::printf("]}\n");
  }

 private:
  void frame() {
    editor_.frame(player_.now() + seconds() - begin_);
    host_->picture();
  }
  template <class There>
  void wait_for(const There& there) {
    for (const double begin = seconds(); !there();) {
      if (seconds() - begin > 300)
        throw Error("the solve does not come to it", stage_of_solve(), editor_.messages->last_failure);
      frame();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  std::string stage_of_solve() const {
    return editor_.fem->solves.empty() ? "" : editor_.fem->solves.begin()->second.feed->seen().progress.stage;
  }
  void ask_for_solve() { editor_.fem->watched = 0, limber::editor::run(editor_, "resample.run"); }
  void solve() {
    ask_for_solve();
    wait_for(
        [&] { return !editor_.fem->solves.empty() && editor_.fem->solves.begin()->second.feed->seen().mesh.posed; });
  }
  // Cancels the running solve. Returns the milliseconds until its worker has ended.
  double cancel() {
    const double asked = seconds();
    if (editor_.fem->solves.empty())
      throw Error("the solve was over too soon", "to be cancelled", "give fewer seconds");
    const int job = editor_.fem->solves.begin()->first;
    editor_.jobs->cancel(job);
    while (editor_.jobs->status(job).active()) std::this_thread::sleep_for(std::chrono::microseconds(200));
    const double took = 1e3 * (seconds() - asked);
    while (editor_.jobs->busy()) frame();
    return took;
  }

  void turn(const char* name, const std::string& script) {
    player_.play(script);
    const Rect view = *editor_.screen->layout.place_of(ViewId::Body);
    const auto at = [&](double way) {
      return view.centre() + glm::vec2(120 * std::sin(way), 40 * std::sin(0.7 * way));
    };
    for (const double settled = seconds() + 2; seconds() < settled;) frame();
    host_->events.push(PointerMoved{at(0)});
    frame();
    host_->events.push(ButtonChanged{MouseButton::Middle, true});
    std::vector<double> took;
    for (const double begin = seconds(); seconds() - begin < length_;) {
      const double due = seconds() + kFrame;
      host_->events.push(PointerMoved{at(seconds() - begin)});
      const double from = seconds();
      frame();
      took.push_back(1e3 * (seconds() - from));
      std::this_thread::sleep_for(std::chrono::duration<double>(due - seconds()));
    }
    host_->events.push(ButtonChanged{MouseButton::Middle, false});
    frame();
    std::printf(
        "%s{\"view\": \"%s\", \"solving\": %s, \"frames\": %zu, \"scale\": %d, \"median\": %.1f, \"p95\": %.1f, "
        "\"worst\": %.1f}",
        first_ ? "" : ",\n  ", name, editor_.jobs->busy() ? "true" : "false", took.size(),
        editor_.views->body.picture->scale(), percentile(took, 50), percentile(took, 95), percentile(took, 100));
    std::fflush(stdout);
    first_ = false;
  }

  const double length_;
  std::unique_ptr<Offscreen> host_;
  Editor editor_;
  Player player_;
  const double begin_ = seconds();
  bool first_ = true;
};

}  // namespace

int main(int count, char** words) {
  try {
    ArmSolved(count > 1 ? std::atof(words[1]) : 10).run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
