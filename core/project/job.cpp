// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/job.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <new>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include "core/base/error.h"
#include "core/base/parallel.h"

namespace limber {

namespace {
using Clock = std::chrono::steady_clock;

constexpr auto kChangeInterval = std::chrono::milliseconds(50);
constexpr int kLongAtOnce = 1;   // number of long jobs that run together; each uses all cores
constexpr int kQuietAtOnce = 1;  // number of quiet jobs that run together
// Seconds; the end of a stage is estimated only after this time: early guesses vary.
constexpr double kFirstEstimate = 0.5;
constexpr double kLeastFraction = 0.02;  // the end of a stage is estimated only after this share: early guesses vary
constexpr double kPatience = 0.1;        // seconds for which a cancelled job that still runs keeps the next job waiting
constexpr double kFarewell = 1;          // seconds that the destructor of Jobs waits for running jobs to end

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::string out_of_memory(const std::string& label) {
  return Error("there is not enough memory", label,
               "use a coarser spacing or a smaller volume, or close other programs")
      .what();
}
}  // namespace

// The state that Jobs shares with the threads of its jobs. It outlives Jobs when a job hangs.
struct Jobs::Board {
  std::mutex mutex;  // guards the members below, and every job's status and edit
  std::condition_variable ended;
  std::function<void()> on_change;
  bool changed = false;
  std::vector<int> finished;  // ids of jobs whose edit must be committed, in the order in which they ended

  void tell() {  // the caller must hold the mutex
    changed = true;
    if (on_change) on_change();
  }
};

struct Jobs::Job final : Progress {
  Job(std::shared_ptr<Board> the_board, int id, std::string label, Work the_work, Lane the_lane)
      : board(std::move(the_board)),
        lane(the_lane),
        work(std::move(the_work)) {
    status.id = id;
    status.label = std::move(label);
  }

  void on_update(std::string_view stage, double fraction) override {
    const std::lock_guard lock(board->mutex);
    const bool new_stage = stage != status.stage;
    if (new_stage) {
      status.stage = stage;
      stage_started = Clock::now();
    }
    status.fraction = std::clamp(fraction, 0.0, 1.0);
    if (!new_stage && Clock::now() - last_told < kChangeInterval) return;
    last_told = Clock::now();
    board->tell();
  }

  const std::shared_ptr<Board> board;
  const Lane lane;
  Work work;
  std::jthread thread;  // only the thread that owns Jobs uses this member

  // The members below are guarded by board->mutex.
  JobStatus status;
  Edit edit;
  Clock::time_point started, stage_started, cancelled_at, last_told;
};

Jobs::Jobs(int at_once, std::function<void()> on_change) : at_once_(at_once), board_(std::make_shared<Board>()) {
  board_->on_change = std::move(on_change);
}

Jobs::~Jobs() {
  shut_down(kFarewell);
  {
    const std::lock_guard lock(board_->mutex);
    board_->on_change = {};
    for (const auto& job : jobs_)
      if (job->thread.joinable() && job->status.active()) job->thread.detach();
  }
  for (const auto& job : jobs_)
    if (job->thread.joinable()) job->thread.join();
}

int Jobs::start(std::string label, Work work, Lane lane) {
  const int id = next_id_++;
  {
    const std::lock_guard lock(board_->mutex);
    jobs_.push_back(std::make_shared<Job>(board_, id, std::move(label), std::move(work), lane));
    board_->changed = true;
  }
  start_waiting();
  return id;
}

// Does the job's work, in the job's own thread.
void Jobs::work_on(const std::shared_ptr<Job>& job, const std::shared_ptr<Board>& board) {
  JobState state = JobState::Done;
  std::string message;
  Edit edit;
  const std::string label = job->status.label;  // read without a lock, since the label never changes
  try {
    const CancelScope cancels_loops(*job);
    edit = job->work(*job);
  } catch (const Cancelled&) {
    state = JobState::Cancelled;
  } catch (const Error& error) {
    state = JobState::Failed;
    message = error.what();
  } catch (const std::bad_alloc&) {
    state = JobState::Failed;
    message = out_of_memory(label);
  } catch (const std::length_error&) {  // thrown for a vector longer than its max_size()
    state = JobState::Failed;
    message = out_of_memory(label);
  } catch (const std::exception& error) {
    state = JobState::Failed;
    message = Error("an internal error of the program", label, std::string(error.what()) + "; please report it").what();
  } catch (...) {
    state = JobState::Failed;
    message = Error("an internal error of the program", label, "please report what you did").what();
  }
  job->work = {};  // the job's inputs are freed here too

  const std::lock_guard lock(board->mutex);
  if (job->cancelled()) state = JobState::Cancelled;
  if (state != JobState::Done) edit = {};
  job->status.seconds = seconds_since(job->started);
  job->status.state = state;
  job->status.message = state == JobState::Failed ? message : "";
  if (state == JobState::Done) job->status.fraction = 1;
  job->edit = std::move(edit);
  if (job->edit) board->finished.push_back(job->status.id);
  board->tell();
  board->ended.notify_all();
}

void Jobs::start_waiting() {
  const std::lock_guard lock(board_->mutex);
  const std::array<int, 3> at_once{at_once_, kLongAtOnce, kQuietAtOnce};
  std::array<int, 3> running{};  // number of running jobs in each lane
  const auto running_beside = [&](const auto& job) -> int& { return running[static_cast<std::size_t>(job->lane)]; };
  for (const auto& job : jobs_)
    running_beside(job) += job->status.state == JobState::Running ||
                           (job->status.state == JobState::Stopping && seconds_since(job->cancelled_at) < kPatience);
  for (const auto& job : jobs_) {
    if (job->status.state != JobState::Queued || running_beside(job) >= at_once[static_cast<std::size_t>(job->lane)])
      continue;
    job->started = job->stage_started = Clock::now();
    try {
      job->thread = std::jthread([job, board = board_] { work_on(job, board); });
      job->status.state = JobState::Running;
      ++running_beside(job);
    } catch (const std::system_error&) {
      job->status.state = JobState::Failed;
      job->status.message =
          Error("no thread can be started", job->status.label, "close other programs and try again").what();
    }
    board_->changed = true;
  }
}

Jobs::Job* Jobs::find(int id) const {
  const auto job = std::find_if(jobs_.begin(), jobs_.end(), [&](const auto& one) { return one->status.id == id; });
  return job == jobs_.end() ? nullptr : job->get();
}

void Jobs::cancel(int id) {
  const std::lock_guard lock(board_->mutex);
  Job* job = find(id);
  if (!job || !job->status.active() || job->status.state == JobState::Stopping) return;
  job->cancel();
  job->cancelled_at = Clock::now();
  job->status.state = job->status.state == JobState::Queued ? JobState::Cancelled : JobState::Stopping;
  board_->changed = true;
}

void Jobs::cancel_all() {
  for (const JobStatus& status : statuses()) cancel(status.id);
}

bool Jobs::poll(History& history) {
  struct Finished {
    Job* job;
    std::string label;
    Edit edit;
  };
  std::vector<Finished> finished;
  bool changed = false;
  {
    const std::lock_guard lock(board_->mutex);
    for (int id : std::exchange(board_->finished, {}))
      if (Job* job = find(id)) finished.push_back({job, job->status.label, std::exchange(job->edit, {})});
  }
  for (Finished& one : finished) {
    std::string message;
    try {
      history.commit(one.label, one.edit(history.current()));
      continue;
    } catch (const std::bad_alloc&) {
      message = out_of_memory(one.label);
    } catch (const std::exception& error) {
      message = error.what();
    }
    const std::lock_guard lock(board_->mutex);
    one.job->status.state = JobState::Failed;
    one.job->status.message = message;
  }
  start_waiting();
  const std::lock_guard lock(board_->mutex);
  changed = std::exchange(board_->changed, false);
  return changed || !finished.empty();
}

std::vector<JobStatus> Jobs::statuses() const {
  std::vector<JobStatus> all;
  const std::lock_guard lock(board_->mutex);
  for (const auto& job : jobs_) {
    JobStatus status = job->status;
    if (status.state == JobState::Running || status.state == JobState::Stopping) {
      status.seconds = seconds_since(job->started);
      const double in_stage = seconds_since(job->stage_started);
      if (status.fraction >= kLeastFraction && in_stage >= kFirstEstimate)
        status.seconds_left = in_stage * (1 - status.fraction) / status.fraction;
    }
    all.push_back(std::move(status));
  }
  return all;
}

JobStatus Jobs::status(int id) const {
  for (JobStatus& status : statuses())
    if (status.id == id) return std::move(status);
  return {};
}

bool Jobs::busy() const {
  const std::lock_guard lock(board_->mutex);
  return board_->changed ||
         std::any_of(jobs_.begin(), jobs_.end(), [](const auto& job) { return job->status.active(); });
}

void Jobs::dismiss(int id) {
  std::shared_ptr<Job> gone;
  {
    const std::lock_guard lock(board_->mutex);
    const Job* job = find(id);
    if (!job || job->status.active() || job->edit) return;
    const auto place = std::find_if(jobs_.begin(), jobs_.end(), [&](const auto& one) { return one.get() == job; });
    gone = std::move(*place);
    jobs_.erase(place);
    board_->changed = true;
  }
  if (gone->thread.joinable()) gone->thread.join();  // the thread has ended, or is about to return
}

void Jobs::dismiss_ended() {
  for (const JobStatus& status : statuses())
    if (!status.active()) dismiss(status.id);
}

bool Jobs::shut_down(double seconds) {
  cancel_all();
  std::unique_lock lock(board_->mutex);
  return board_->ended.wait_for(lock, std::chrono::duration<double>(seconds), [&] {
    return std::none_of(jobs_.begin(), jobs_.end(), [](const auto& job) { return job->status.active(); });
  });
}

}  // namespace limber
