// SPDX-License-Identifier: AGPL-3.0-or-later
// stroke_frames
// Measures how long the editor's frames take while weights are painted. The real editor runs in an offscreen window of
// 640x480, on the arm of the Bender project where LIMBER_SHARED names it, else on the procedural one. The mouse draws a
// stroke of 200 dabs along the middle of the body and back, at 60 dabs a second. Frames go on for one more second, in
// which the work that follows a stroke is done. Frames are drawn 60 a second or as fast as they can; events that arrive
// during a frame wait for the next one. Strokes are measured at rest and on the posed body, with a radius of 16 and of
// 32 voxels, and undone after each. Prints as JSON for each the dabs, the frames of the stroke and after it, and in
// milliseconds the maximum and the 95th percentile of a whole frame (with the window painted and OpenGL done) and of
// the CPU time of the interface's own thread in it; `over` counts frames longer than 1/30 s.
//
//   stroke_frames [LOG]    writes the parts of every frame (see frame_timing.h) into files LOG.NAME.txt
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/project/history.h"
#include "editor/app/headless_window.h"
#include "editor/app/script_player.h"
#include "editor/context/document_edits.h"
#include "editor/context/frame_timing.h"
#include "editor/context/open_project.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/context/view_projection.h"
#include "editor/context/views.h"
#include "editor/motion/timeline.h"
#include "editor/shown/frame_all.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/paint_mode.h"
#include "editor/skin/weight_display.h"
#include "tests/bench/arm_document.h"

namespace {

using namespace limber;
using namespace limber::editor;

// In s: the time from one frame to the next; the time above which a frame counts as `over`; the time that is measured
// after the stroke.
constexpr double kFrame = 1.0 / 60, kLongest = 1.0 / 30, kAfterwards = 1;
constexpr int kDabs = 200;

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

class ArmPainted {
 public:
  explicit ArmPainted(std::string log)
      : log_(std::move(log)),
        host_(open_offscreen({640, 480})),
        editor_(*host_),
        player_(editor_, *host_) {
    player_.step();
    editor_.history->reset(bench::arm_document(), "Open arm");
    editor_.project->name = "arm";
    frame_all(editor_, false);
    player_.play("key Ctrl+2\nmove \"3D view/view\"\nkey Num1\nwait-job\nwait-idle");
    // Paints a bone in the middle of the body, so that the stroke crosses the border of its weight.
    const Armature& armature = *editor_.document().armature;
    for (int bone = 0; bone < std::ssize(armature.bones); ++bone)
      if (armature.bones[static_cast<std::size_t>(bone)].name.find("orearm") != std::string::npos || bone == 0)
        editor_.selection->bone = bone;
    editor_.selection->bones = {*editor_.selection->bone};
    rest();
  }

  // Bends the active bone's joint as a test pose.
  void bend(double degrees) {
    set_bend(editor_, degrees);
    rest();
  }

  void stroke(const char* name, double voxels) {
    Painting& painting = *editor_.skin->painting;
    painting.radius = voxels * editor_.document().volume->grid.spacing.x;
    const auto is_body = [](const ViewPlace& place) { return place.id == ViewId::Body; };
    const ViewPlace view =
        *std::find_if(editor_.screen->layout.view_places.begin(), editor_.screen->layout.view_places.end(), is_body);
    const std::vector<glm::vec2> path = middle_of_body(view);
    if (path.size() < 2) throw Error("the body is not seen", name, "look at the picture");
    player_.play("move \"3D view/view\"");
    move(path.front());
    rest();
    editor_.timeline->frame_log->clear();
    whole_.clear();

    const auto place = brush_place(editor_, view, path.front());
    const double step = painting.spacing * painting.radius /
                        // distance of two dabs, pixels
                        ViewProjection(editor_, view).millimetres_per_pixel(place->seen);
    const std::size_t before = static_cast<std::size_t>(editor_.history->position());
    frame(ButtonChanged{MouseButton::Left, true});
    const double begin = seconds();
    int dabs = 0;
    for (double due = begin; (dabs = dabs_of_stroke(editor_.skin)) < kDabs; due += kFrame) {
      std::this_thread::sleep_for(std::chrono::duration<double>(due + kFrame - seconds()));
      due = std::max(due, seconds() - kFrame);
      // Moves the mouse to the place on the path that it reaches by now. The editor sees all motion since the last
      // frame as one straight move.
      frame(PointerMoved{at(path, step * 60 * (seconds() - begin))});
    }
    const double took = seconds() - begin;
    const std::size_t of_stroke = whole_.size();
    frame(ButtonChanged{MouseButton::Left, false});
    for (const double end = seconds() + kAfterwards; seconds() < end;) {
      const double due = seconds() + kFrame;
      frame();
      std::this_thread::sleep_for(std::chrono::duration<double>(due - seconds()));
    }
    if (static_cast<std::size_t>(editor_.history->position()) != before + 1)
      throw Error("the stroke changed nothing", name, "look at what it paints");
    report(name, dabs, took, of_stroke);
    player_.play("key Ctrl+Z");
    rest();
  }

 private:
  // Returns a line through the middle of the visible body, as a point every few pixels: from left to right or from top
  // to bottom, whichever gives more points.
  std::vector<glm::vec2> middle_of_body(const ViewPlace& view) {
    std::vector<glm::vec2> best;
    for (const int along : {0, 1}) {
      std::vector<glm::vec2> middles;
      for (float a = view.rect.low[along] + 2; a < view.rect.high[along] - 2; a += 4) {
        glm::vec2 sum(0);
        int count = 0;
        for (float b = view.rect.low[1 - along] + 2; b < view.rect.high[1 - along] - 2; b += 2) {
          const glm::vec2 pixel = along == 0 ? glm::vec2(a, b) : glm::vec2(b, a);
          if (brush_place(editor_, view, pixel)) sum += pixel, ++count;
        }
        if (count > 0 && brush_place(editor_, view, sum / float(count))) middles.push_back(sum / float(count));
      }
      if (middles.size() > best.size()) best = middles;
    }
    return best;
  }

  // Returns the point that is reached after `way` pixels along the path. At its end, the path is followed back to its
  // start, and so on.
  static glm::vec2 at(const std::vector<glm::vec2>& path, double way) {
    double length = 0;
    for (std::size_t i = 1; i < path.size(); ++i) length += glm::distance(path[i - 1], path[i]);
    way = std::fmod(way, 2 * length);
    if (way > length) way = 2 * length - way;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const double part = glm::distance(path[i - 1], path[i]);
      if (way <= part) return glm::mix(path[i - 1], path[i], static_cast<float>(way / std::max(part, 1e-6)));
      way -= part;
    }
    return path.back();
  }

  void frame() {
    FrameLog& log = *editor_.timeline->frame_log;
    const double begin = seconds();
    log.begin();
    editor_.frame(player_.now() + begin - begin_);
    host_->picture();
    log.part("paint");
    log.end("stroke");
    whole_.push_back(1e3 * (seconds() - begin));
  }
  void frame(const Event& event) {
    host_->events.push(event);
    frame();
  }
  void move(const glm::vec2& place) { frame(PointerMoved{place}); }
  void rest() {
    do {
      frame();
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    } while (editor_.busy() || !editor_.at_rest());
  }

  void report(const char* name, int dabs, double took, std::size_t of_stroke) {
    std::vector<double> own;
    for (const FrameLog::Frame& each : editor_.timeline->frame_log->frames()) own.push_back(each.computed);
    const auto row = [](const char* what, std::vector<double> all) {
      const auto over = std::count_if(all.begin(), all.end(), [](double ms) { return ms > 1e3 * kLongest; });
      std::printf(", \"%s\": {\"worst\": %.1f, \"p95\": %.1f, \"median\": %.1f, \"over\": %d}", what,
                  percentile(all, 100), percentile(all, 95), percentile(all, 50), static_cast<int>(over));
    };
    const auto cut = static_cast<std::ptrdiff_t>(of_stroke);
    std::printf("%s{\"stroke\": \"%s\", \"dabs\": %d, \"seconds\": %.2f, \"frames\": %zu, \"frames_after\": %zu",
                std::exchange(first_, false) ? "" : ",\n ", name, dabs, took, of_stroke, whole_.size() - of_stroke);
    row("whole_ms", {whole_.begin(), whole_.begin() + cut});
    row("own_ms", {own.begin(), own.begin() + cut});
    row("whole_after_ms", {whole_.begin() + cut, whole_.end()});
    row("own_after_ms", {own.begin() + cut, own.end()});
    std::printf("}");
    std::fflush(stdout);
    if (!log_.empty()) write_file_atomically(log_ + "." + name + ".txt", editor_.timeline->frame_log->text());
  }

  const std::string log_;
  std::unique_ptr<Offscreen> host_;
  Editor editor_;
  Player player_;
  const double begin_ = seconds();
  std::vector<double> whole_;  // duration of each frame with its painting and OpenGL, ms
  bool first_ = true;
};

}  // namespace

int main(int count, char** words) {
  try {
    ArmPainted session(count > 1 ? words[1] : "");
    std::printf("[");
    session.stroke("rest_16", 16);
    session.stroke("rest_32", 32);
    session.bend(45);
    session.stroke("posed_16", 16);
    session.stroke("posed_32", 32);
    std::printf("]\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
