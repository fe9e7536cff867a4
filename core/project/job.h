// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs long work beside a live editor. A job works on copies of its inputs in a thread of its own and returns an
// *edit*, a function that changes the document that is current when the job ends, so that the user's edits made
// meanwhile are kept. Any failure of a job (an Error, a lack of memory, any exception) becomes its message. A cancelled
// job is shown as cancelled, not as failed.
//
// A cancelled job ends at its next Progress::update. Until then it is shown as Stopping and no longer holds up the
// queue. If it still hangs when Jobs is destroyed, its thread runs on alone: it owns everything that it uses.
//
// One thread owns Jobs: only that thread calls its functions and applies the edits.
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

// A job's change of the document, applied in the owner's thread. An empty function changes nothing.
using Edit = std::function<Document(const Document& now)>;
using Work = std::function<Edit(Progress& progress)>;

// The queue of a job. Long jobs take minutes; they run one at a time. Quiet jobs are work that no user started, such as
// refining what the views show; they run one at a time, too. Jobs of one queue never wait for those of another.
enum class Lane { Common, Long, Quiet };

enum class JobState { Queued, Running, Stopping, Done, Failed, Cancelled };

struct JobStatus {
  int id = 0;
  std::string label;  // name of the job, such as "Diffuse heat"; also the label of its edit in the history
  JobState state = JobState::Queued;
  std::string stage;                   // the running stage, such as "weights"; empty before the first stage
  double fraction = 0;                 // finished fraction of the stage, [0, 1]
  double seconds = 0;                  // running time of the job, seconds
  std::optional<double> seconds_left;  // estimated time until the stage ends; empty: no estimate yet
  std::string message;                 // why the job failed

  bool active() const { return state == JobState::Queued || state == JobState::Running || state == JobState::Stopping; }
};

class Jobs {
 public:
  //   at_once    number of common jobs that run together; the others wait in order
  //   on_change  is called in any thread when the owner should call poll() (for example glfwPostEmptyEvent). Progress
  //              alone calls it at most 20 times a second per job. It must not call Jobs itself, and is never called
  //              after Jobs is destroyed.
  explicit Jobs(int at_once = 2, std::function<void()> on_change = {});
  // Cancels all jobs and waits at most a second for them to end.
  ~Jobs();
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  void set_at_once(int count) { at_once_ = count; }  // number of common jobs that run together from now on
  int start(std::string label, Work work, Lane lane = Lane::Common);  // returns the job's id
  void cancel(int id);
  void cancel_all();

  // Commits the edits of the finished jobs in the order in which they ended, and starts waiting jobs. Returns true
  // when any job's state changed since the last call.
  bool poll(History& history);

  // The jobs, oldest first. Ended jobs stay in the list until they are dismissed.
  std::vector<JobStatus> statuses() const;
  JobStatus status(int id) const;
  bool busy() const;  // true if any job is active, or any job's state has changed since the last poll()
  void dismiss(int id);
  void dismiss_ended();

  // Cancels all jobs and waits up to `seconds` for them to end. Returns false when a job still hangs. The program must
  // then end by std::_Exit, since destructors would free what the hanging job uses.
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
