// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests what is recovered of a project that has lost pages. SQLite's table `dbstat` tells on which page each row lies,
// and so which chunks were hit.
#include <algorithm>
#include <fstream>
#include <map>
#include <random>
#include <set>

#include <doctest/doctest.h>
#include <sqlite3.h>

#include "core/base/error.h"
#include "core/project/carved_project.h"
#include "core/project/session.h"
#include "tests/support/documents.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPage = 8192;

// Reads rows of text and blobs by plain SQLite, without the program's own code.
std::vector<std::vector<std::string>> rows(const Path& path, const char* sql) {
  sqlite3* handle = nullptr;
  REQUIRE(sqlite3_open_v2(path.c_str(), &handle, SQLITE_OPEN_READONLY, nullptr) == SQLITE_OK);
  sqlite3_stmt* statement = nullptr;
  REQUIRE(sqlite3_prepare_v2(handle, sql, -1, &statement, nullptr) == SQLITE_OK);
  std::vector<std::vector<std::string>> all;
  while (sqlite3_step(statement) == SQLITE_ROW) {
    auto& row = all.emplace_back();
    for (int i = 0; i < sqlite3_column_count(statement); ++i) {
      const void* bytes = sqlite3_column_blob(statement, i);
      row.emplace_back(static_cast<const char*>(bytes), static_cast<std::size_t>(sqlite3_column_bytes(statement, i)));
    }
  }
  sqlite3_finalize(statement);
  sqlite3_close(handle);
  return all;
}

// Returns the pages of each chunk by its hash: the leaf page with the chunk's cell, and the cell's overflow pages. The
// path "/001/003+000002" names an overflow page of cell 3 in the leaf "/001/". The cells of all leaves have the order
// of the rows.
std::map<std::string, std::set<int>> pages_of_chunks(const Path& path) {
  const auto hashes = rows(path, "SELECT hash FROM chunk ORDER BY rowid");
  std::map<std::string, std::pair<int, int>> leaves;  // path -> page number, and number of cells
  std::map<std::string, std::map<int, std::set<int>>> overflow;
  for (const auto& row :
       rows(path, "SELECT path, pageno, ncell, pagetype FROM dbstat WHERE name = 'chunk' ORDER BY path")) {
    const int page = std::stoi(row[1]);
    if (row[3] == "leaf") leaves[row[0]] = {page, std::stoi(row[2])};
    if (row[3] != "overflow") continue;
    const std::size_t slash = row[0].rfind('/'), plus = row[0].rfind('+');
    overflow[row[0].substr(0, slash + 1)][std::stoi(row[0].substr(slash + 1, plus - slash - 1), nullptr, 16)].insert(
        page);
  }
  std::map<std::string, std::set<int>> pages;
  std::size_t next = 0;
  for (const auto& [leaf, page_and_cells] : leaves) {
    // If the table is a single leaf, its path does not end with a slash.
    const std::string prefix = leaf.ends_with('/') ? leaf : leaf + "/";
    for (int cell = 0; cell < page_and_cells.second; ++cell) {
      auto& of_chunk = pages[hashes.at(next++)[0]];
      of_chunk = overflow[prefix][cell];
      of_chunk.insert(page_and_cells.first);
    }
  }
  REQUIRE(next == hashes.size());
  return pages;
}

void put_bytes(const Path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

// Copies the file with a random tenth of its pages, at least one, set to zero.
std::set<int> zero_pages(const Path& from, const Path& to, std::mt19937& random, const std::set<int>& also = {}) {
  std::string bytes = read_file(from);
  std::vector<int> all(bytes.size() / kPage);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i) + 1;
  std::shuffle(all.begin(), all.end(), random);
  std::set<int> zeroed(all.begin(), all.begin() + std::max<std::ptrdiff_t>(1, std::ssize(all) / 10));
  zeroed.insert(also.begin(), also.end());
  for (const int page : zeroed)
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>((page - 1) * kPage), kPage, '\0');
  put_bytes(to, bytes);
  return zeroed;
}

// Makes a body whose labels change after `run` voxels on average, so that each chunk of 32 slices takes several pages.
Document rich_document(int chunks, unsigned run) {
  Document document = large_document(1);
  auto volume = std::make_shared<LabelVolume>(*document.volume);
  std::mt19937 random(3);
  volume->grid.size = {128, 128, 32 * chunks};
  volume->voxels.resize(static_cast<std::size_t>(volume->grid.voxel_count()));
  Label label = 0;
  unsigned left = 0;
  for (Label& voxel : volume->voxels) {
    if (left-- == 0) {
      label = static_cast<Label>(random() % 3);
      left = random() % (2 * run);
    }
    voxel = label;
  }
  document.weights = nullptr;  // the weights belong to another volume
  document.seams = nullptr;
  document.volume = volume;
  const Document small = small_document();
  document.armature = small.armature;
  document.pose = small.pose;
  document.clips = small.clips;
  return document;
}

}  // namespace

TEST_CASE("carved project: with a tenth of its pages lost, every chunk none of whose pages were lost comes back" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const Path whole = folder / "whole.limber", hit = folder / "hit.limber", out = folder / "out.limber";
  std::size_t untouched = 0, back = 0, in_file = 0, runs = 0;
  for (const bool rich : {true, false}) {
    DocumentWriter writer;
    create_project({.document = rich ? rich_document(16, 64) : large_document(1)}, whole, writer);
    const auto pages = pages_of_chunks(whole);
    for (std::uint32_t seed = 0; seed < 10; ++seed) {
      std::mt19937 random(seed);
      const auto zeroed = zero_pages(whole, hit, random);
      CarvedChunks carved(hit);
      fs::remove(out);
      const ProgramRun run = run_limber({"project", hit, "recover", "-o", out});
      std::set<std::string> recovered;
      if (run.exit_code == 0)
        for (const auto& row : rows(out, "SELECT hash FROM chunk")) recovered.insert(row[0]);
      runs += run.exit_code == 0;
      for (const auto& [name, of_chunk] : pages) {
        if (std::any_of(of_chunk.begin(), of_chunk.end(), [&](int page) { return zeroed.contains(page); })) continue;
        ChunkHash hash;
        std::copy(name.begin(), name.end(), hash.bytes.begin());
        ++untouched;
        back += carved.find(hash).has_value();
        in_file += recovered.contains(name);
      }
    }
  }
  MESSAGE(untouched, " chunks untouched, ", back, " carved, ", in_file, " in recovered projects; ", runs,
          " of 20 runs");
  CHECK(runs >= 18);  // the files of the other runs have no undamaged chunk
  CHECK(untouched > 200);
  CHECK(back == untouched);
  CHECK(static_cast<double>(in_file) >= 0.85 * static_cast<double>(untouched));
}

TEST_CASE("carved project: blocks of voxels that are whole come back in their places, whatever else is lost") {
  const TemporaryFolder folder;
  const Path whole = folder / "whole.limber", hit = folder / "hit.limber", out = folder / "out.limber";
  DocumentWriter writer;
  const Document document = rich_document(3, 1);
  create_project({.document = document}, whole, writer);
  constexpr std::size_t kBlock = (std::size_t{1} << 20) / sizeof(Label);  // voxels of a chunk
  // Loses one overflow page of the volume's second block, so that one of three blocks is lost.
  std::string bytes = read_file(whole);
  const auto pages = pages_of_chunks(whole);
  ChunkHash second =
      hash_of({reinterpret_cast<const char*>(document.volume->voxels.data() + kBlock), kBlock * sizeof(Label)});
  const auto& of_second = pages.at(std::string(second.bytes.begin(), second.bytes.end()));
  REQUIRE(of_second.size() > 4);
  const int lost = *std::next(of_second.rbegin());
  for (const bool header_too : {false, true}) {
    std::string damaged = bytes;
    std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>((lost - 1) * kPage), kPage, '\0');
    if (header_too) std::fill_n(damaged.begin(), kPage, '\0');
    put_bytes(hit, damaged);
    fs::remove(out);
    const ProgramRun run = run_limber({"project", hit, "recover", "-o", out});
    INFO(run.out, run.err);
    REQUIRE(run.exit_code == 0);
    CHECK(run.err.find("1 of 3 blocks of the volume are lost: their voxels, within slices 32 to 63, are air") !=
          std::string::npos);
    const Document back = read_project(out).document;
    REQUIRE(back.volume);
    REQUIRE(back.volume->voxels.size() == document.volume->voxels.size());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < back.volume->voxels.size(); ++i)
      wrong += back.volume->voxels[i] != (i / kBlock == 1 ? 0 : document.volume->voxels[i]);
    CHECK(wrong == 0);
    CHECK(back.armature->bones == document.armature->bones);
    CHECK(back.clips.size() == document.clips.size());
  }
}

TEST_CASE(
    "carved project: without root and list of states its parts are put together again, and what is none is refused") {
  const TemporaryFolder folder;
  const Path whole = folder / "whole.limber", hit = folder / "hit.limber";
  DocumentWriter writer;
  const Document document = small_document();
  create_project({.document = document, .editor = "{}"}, whole, writer);
  const SaveMark mark = read_mark(whole);
  // Damages the root chunk, which the test finds in the file by the chunk's packed bytes.
  const auto packed = rows(whole, "SELECT packed FROM chunk ORDER BY rowid DESC LIMIT 1");
  std::string bytes = read_file(whole);
  const std::size_t at = bytes.find(packed.at(0).at(0));
  REQUIRE(at != std::string::npos);
  for (std::size_t i = at + 6; i < at + 12; ++i) bytes[i] ^= 0x55;
  put_bytes(hit, bytes);
  CarvedChunks carved(hit);
  CHECK_FALSE(carved.find(mark.root));
  CHECK(carved.state("editor") == "{}");
  const Project back = put_together(carved, "hit");
  CHECK(back.document.volume->voxels == document.volume->voxels);
  CHECK(back.document.weights->bones() == document.weights->bones());
  CHECK(back.document.results.size() == document.results.size());
  CHECK(back.document.clips.size() == document.clips.size());
  CHECK(back.document.poses.size() == document.poses.size());
  CHECK(back.warnings.at(0).starts_with("the list of the project's parts is lost"));

  put_bytes(hit, std::string(100'000, '\x0d'));
  const ProgramRun run = run_limber({"project", hit, "recover", "-o", folder / "out.limber"});
  CHECK(run.exit_code == 1);
  CHECK(run.err.find("no part of a project was found") != std::string::npos);
  CHECK_FALSE(fs::exists(folder / "out.limber"));
}

TEST_CASE("carved project: the volume it was made from, or an earlier copy, gives back what was lost" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const std::string whole = folder / "whole.limber", hit = folder / "hit.limber", volume = folder / "volume.nrrd";
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "4", "-o", folder.path()}).exit_code == 0);
  const std::string rig = folder / "rig.json", weights = folder / "w.nrrd", tissues = folder / "tissues.json";
  REQUIRE(run_limber({"weights", volume, "--rig", rig, "--tissues", tissues, "--method", "rigid", "-o", weights})
              .exit_code == 0);
  REQUIRE(run_limber({"project", whole, "create", volume, "--rig", rig, "--tissues", tissues, "--weights", weights})
              .exit_code == 0);
  const Document document = read_project(whole).document;
  const std::size_t bytes_of_volume = document.volume->voxels.size() * sizeof(Label);
  const ChunkHash first = hash_of(
      {reinterpret_cast<const char*>(document.volume->voxels.data()), std::min<std::size_t>(bytes_of_volume, 1 << 20)});
  std::string bytes = read_file(whole);
  // Damages the beginning of the packed volume.
  for (const auto& row : rows(whole, "SELECT hash, packed FROM chunk"))
    if (std::equal(row[0].begin(), row[0].end(), reinterpret_cast<const char*>(first.bytes.data()))) {
      const std::size_t at = bytes.find(row[1].substr(0, 200));
      REQUIRE(at != std::string::npos);
      for (std::size_t i = at + 20; i < at + 40; ++i) bytes[i] ^= 0x55;
    }
  put_bytes(hit, bytes);
  const auto recovered = [&](const std::string& help) {
    std::vector<std::string> words{"project", hit, "recover", "-o", folder / "out.limber", "--replace"};
    if (!help.empty()) words.insert(words.begin() + 3, help);
    const ProgramRun run = run_limber(words);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return read_project(folder / "out.limber").document;
  };
  CHECK_FALSE(recovered("").weights);
  for (const std::string& help : {volume, whole}) {
    const Document back = recovered(help);
    REQUIRE(back.volume);
    REQUIRE(back.weights);
    CHECK(back.volume->voxels == document.volume->voxels);
    CHECK(*back.weights == *document.weights);
  }
}

TEST_CASE("carved project: edits that a crash left come back although pages of the project they build on are lost") {
  const TemporaryFolder folder;
  const Path project = folder / "a.limber";
  DocumentWriter writer;
  const Document document = rich_document(3, 1);
  create_project({.document = document}, project, writer);
  Project opened;
  {
    const auto session = Session::open(project, opened, no_progress(), {.edits_folder = folder / "state"});
    Pose pose = *opened.document.pose;
    pose.rotation[1] = {0.6, 0.8, 0, 0};
    opened.document.pose = std::make_shared<const Pose>(pose);
    session->keep(opened.document, "Turn");
    REQUIRE(session->flush(30));
  }
  const auto pages = pages_of_chunks(project);
  const ChunkHash second =
      hash_of({reinterpret_cast<const char*>(document.volume->voxels.data()) + (1 << 20), 1 << 20});
  std::string bytes = read_file(project);
  const int lost = *std::next(pages.at(std::string(second.bytes.begin(), second.bytes.end())).rbegin());
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>((lost - 1) * kPage), kPage, '\0');
  put_bytes(project, bytes);
  const ProgramRun run = run_limber({"project", project, "recover", "-o", folder / "out.limber"});
  INFO(run.out, run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.out == "edits recovered up to: Turn\n");
  CHECK(run.err.find("1 of 3 blocks of the volume are lost") != std::string::npos);
  const Document back = read_project(folder / "out.limber").document;
  REQUIRE(back.pose);
  CHECK(back.pose->rotation[1] == opened.document.pose->rotation[1]);
  CHECK(back.volume);
}
