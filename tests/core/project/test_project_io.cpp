// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/project_io.h"

#include <cmath>
#include <fstream>

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>

#include "core/base/error.h"
#include "tests/support/documents.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

namespace fs = std::filesystem;

std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string bytes_of_file(const Path& path) { return read_file(path); }

void write_bytes(const Path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

Project small_project() {
  return {
      .document = small_document(), .editor = "{\"workspace\": \"Pose\"}", .thumbnail = std::string("\x89PNG\0x", 6)};
}

}  // namespace

TEST_CASE("project: a document with every part comes back bit for bit, and parts that were one are one again") {
  const TemporaryFolder folder;
  DocumentWriter writer;
  const Project project = small_project();
  const SaveMark mark = create_project(project, folder / "a.limber", writer);
  CHECK(is_project(folder / "a.limber"));
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);

  const Project back = read_project(folder / "a.limber");
  CHECK(same_contents(back.document, project.document));
  CHECK(back.editor == project.editor);
  CHECK(back.thumbnail == project.thumbnail);
  CHECK(read_thumbnail(folder / "a.limber") == project.thumbnail);
  CHECK(back.mark == mark);
  CHECK(back.warnings.empty());
  CHECK(back.document.results[0]->from_volume == back.document.volume);
  CHECK(back.document.results[0]->from_weights == back.document.weights);
  CHECK(back.document.results[0]->from_pose == back.document.pose);
}

TEST_CASE("project: a result's overlap comes back, with a mesh or without") {
  const TemporaryFolder folder;
  DocumentWriter writer;
  Project project = small_project();
  auto result = std::make_shared<Result>(*project.document.results[0]);
  result->overlap = std::make_shared<const Overlap>(Overlap{{1, 5, 9}, {5}});
  project.document.results = {result};
  create_project(project, folder / "a.limber", writer);
  const Document back = read_project(folder / "a.limber").document;
  REQUIRE(back.results[0]->overlap);
  CHECK(*back.results[0]->overlap == *result->overlap);
  CHECK_FALSE(back.results[0]->solved);

  // An overlap of voxels that the posed volume does not have is refused.
  auto beyond = std::make_shared<Result>(*result);
  beyond->overlap = std::make_shared<const Overlap>(Overlap{{std::ssize(result->volume->voxels)}, {}});
  project.document.results = {beyond};
  create_project(project, folder / "b.limber", writer);
  CHECK_THROWS_AS(read_project(folder / "b.limber"), Error);
}

TEST_CASE("project: an empty document is a project too") {
  const TemporaryFolder folder;
  DocumentWriter writer;
  create_project({}, folder / "empty.limber", writer);
  CHECK(read_project(folder / "empty.limber").document == Document{});
}

TEST_CASE("project: random edits, each saved and read again, come back the same") {
  const TemporaryFolder folder;
  const Path path = folder / "a.limber";
  std::mt19937 random(5);
  DocumentWriter writer;
  Project project = small_project();
  SaveMark mark = create_project(project, path, writer);
  for (int i = 0; i < 40; ++i) {
    project.document = random_edit(project.document, random);
    mark = update_project(project, path, mark, i % 2 ? Unused::Remove : Unused::Keep, writer);
    const Project back = read_project(path);
    CHECK(same_contents(back.document, project.document));
    CHECK(back.mark == mark);
  }
  prune_project(path);
  CHECK(summarize_project(path).chunks == std::ssize(reachable_chunks(path)));
  CHECK(verify_project(path).empty());
}

TEST_CASE("project: saving writes only what changed") {
  const TemporaryFolder folder;
  const Path path = folder / "a.limber";
  DocumentWriter writer;
  Project project{.document = large_document(1)};
  const SaveMark mark = create_project(project, path, writer);
  const ProjectSummary before = summarize_project(path);

  SkinWeights weights = *project.document.weights;
  SkinWeights::Influences chunk = weights.chunk(3);
  chunk[5] = rigid_influence(0);
  weights.set_chunk(3, std::move(chunk));
  project.document.weights = std::make_shared<const SkinWeights>(std::move(weights));
  update_project(project, path, mark, Unused::Keep, writer);
  const ProjectSummary after = summarize_project(path);
  CHECK(after.chunks - before.chunks == 3);  // new chunks: the bricks' group, the weights' node, the root
  CHECK(after.chunk_bytes - before.chunk_bytes < before.chunk_bytes / 3);
  CHECK(same_contents(read_project(path).document, project.document));
}

TEST_CASE("project: one that another program changed, replaced or removed is not overwritten") {
  const TemporaryFolder folder;
  const Path path = folder / "a.limber";
  DocumentWriter writer, other_writer;
  Project project = small_project();
  const SaveMark mark = create_project(project, path, writer);
  const SaveMark other = update_project({}, path, mark, Unused::Remove, other_writer);
  CHECK(message_of([&] {
          update_project(project, path, mark, Unused::Remove, writer);
        }).starts_with("another program has changed the project"));
  CHECK(read_project(path).document == Document{});
  CHECK(read_mark(path) == other);

  fs::remove(path);
  CHECK(message_of([&] {
          update_project(project, path, other, Unused::Remove, writer);
        }).starts_with("the project does not exist"));
  CHECK_FALSE(fs::exists(path));
}

TEST_CASE("project: what is none, is newer, cut or damaged is refused in one line or read as it was") {
  const TemporaryFolder folder;
  const Path path = folder / "a.limber", copy = folder / "b.limber";
  DocumentWriter writer;
  const Project project = small_project();
  create_project(project, path, writer);
  const std::string whole = bytes_of_file(path);
  const auto read_copy = [&](const std::string& bytes) {
    write_bytes(copy, bytes);
    return message_of([&] {
      const Project back = read_project(copy);
      CHECK(same_contents(back.document, project.document));
    });
  };

  CHECK(read_copy("") == "this is not a Limber project: " + copy.string() + ": name a .limber file");
  CHECK(read_copy("limber").find("not a Limber project") != std::string::npos);
  CHECK(read_copy(whole.substr(0, 100)).find("not a Limber project") == std::string::npos);
  CHECK_FALSE(read_copy(whole.substr(0, 100)).empty());
  CHECK_FALSE(read_copy(whole.substr(0, whole.size() / 2)).empty());
  CHECK(message_of([&] { read_project(folder / "none.limber"); }).starts_with("the project does not exist"));
  CHECK_FALSE(message_of([&] { read_project(folder.path()); }).empty());

  std::string newer = whole, foreign = whole;
  newer[63] = 2;      // user_version
  foreign[71] = 'c';  // a byte of application_id
  CHECK(read_copy(newer).find("newer version") != std::string::npos);
  CHECK(read_copy(foreign).find("not a Limber project") != std::string::npos);

  std::mt19937 random(11);
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    std::string bent = whole;
    for (int k = 0; k < 1 + i % 4; ++k) bent[random() % bent.size()] ^= static_cast<char>(1 << random() % 8);
    const std::string message = read_copy(bent);
    refused += !message.empty();
    CHECK(message.find('\n') == std::string::npos);
  }
  CHECK(refused > 20);  // changes in unused parts of a small file have no effect
}

TEST_CASE("project: of a damaged one the parts that are whole can be kept, and verify names the others") {
  const TemporaryFolder folder;
  const Path path = folder / "a.limber";
  DocumentWriter writer;
  const Project project{.document = large_document(1)};
  create_project(project, path, writer);
  std::string bytes = bytes_of_file(path);
  // These bytes lie in the middle of the weights.
  for (std::size_t at = bytes.size() / 2; at < bytes.size() / 2 + 64; ++at) bytes[at] ^= 0x55;
  write_bytes(path, bytes);
  CHECK(message_of([&] { read_project(path); }).starts_with("the weights in the project cannot be read"));
  ReadLimits limits;
  limits.leave_out_damaged = true;
  const Project back = read_project(path, no_progress(), limits);
  CHECK(back.document.volume->voxels == project.document.volume->voxels);
  REQUIRE(back.document.weights);
  REQUIRE(back.document.weights->size() == project.document.weights->size());
  std::int64_t same = 0;
  for (std::int64_t brick = 0; brick < back.document.weights->chunk_count(); ++brick)
    same += back.document.weights->chunk(brick) == project.document.weights->chunk(brick);
  CHECK(same >= back.document.weights->chunk_count() - 32);  // all but one group of 32 bricks
  CHECK(same < back.document.weights->chunk_count());
  REQUIRE(back.warnings.size() == 1);
  CHECK(back.warnings[0].find("blocks of the weights are lost: their voxels got the weights of a neighbouring block") !=
        std::string::npos);
  CHECK(verify_project(path).size() == 2);
}

TEST_CASE("project: a volume that would not fit into memory is refused before it is allocated") {
  const TemporaryFolder folder;
  DocumentWriter writer;
  create_project({.document = large_document(1)}, folder / "a.limber", writer);
  ReadLimits limits;
  limits.most_bytes = 100'000;
  CHECK(message_of([&] { read_project(folder / "a.limber", no_progress(), limits); }).find("MB of memory") !=
        std::string::npos);
}

TEST_CASE(
    "project: weights, seams and a pose that fit no volume or rig are left out with a word, not the whole project") {
  const TemporaryFolder folder;
  DocumentWriter writer;
  Project project = small_project();
  project.document.volume = large_document(1).volume;
  project.document.pose = std::make_shared<const Pose>();
  create_project(project, folder / "a.limber", writer);
  const Project back = read_project(folder / "a.limber");
  CHECK(back.warnings.size() == 3);
  CHECK(back.document.weights == nullptr);
  CHECK(back.document.seams == nullptr);
  CHECK(back.document.pose == nullptr);
  CHECK(back.document.armature != nullptr);
}

TEST_CASE("project: one that is written over keeps its permissions, and a link to it stays") {
  const TemporaryFolder folder;
  DocumentWriter writer;
  fs::create_directory(folder / "far");
  create_project({}, folder / "far/a.limber", writer);
  fs::permissions(folder / "far/a.limber", fs::perms(0600));
  fs::create_symlink("far/a.limber", folder / "link.limber");
  create_project(small_project(), folder / "link.limber", writer);
  CHECK(fs::is_symlink(folder / "link.limber"));
  CHECK(fs::status(folder / "far/a.limber").permissions() == fs::perms(0600));
  CHECK(same_contents(read_project(folder / "far/a.limber").document, small_document()));
  CHECK(std::distance(fs::directory_iterator(folder / "far"), {}) == 1);
}

TEST_CASE("project: where there is no room, and in a folder that is read-only, a save leaves the file as it was") {
  const TemporaryFolder folder;
  const Path path = folder / "a.limber";
  fs::permissions(folder.path(), fs::perms(0777));
  DocumentWriter writer;
  const Project project{.document = large_document(1)};
  const SaveMark mark = create_project({}, path, writer);
  fs::permissions(path, fs::perms(0666));
  const std::string before = bytes_of_file(path);

  ::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  rlimit small = old;
  small.rlim_cur = 200'000;
  ::setrlimit(RLIMIT_FSIZE, &small);
  const std::string update = message_of([&] { update_project(project, path, mark, Unused::Remove, writer); });
  const std::string create = message_of([&] { create_project(project, folder / "b.limber", writer); });
  ::setrlimit(RLIMIT_FSIZE, &old);
  CHECK(update == "the project cannot be written: " + path.string() +
                      ": check that the disk has room and works, or save elsewhere");
  CHECK(create.find((folder / "b.limber").string()) != std::string::npos);
  CHECK(bytes_of_file(path) == before);
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);

  // Becomes a user who may not write to the folder, since root may write anywhere.
  fs::permissions(folder.path(), fs::perms(0555));
  const bool root = ::geteuid() == 0;
  if (root) REQUIRE(::seteuid(65534) == 0);
  const std::string in_read_only = message_of([&] { update_project(project, path, mark, Unused::Remove, writer); });
  const std::string new_in_read_only = message_of([&] { create_project(project, folder / "b.limber", writer); });
  CHECK(read_project(path).document == Document{});
  if (root) REQUIRE(::seteuid(0) == 0);
  fs::permissions(folder.path(), fs::perms(0755));
  CHECK(in_read_only ==
        "the project cannot be written: it or its folder is read-only: " + path.string() + ": save elsewhere");
  CHECK(new_in_read_only == "the project cannot be opened: " + (folder / "b.limber").string() +
                                ": check that you may read and write the file and its folder");
  CHECK(bytes_of_file(path) == before);
  update_project(project, path, mark, Unused::Remove, writer);
  CHECK(same_contents(read_project(path).document, project.document));
}

TEST_CASE("project: a clip's rate that no clip can have is refused") {
  const TemporaryFolder folder;
  for (const double rate : {1e-9, 1e9, std::nan("")}) {
    CAPTURE(rate);
    Project project;
    project.document.clips = {std::make_shared<const Clip>(Clip{.name = "steps", .rate = rate})};
    DocumentWriter writer;
    create_project(project, folder / "a.limber", writer);
    CHECK(message_of([&] { read_project(folder / "a.limber"); }) != "");
  }
  Project project;
  project.document.clips = {std::make_shared<const Clip>(Clip{.name = "steps", .rate = 0.01})};
  DocumentWriter writer;
  create_project(project, folder / "b.limber", writer);
  CHECK(read_project(folder / "b.limber").document.clips.size() == 1);
}
