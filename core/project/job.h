// SPDX-License-Identifier: AGPL-3.0-or-later
// Long work beside a live editor. A job works on copies of its inputs in a thread of its own and returns an *edit*:
// what it changes in the document of the moment when it is done, so that what the user did meanwhile is kept. Whatever
// goes wrong in a job becomes its message: an Error, a lack of memory, any exception; a cancel is shown as such.
//
// A job that is cancelled ends at its next Progress::update. One that does not is shown as Stopping and no longer holds
// up the queue; if it still hangs when Jobs goes, it is left to itself (it owns all that it uses).
//
// One thread owns Jobs: it alone calls the functions and applies the edits.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/project/document.h"
#include "core/project/history.h"

namespace limber {

// Applied in the owner's thread. An empty one changes nothing.
using Edit = std::function<Document(const Document& now)>;
using Work = std::function<Edit(Progress& progress)>;

// Who waits for whom. Long jobs, of minutes, run one at a time beside all others, so that nobody waits for them.
enum class Lane { Common, Long };

enum class JobState { Queued, Running, Stopping, Done, Failed, Cancelled };

struct JobStatus {
  int id = 0;
  std::string label;  // "Diffuse heat": also the history's label for its edit
  JobState state = JobState::Queued;
  std::string stage;                   // "weights"; empty before the first
  double fraction = 0;                 // of the stage, [0, 1]
  double seconds = 0;                  // since it was started
  std::optional<double> seconds_left;  // of the stage, where it can be told
  std::string message;                 // why it failed

  bool active() const { return state == JobState::Queued || state == JobState::Running || state == JobState::Stopping; }
};

class Jobs {
 public:
  // at_once   that many common ones run together, the others wait in order
  // on_change called from any thread when a poll() is worth it, at most 20 times a second per job (as
  // glfwPostEmptyEvent);
  //           it must not call Jobs itself, and is never called after Jobs has gone
  explicit Jobs(int at_once = 2, std::function<void()> on_change = {});
  // Cancels all and waits for them, at most a second.
  ~Jobs();
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  void set_at_once(int count) { at_once_ = count; }                   // for those that start from now on
  int start(std::string label, Work work, Lane lane = Lane::Common);  // returns its id
  void cancel(int id);
  void cancel_all();

  // Commits the edits of the jobs that are done, in the order they ended, and starts what waits. True when any job's
  // state changed since the last call.
  bool poll(History& history);

  // Oldest first. Jobs that ended stay until dismissed.
  std::vector<JobStatus> statuses() const;
  JobStatus status(int id) const;
  bool busy() const;  // any job active, or ended since the last poll()
  void dismiss(int id);
  void dismiss_ended();

  // Cancels all and waits that long; false when a job still hangs. A program then ends by std::_Exit, since what it
  // hangs on must not be torn down under it.
  bool shut_down(double seconds);

 private:
  struct Job;
  struct Board;
  static void work_on(const std::shared_ptr<Job>& job, const std::shared_ptr<Board>& board);
  void start_waiting();
  Job* find(int id) const;

  int at_once_, next_id_ = 1;
  std::shared_ptr<Board> board_;
  std::vector<std::shared_ptr<Job>> jobs_;
};

}  // namespace limber
