// SPDX-License-Identifier: AGPL-3.0-or-later
// editor_opening VOLUME...
// Measures how long the editor takes to show a volume that it is started with. The real editor runs in an offscreen
// window of 1280x720, five times for each volume, each time in a new process. Prints the medians as JSON:
//   window_cpu_seconds         CPU seconds (user and system, all threads) before the first frame: libraries, fonts,
//                              shaders
//   first_picture_cpu_seconds  from the first frame, which shows the empty window, to the first that shows the volume
//   first_picture_seconds      first_picture_cpu_seconds / 2: the time on two cores that are otherwise idle
//   longest_frame_cpu_seconds  the longest frame until then: CPU seconds of the interface's own thread
//   complete_cpu_seconds       from the first frame until the picture is at full resolution
//   longest_frame_to_complete_cpu_seconds  the longest frame of that thread until the picture is at full resolution
//   frames_with_progress       number of frames that showed the job's progress before the volume
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <thread>

#include "core/base/error.h"
#include "core/project/job.h"
#include "editor/app/editor.h"
#include "editor/app/editor_session.h"
#include "editor/app/headless_window.h"
#include "editor/context/user_folders.h"
#include "editor/context/views.h"

namespace {

using namespace limber;
using namespace limber::editor;

constexpr double kFrame = 1.0 / 60;    // time from one frame to the next, s
constexpr double kWhileJobsRun = 0.1;  // longest pause between two frames while only jobs run, s
constexpr double kLongestWait = 300;   // the measurement fails if no picture is shown after this time, s

double seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

// Returns true if the last frame shows the volume.
bool shows_volume(const Context& editor) { return editor.document().volume && editor.views->body.picture->scale() > 0; }

constexpr int kRuns = 5;
constexpr std::array<const char*, 7> kNames = {"window_cpu_seconds",    "first_picture_cpu_seconds",
                                               "first_picture_seconds", "longest_frame_cpu_seconds",
                                               "complete_cpu_seconds",  "longest_frame_to_complete_cpu_seconds",
                                               "frames_with_progress"};
using Figures = std::array<double, kNames.size()>;

Figures open_once(const Path& volume) {
  const auto host = open_offscreen({1280, 720});
  Editor editor(*host);
  begin_editor_session(editor, {}, {volume});
  double longest = 0, longest_of_all = 0, first_picture = 0, progress = 0;
  const double begin = seconds(CLOCK_MONOTONIC);
  editor.frame(0);
  const double window = seconds(CLOCK_PROCESS_CPUTIME_ID);
  while (!shows_volume(editor) || editor.rest() == 0) {
    if (!editor.messages->errors.empty())
      throw Error(editor.messages->errors.front().what, volume.string(), "choose another file");
    if (seconds(CLOCK_MONOTONIC) - begin > kLongestWait)
      throw Error("no picture comes", volume.string(), "open it in the editor and look");
    const double before = seconds(CLOCK_THREAD_CPUTIME_ID);
    editor.frame(seconds(CLOCK_MONOTONIC) - begin);
    host->picture();
    editor.views->renderer.finish();  // the frame counts as ended when its picture is drawn
    const double own = seconds(CLOCK_THREAD_CPUTIME_ID) - before;
    longest_of_all = std::max(longest_of_all, own);
    if (first_picture == 0) {
      longest = std::max(longest, own);
      if (shows_volume(editor)) first_picture = seconds(CLOCK_PROCESS_CPUTIME_ID) - window;
      else progress += editor.jobs->busy();
    }
    std::this_thread::sleep_for(
        std::chrono::duration<double>(editor.rest() == 0 ? kFrame : std::min(editor.rest(), kWhileJobsRun)));
  }
  return {window,         first_picture, first_picture / 2, longest, seconds(CLOCK_PROCESS_CPUTIME_ID) - window,
          longest_of_all, progress};
}

// Opens the volume in a new process, so that no cache is warm.
Figures open_in_new_process(const Path& volume) {
  int ends[2];
  if (::pipe(ends) != 0) throw Error("no pipe", volume.string(), "close some programs");
  const pid_t child = ::fork();
  if (child == 0) {
    int code = 0;
    try {
      const Figures figures = open_once(volume);
      code = ::write(ends[1], &figures, sizeof figures) == sizeof figures ? 0 : 1;
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      code = 1;
    }
    std::_Exit(code);
  }
  ::close(ends[1]);
  Figures figures{};
  const bool read = ::read(ends[0], &figures, sizeof figures) == sizeof figures;
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  if (!read || status != 0)
    throw Error("the editor could not show it", volume.string(), "open it in the editor and look");
  return figures;
}

double median(std::array<double, kRuns> values) {
  std::nth_element(values.begin(), values.begin() + kRuns / 2, values.end());
  return values[kRuns / 2];
}

void measure(const Path& volume) {
  std::array<Figures, kRuns> runs;
  for (Figures& run : runs) run = open_in_new_process(volume);
  std::printf("{\"open\": \"%s\"", volume.filename().c_str());
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    std::array<double, kRuns> values;
    for (int run = 0; run < kRuns; ++run) values[run] = runs[run][i];
    std::printf(", \"%s\": %.4f", kNames[i], median(values));
  }
  std::printf("}");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  try {
    std::printf("[");
    for (int i = 1; i < argc; ++i) {
      if (i > 1) std::printf(",\n ");
      measure(argv[i]);
      std::fflush(stdout);
    }
    std::printf("]\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
