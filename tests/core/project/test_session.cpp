// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/session.h"

#include <csignal>
#include <fstream>

#include <doctest/doctest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.h"
#include "tests/support/documents.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

namespace fs = std::filesystem;

constexpr double kLong = 30;  // seconds; only a failing test waits that long

SessionSettings settings_in(const TemporaryFolder& folder) {
  return {.edits_folder = folder / "state", .retry_seconds = 0.05, .watch_seconds = 0.05};
}

Document with_pose(Document document, double x) {
  Pose pose = *document.pose;
  pose.root_translation.x = x;
  document.pose = std::make_shared<const Pose>(std::move(pose));
  return document;
}

std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// Copies the files that a session leaves when its process dies. The copies hold no locks.
void copy_as_after_a_crash(const TemporaryFolder& from, const TemporaryFolder& to) {
  fs::copy(from.path(), to.path(),
           fs::copy_options::recursive | fs::copy_options::copy_symlinks | fs::copy_options::overwrite_existing);
}

Path make_project(const TemporaryFolder& folder, const Document& document = small_document()) {
  DocumentWriter writer;
  create_project({.document = document}, folder / "a.limber", writer);
  return folder / "a.limber";
}

template <class Condition>
bool soon(const Condition& condition) {
  for (int i = 0; i < 3000; ++i, ::usleep(10'000))
    if (condition()) return true;
  return false;
}

}  // namespace

TEST_CASE("session: what was kept is there after a crash, on top of the saved project, and after it is recovered") {
  const TemporaryFolder folder, crashed;
  const Path path = make_project(folder);
  Document last;
  {
    Project project;
    const auto session = Session::open(path, project, no_progress(), settings_in(folder));
    CHECK_FALSE(session->leftover());
    std::mt19937 random(3);
    last = project.document;
    for (int i = 0; i < 30; ++i) session->keep(last = random_edit(last, random), "edit " + std::to_string(i));
    REQUIRE(session->flush(kLong));
    CHECK(session->status().kept);
    CHECK(session->status().message.empty());
    CHECK(all_recoverable(folder / "state").empty());  // a session that still runs is not offered
    copy_as_after_a_crash(folder, crashed);
    session->discard();
  }
  CHECK_FALSE(fs::exists(journal_path(path)));
  CHECK(fs::is_empty(folder / "state"));

  // The journal names its project by path, so the copy replaces the original files.
  fs::remove_all(folder / "state");
  copy_as_after_a_crash(crashed, folder);
  const auto list = all_recoverable(folder / "state");
  REQUIRE(list.size() == 1);
  CHECK(list[0].project == path);
  CHECK(list[0].label == "edit 29");

  Project project;
  auto session = Session::open(path, project, no_progress(), settings_in(folder));
  REQUIRE(session->leftover());
  const Recovered recovered = session->recover();
  CHECK(recovered.warnings.empty());
  CHECK(same_contents(recovered.document, last));
  CHECK_FALSE(session->leftover());
  CHECK(session->flush(kLong));
  session->save({.document = recovered.document});
  session.reset();
  CHECK_FALSE(fs::exists(journal_path(path)));
  CHECK(same_contents(read_project(path).document, last));
}

TEST_CASE("session: a project that was never saved is kept too, and offered by the edits folder") {
  const TemporaryFolder folder;
  const Document document = small_document();
  {
    const auto session = Session::start(settings_in(folder));
    CHECK(session->path().empty());
    session->keep(document, "Open arm.nrrd");
    REQUIRE(session->flush(kLong));
    CHECK_FALSE(message_of([&] { session->save({.document = document}); }).empty());
  }  // the session ends with unsaved edits, as after a crash
  const auto list = all_recoverable(folder / "state");
  REQUIRE(list.size() == 1);
  CHECK(list[0].project.empty());
  CHECK(same_contents(recover(list[0].journal).document, document));
  discard(list[0].journal, folder / "state");
  CHECK(all_recoverable(folder / "state").empty());
}

TEST_CASE("session: save as gives it a file, and later saves write there") {
  const TemporaryFolder folder;
  const Document document = small_document(), next = with_pose(document, 5);
  auto session = Session::start(settings_in(folder));
  session->keep(document, "Open");
  session->save_as({.document = document, .editor = "{}"}, folder / "a.limber");
  CHECK(session->path() == fs::canonical(folder / "a.limber"));
  CHECK(std::distance(fs::directory_iterator(folder / "state"), {}) == 1);  // the only file is the link to the journal
  session->keep(next, "Pose");
  REQUIRE(session->flush(kLong));
  CHECK(session->save({.document = next}).empty());
  session->save_as({.document = next}, folder / "b.limber");
  CHECK_FALSE(fs::exists(journal_path(folder / "a.limber")));
  session.reset();
  CHECK(same_contents(read_project(folder / "a.limber").document, next));
  CHECK(same_contents(read_project(folder / "b.limber").document, next));
  CHECK(fs::is_empty(folder / "state"));
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 3);
}

TEST_CASE(
    "session: edits made while the project is being saved are kept, and undone ones need nothing the save removed") {
  const TemporaryFolder folder;
  const Document first = small_document(), second = with_pose(first, 1);
  const Path path = make_project(folder, first);
  Project project;
  {
    const auto session = Session::open(path, project, no_progress(), settings_in(folder));
    session->keep(second, "Pose");
    // The undo comes just before the save ends. The save has removed what the first document needs from the project.
    session->keep(first, "Undo");
    session->save({.document = second});
    REQUIRE(session->flush(kLong));
  }
  CHECK(verify_project(path).empty());
  CHECK(read_project(path).document.pose->root_translation.x == 1);
  const auto list = all_recoverable(folder / "state");
  REQUIRE(list.size() == 1);
  CHECK(same_contents(recover(list[0].journal).document, first));
}

TEST_CASE("session: two of them never have one project") {
  const TemporaryFolder folder;
  const Path path = make_project(folder);
  Project project, other;
  auto session = Session::open(path, project, no_progress(), settings_in(folder));
  const std::string expected =
      "the project is open in another Limber: " + fs::canonical(path).string() + ": close it there, or work on a copy";
  CHECK(message_of([&] { Session::open(path, other, no_progress(), settings_in(folder)); }) == expected);
  auto unsaved = Session::start(settings_in(folder));
  CHECK(message_of([&] { unsaved->save_as({}, path); }) == expected);
  CHECK(read_project(path).mark == project.mark);
  session->keep(with_pose(project.document, 1), "Pose");
  REQUIRE(session->flush(kLong));
  CHECK(message_of([&] { Session::open(path, other, no_progress(), settings_in(folder)); }) == expected);
  session->save({.document = project.document});
  CHECK(message_of([&] { Session::open(path, other, no_progress(), settings_in(folder)); }) == expected);
  session.reset();
  session = Session::open(path, other, no_progress(), settings_in(folder));
}

TEST_CASE("session: edits that are neither recovered nor dropped are set aside and offered again") {
  const TemporaryFolder folder;
  const Path path = make_project(folder);
  Project project;
  Document lost;
  {
    const auto session = Session::open(path, project, no_progress(), settings_in(folder));
    session->keep(lost = with_pose(project.document, 7), "Pose");
    REQUIRE(session->flush(kLong));
  }
  {
    const auto session = Session::open(path, project, no_progress(), settings_in(folder));
    CHECK(session->leftover());
    session->keep(with_pose(project.document, 8), "Another");
    REQUIRE(session->flush(kLong));
    CHECK_FALSE(session->leftover());
    const auto list = all_recoverable(folder / "state");
    REQUIRE(list.size() == 1);
    CHECK(same_contents(recover(list[0].journal).document, lost));
    session->discard();
  }
  {
    const auto session = Session::open(path, project, no_progress(), settings_in(folder));
    CHECK_FALSE(session->leftover());
  }
  CHECK(all_recoverable(folder / "state").size() == 1);
}

TEST_CASE("session: a journal that cannot be read, as one of another version, is set aside and not overwritten") {
  const TemporaryFolder folder;
  const Path path = make_project(folder);
  std::ofstream(journal_path(path)) << "from the future";
  Project project;
  const auto session = Session::open(path, project, no_progress(), settings_in(folder));
  CHECK_FALSE(session->leftover());
  CHECK(session->status().message.find("not a journal") != std::string::npos);
  CHECK(read_file(journal_path(path).string() + "-1") == "from the future");
  session->keep(with_pose(project.document, 1), "Pose");
  CHECK(session->flush(kLong));
}

TEST_CASE(
    "session: a project removed underneath loses nothing: the journal holds all of it, and a save writes it anew") {
  const TemporaryFolder folder;
  const Path path = make_project(folder);
  Project project;
  auto session = Session::open(path, project, no_progress(), settings_in(folder));
  const Document edited = with_pose(project.document, 3);
  session->keep(edited, "Pose");
  REQUIRE(session->flush(kLong));
  fs::remove(path);
  REQUIRE(soon([&] { return !session->status().message.empty(); }));
  CHECK(session->status().message.find("removed or replaced") != std::string::npos);
  CHECK(same_contents(recover(journal_path(path)).document, edited));  // recovered without the project's file

  CHECK(session->save({.document = edited}) == "The project's file had been removed. It was written again.");
  CHECK(session->status().message.empty());
  CHECK(same_contents(read_project(path).document, edited));

  // A save does not overwrite another project that is now at this path. Only Save as may overwrite it.
  fs::remove(path);
  DocumentWriter writer;
  create_project({}, path, writer);
  CHECK(message_of([&] { session->save({.document = edited}); }).starts_with("another program has changed"));
  CHECK(read_project(path).document == Document{});
  REQUIRE(soon([&] { return !session->status().message.empty(); }));
  CHECK(same_contents(recover(journal_path(path)).document, edited));
  session->save_as({.document = edited}, path);
  CHECK(same_contents(read_project(path).document, edited));
}

TEST_CASE("session: on a full disk nothing is lost, the message is clear, and all is kept once there is room") {
  const TemporaryFolder folder;
  const Path path = make_project(folder);
  Project project;
  auto session = Session::open(path, project, no_progress(), settings_in(folder));
  const Document small = with_pose(project.document, 1);
  session->keep(small, "Pose");
  REQUIRE(session->flush(kLong));
  const Document large = large_document(1);

  ::signal(SIGXFSZ, SIG_IGN);
  rlimit old{}, tight{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  tight = old;
  tight.rlim_cur = 100'000;
  ::setrlimit(RLIMIT_FSIZE, &tight);
  session->keep(large, "Import");
  REQUIRE(soon([&] { return !session->status().message.empty(); }));
  const SessionStatus status = session->status();
  CHECK(status.message.find("the disk is full: free some space, or save elsewhere") != std::string::npos);
  CHECK_FALSE(status.kept);
  CHECK(same_contents(recover(journal_path(path)).document, small));
  CHECK_FALSE(message_of([&] { session->save({.document = large}); }).empty());
  CHECK(same_contents(read_project(path).document, project.document));
  ::setrlimit(RLIMIT_FSIZE, &old);

  REQUIRE(session->flush(kLong));
  REQUIRE(soon([&] { return session->status().message.empty(); }));
  CHECK(same_contents(recover(journal_path(path)).document, large));
  session->save({.document = large});
  CHECK(same_contents(read_project(path).document, large));
}

TEST_CASE("session: a journal does not grow without end") {
  const TemporaryFolder folder;
  SessionSettings settings = settings_in(folder);
  settings.large_journal = 100'000;
  const Path path = make_project(folder, large_document(0));
  Project project;
  const auto session = Session::open(path, project, no_progress(), settings);
  Document document = project.document;
  std::uintmax_t one = 0, largest = 0;
  for (std::uint32_t i = 1; i <= 20; ++i) {
    document.weights = large_document(i).weights;
    session->keep(document, "Weights");
    REQUIRE(session->flush(kLong));
    const std::uintmax_t size = fs::file_size(journal_path(path));
    if (i == 1) one = size;
    largest = std::max(largest, size);
  }
  CHECK(largest < 6 * one);
  CHECK(same_contents(recover(journal_path(path)).document, document));
}

TEST_CASE("session: on a disk that is full to its last byte the journal and the project stay whole") {
  const TemporaryFolder folder;
  if (::mount("tmpfs", folder.path().c_str(), "tmpfs", 0, "size=6m") != 0) {
    MESSAGE("skipped: no disk can be mounted here");
    return;
  }
  struct Unmount {
    const Path path;
    ~Unmount() { ::umount2(path.c_str(), MNT_DETACH); }
  } unmount{folder.path()};
  const Path path = make_project(folder);
  Project project;
  auto session = Session::open(path, project, no_progress(), settings_in(folder));
  const Document small = with_pose(project.document, 1), large = large_document(1);
  session->keep(small, "Pose");
  REQUIRE(session->flush(kLong));
  const std::string filling(std::size_t{8} << 20, 'x');
  std::ofstream(folder / "filling") << filling;

  session->keep(large, "Import");
  REQUIRE(soon([&] { return !session->status().message.empty(); }));
  CHECK(session->status().message.find("the disk is full") != std::string::npos);
  CHECK(message_of([&] { session->save({.document = large}); }).find("the disk is full") != std::string::npos);
  CHECK(same_contents(recover(journal_path(path)).document, small));
  CHECK(verify_project(path).empty());

  fs::remove(folder / "filling");
  REQUIRE(session->flush(kLong));
  CHECK(same_contents(recover(journal_path(path)).document, large));
  session->save({.document = large});
  CHECK(same_contents(read_project(path).document, large));
}

TEST_CASE("session: of a project in a folder that may not be written the edits are kept among the user's own files") {
  const TemporaryFolder folder;
  fs::create_directory(folder / "shared");
  fs::create_directory(folder / "state");
  DocumentWriter writer;
  const Path path = folder / "shared" / "a.limber";
  create_project({.document = small_document()}, path, writer);
  for (const Path& place : {folder.path(), folder / "state"}) fs::permissions(place, fs::perms(0777));
  fs::permissions(folder / "shared", fs::perms(0555));
  const bool root = ::geteuid() == 0;  // root may write anywhere, so nothing fails
  if (root) REQUIRE(::seteuid(65534) == 0);
  {
    Project project;
    const auto session = Session::open(path, project, no_progress(), settings_in(folder));
    CHECK(session->status().message.empty());
    const Document edited = with_pose(project.document, 2);
    session->keep(edited, "Pose");
    CHECK(session->flush(kLong));
    CHECK(message_of([&] { session->save({.document = edited}); }) ==
          "the project cannot be written: it or its folder is read-only: " + path.string() + ": save elsewhere");
    Project other;
    CHECK(message_of([&] {
            Session::open(path, other, no_progress(), settings_in(folder));
          }).starts_with("the project is open in another"));
    session->save_as({.document = edited}, folder / "mine.limber");
    CHECK(same_contents(read_project(folder / "mine.limber").document, edited));
  }
  CHECK(fs::is_empty(folder / "state"));
  if (root) REQUIRE(::seteuid(0) == 0);
  fs::permissions(folder / "shared", fs::perms(0755));
}
