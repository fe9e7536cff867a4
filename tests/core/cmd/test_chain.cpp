// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

using namespace limber::test;

namespace {

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

size_t files_in(const std::filesystem::path& folder) {
  return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

nlohmann::json info_of(const std::string& path) {
  const auto run = run_limber({"info", path, "--json"});
  REQUIRE(run.exit_code == 0);
  return nlohmann::json::parse(run.out);
}

// The phantom arm with coarse voxels.
struct Arm {
  TemporaryFolder folder;
  std::string volume = folder / "volume.nrrd", rig = folder / "rig.json", motion = folder / "motion.bvh",
              tissues = folder / "tissues.json";

  explicit Arm(const std::string& spacing = "10") {
    REQUIRE(run_limber({"phantom", "arm", "--spacing", spacing, "-o", folder.path()}).exit_code == 0);
  }
};

// Starts the program and sends it a signal after `wait`. Returns its exit code, or 128 + the signal's number if a
// signal ended it.
int exit_code_after(int signal, std::chrono::milliseconds wait, const std::vector<std::string>& arguments) {
  std::vector<std::string> words{LIMBER_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  std::this_thread::sleep_for(wait);
  ::kill(child, signal);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

TEST_CASE(
    "command chain: a phantom is weighted and posed, weights from a file give the volume that weights on the way give" *
    doctest::test_suite("slow")) {
  const Arm arm;
  const std::string weights = arm.folder / "w.nrrd", direct = arm.folder / "direct.nrrd",
                    by_file = arm.folder / "by-file.nrrd", report = arm.folder / "report.json";
  REQUIRE(run_limber({"weights", arm.volume, "--rig", arm.rig, "-o", weights}).exit_code == 0);
  const std::vector<std::string> pose = {"resample",   arm.volume, "--rig", arm.rig,       "--flex",
                                         "Forearm=60", "--method", "dqs",   "--fit-joints"};
  auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), pose.begin(), pose.end());
    return run_limber(more).exit_code;
  };
  CHECK(with({"-o", direct, "--report", report}) == 0);
  CHECK(with({"-o", by_file, "--weights", weights, "--threads", "1"}) == 0);
  CHECK(bytes_of(direct) == bytes_of(by_file));
  CHECK(with({"-o", by_file, "--threads", "4"}) == 0);
  CHECK(bytes_of(direct) == bytes_of(by_file));

  const auto json = nlohmann::json::parse(bytes_of(report));
  CHECK(json["schema"] == "limber-report/1");
  for (const char* key : {"voxels_before", "voxels_after", "volume_change_percent", "overlap_voxels", "new_hole_voxels",
                          "trapped_air_voxels", "dropped_voxels"})
    CHECK_MESSAGE(json["total"].contains(key), key);
  CHECK(json["total"]["new_hole_voxels"] == 0);
  CHECK(json["total"]["dropped_voxels"] == 0);
  CHECK(json["inputs"].size() == 2);
  for (const auto& bone : json["bones"]) CHECK(bone["rigid_residual_mm"].get<double>() < 0.01);
}

TEST_CASE("command chain: the rest pose gives the input back, and report sees no change") {
  const Arm arm;
  const std::string posed = arm.folder / "posed.nrrd";
  REQUIRE(run_limber({"resample", arm.volume, "--rig", arm.rig, "--method", "lbs", "-o", posed}).exit_code == 0);
  CHECK(bytes_of(posed) == bytes_of(arm.volume));
  const auto report = nlohmann::json::parse(run_limber({"report", arm.volume, posed, "--json"}).out);
  CHECK(report["total"]["voxels_before"] == report["total"]["voxels_after"]);
  CHECK(report["tissues"].size() > 5);
}

TEST_CASE(
    "resample: --frames writes one volume and report for each frame, as --frame does, and refuses what would overwrite "
    "itself" *
    doctest::test_suite("slow")) {
  const Arm arm;
  const auto posed = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"resample",  arm.volume, "--rig",    arm.rig,    "--tissues",
                                      arm.tissues, "--motion", arm.motion, "--method", "dqs"};
    words.insert(words.end(), more.begin(), more.end());
    return run_limber(words);
  };
  REQUIRE(
      posed({"--frames", "2:12:5", "-o", arm.folder / "posed_{frame}.nrrd", "--report", arm.folder / "{frame}.json"})
          .exit_code == 0);
  for (const char* frame : {"2", "7", "12"}) {
    REQUIRE(posed({"--frame", frame, "-o", arm.folder / "one.nrrd"}).exit_code == 0);
    const std::string number = std::string(4 - std::string(frame).size(), '0') + frame;
    CHECK(bytes_of(arm.folder / ("posed_" + number + ".nrrd")) == bytes_of(arm.folder / "one.nrrd"));
    const auto report = nlohmann::json::parse(bytes_of(arm.folder / (number + ".json")));
    CHECK(report["settings"]["frame"] == std::stoi(frame));
    // A report states the times of its own frame. The time of work that is done once for all frames is stated in the
    // first frame's report.
    double stages = 0;
    for (const auto& [stage, seconds] : report["seconds"].items())
      if (stage != "total") stages += seconds.get<double>();
    CHECK(report["seconds"]["total"].get<double>() >= stages);
    CHECK(report["seconds"]["total"].get<double>() < 2 * stages + 0.5);
    CHECK(report["seconds"].contains("weights") == (number == "0002"));
  }
  CHECK_FALSE(std::filesystem::exists(arm.folder / "posed_0003.nrrd"));

  const std::string out = arm.folder / "no_{frame}.nrrd";
  const auto refused = [&](const std::vector<std::string>& words, const char* why) {
    const auto run = posed(words);
    CHECK(run.exit_code == 1);
    CHECK_MESSAGE(run.err.find(why) != std::string::npos, run.err);
  };
  refused({"--frames", "0:3", "-o", arm.folder / "no.nrrd"}, "put {frame} into its name");
  refused({"--frames", "3:0", "-o", out}, "this is not a range of frames");
  refused({"--frames", "0:3x", "-o", out}, "this is not a range of frames");
  refused({"--frames", "0:100000", "-o", out}, "the motion ends before that frame");
  refused({"--frames", "0:3", "--frame", "1", "-o", out}, "--frame and --frames exclude each other");
  refused({"--frames", "0:3", "--fit-joints", "-o", out}, "joints are fitted to one pose");
}

TEST_CASE(
    "resample: --mass-exact gives soft tissues their rest volumes and reports it, and refuses to make up more than is "
    "allowed" *
    doctest::test_suite("slow")) {
  const Arm arm("4");
  const std::string out = arm.folder / "out.nrrd", report = arm.folder / "report.json";
  const auto posed = [&](const char* degrees, const std::vector<std::string>& more) {
    std::vector<std::string> words = {
        "resample", arm.volume, "--rig", arm.rig, "--tissues", arm.tissues, "--flex", std::string("Forearm=") + degrees,
        "--method", "lbs",      "-o",    out,     "--report",  report};
    words.insert(words.end(), more.begin(), more.end());
    return run_limber(words);
  };
  REQUIRE(posed("20", {"--mass-exact", "--mass-limit", "5"}).exit_code == 0);
  const auto json = nlohmann::json::parse(bytes_of(report));
  CHECK(json["settings"]["mass_exact"] == true);
  CHECK(json["mass_exact"]["changed_voxels"] > 0);
  int judged = 0;
  for (const auto& tissue : json["mass_exact"]["tissues"])
    if (tissue["voxels_wanted"] >= 5000) {
      CHECK(tissue["voxels_after"].get<double>() ==
            doctest::Approx(tissue["voxels_wanted"].get<double>()).epsilon(0.001));
      ++judged;
    }
  CHECK(judged >= 2);

  std::filesystem::remove(out);
  const auto refused = posed("90", {"--mass-exact", "--mass-limit", "0.1"});
  CHECK(refused.exit_code == 1);
  CHECK(refused.err.find("to keep its mass, but at most 0.1 % is corrected: mass-exact: ") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(out));
  CHECK(posed("90", {"--mass-exact", "--nearest"}).exit_code == 1);
  CHECK(posed("90", {"--mass-limit", "2"}).exit_code == 2);
}

TEST_CASE("prepare: a volume that is prepared twice keeps its labels countable, and is not written over itself") {
  const Arm arm;
  const std::string padded = arm.folder / "padded.nrrd", bytes = bytes_of(arm.volume);
  CHECK(run_limber({"prepare", arm.volume, "-o", arm.volume, "--crop", "--pad", "2"}).exit_code == 2);
  CHECK(bytes_of(arm.volume) == bytes);
  CHECK(run_limber({"prepare", arm.volume, "-o", padded, "--crop", "--pad", "2"}).exit_code == 0);
  const auto before = info_of(padded);
  const std::string coarse = arm.folder / "coarse.mha", statistics = arm.folder / "s.csv";
  CHECK(run_limber({"prepare", padded, "-o", coarse, "--spacing", "20", "--flip", "x", "--statistics", statistics})
            .exit_code == 0);
  CHECK(info_of(coarse)["size"][2] == (before["size"][2].get<int>() + 1) / 2);
  CHECK(std::filesystem::file_size(statistics) > 0);
}

TEST_CASE("prepare: a voxel may become larger than the volume by more than whole numbers can tell") {
  const Arm arm;
  const std::string small = arm.folder / "small.nrrd", coarse = arm.folder / "coarse.nrrd";
  CHECK(run_limber({"prepare", arm.volume, "-o", small, "--spacing", "2000"}).exit_code == 0);
  std::string text = bytes_of(small);
  const size_t directions = text.find("space directions: "), end = text.find('\n', directions);
  REQUIRE(end != std::string::npos);
  std::ofstream(small, std::ios::binary) << text.replace(directions, end - directions,
                                                         "space directions: (1e-8,0,0) (0,1e-8,0) (0,0,1e-8)");
  CHECK(run_limber({"prepare", small, "-o", coarse, "--spacing", "30"}).exit_code == 0);
  CHECK(info_of(coarse)["size"] == nlohmann::json({1, 1, 1}));
}

TEST_CASE("fit-joint: a rig is written whose forearm turns freely") {
  const Arm arm;
  const std::string rig = arm.folder / "fitted.json";
  CHECK(run_limber({"fit-joint", arm.volume, "--rig", arm.rig, "--bone", "Forearm", "--range", "0,60", "-o", rig})
            .exit_code == 0);
  CHECK(info_of(rig)["bones"].size() == info_of(arm.rig)["bones"].size());
}

TEST_CASE("convert: volumes go through every format and come back bit for bit, rigs and motions keep bones and frames" *
          doctest::test_suite("slow")) {
  const Arm arm;
  const std::string back = arm.folder / "back.nrrd";
  const auto original = info_of(arm.volume);
  for (const char* name : {"a.mha", "a.mhd", "a.nii", "a.nii.gz", "a.hdr", "a.nhdr", "a.seg.nrrd", "a.txt"}) {
    const std::string there = arm.folder / name;
    CHECK_MESSAGE(run_limber({"convert", arm.volume, there}).exit_code == 0, name);
    CHECK_MESSAGE(run_limber({"convert", there, back}).exit_code == 0, name);
    const auto info = info_of(back);
    CHECK_MESSAGE(info["size"] == original["size"], name);
    REQUIRE(info["labels"].size() == original["labels"].size());
    for (size_t i = 0; i < info["labels"].size(); ++i) {
      CHECK(info["labels"][i]["value"] == original["labels"][i]["value"]);
      CHECK(info["labels"][i]["voxels"] == original["labels"][i]["voxels"]);
    }
  }
  for (const char* name : {"r.vtk", "r.bvh", "r.json"}) {
    const std::string there = arm.folder / name;
    CHECK_MESSAGE(run_limber({"convert", arm.rig, there}).exit_code == 0, name);
    const auto info = info_of(there);
    CHECK_MESSAGE(info[info.contains("bones") ? "bones" : "joints"].size() >= info_of(arm.rig)["bones"].size(), name);
  }
  const std::string motion = arm.folder / "m.bvh";
  CHECK(run_limber({"convert", arm.motion, motion}).exit_code == 0);
  CHECK(info_of(motion)["frames"] == info_of(arm.motion)["frames"]);
}

TEST_CASE("command line: an output that cannot be written is refused in one line before anything is computed" *
          doctest::test_suite("slow")) {
  const Arm arm;
  const std::string volume = arm.volume, rig = arm.rig, out = arm.folder / "out.nrrd";
  const size_t files = files_in(arm.folder.path());
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"resample", volume, "--rig", rig, "--method", "lbs", "-o", ""},
           {"resample", volume, "--rig", rig, "--method", "lbs", "-o", "/no/such/o.nrrd"},
           {"resample", volume, "--rig", rig, "--method", "lbs", "-o", out, "--field", arm.folder / "f.xyz"},
           {"resample", volume, "--rig", rig, "--method", "lbs", "-o", out, "--flex", "Forearm=nan"},
           {"resample", volume, "--rig", rig, "--method", "lbs", "-o", out, "--flex", "Forearm=1e308"},
           {"resample", volume, "--rig", rig, "--method", "lbs", "-o", out, "--motion", arm.motion, "--frame", "99999"},
           {"prepare", volume, "-o", out, "--statistics", "/no/such/s.csv"},
           {"prepare", volume, "-o", out, "--spacing", "1e9"},
           {"weights", volume, "--rig", rig, "-o", arm.folder / "w.mha"},
           {"fit-joint", volume, "--rig", rig, "--bone", "Forearm", "-o", "/no/such/r.json"},
           {"convert", volume, "/no\nsuch/o.nrrd"},
           {"report", "/dev/zero", volume}}) {
    const auto run = run_limber(words);
    CAPTURE(run.err);
    CHECK(run.exit_code == 1);
    CHECK(run.out.empty());
    CHECK(run.err.starts_with("limber: "));
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
  }
  CHECK(files_in(arm.folder.path()) == files);
}

TEST_CASE("command line: --progress json tells stages and rising fractions, one object a line") {
  const Arm arm;
  const auto run =
      run_limber({"weights", arm.volume, "--rig", arm.rig, "-o", arm.folder / "w.nrrd", "--progress", "json"});
  REQUIRE(run.exit_code == 0);
  std::istringstream lines(run.err);
  int objects = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('{')) continue;
    const auto step = nlohmann::json::parse(line);
    CHECK(step["stage"].is_string());
    CHECK(step["fraction"].get<double>() >= 0);
    CHECK(step["fraction"].get<double>() <= 1);
    ++objects;
  }
  CHECK(objects > 0);
}

TEST_CASE("command line: Ctrl-C ends with 3, a kill with nothing left, whenever it comes" *
          doctest::test_suite("slow")) {
  const Arm arm("5");
  const size_t files = files_in(arm.folder.path());
  for (const int wait : {20, 80, 200}) {
    const std::string out = arm.folder / "out.nrrd";
    const std::vector<std::string> words = {"resample",   arm.volume,  "--rig", arm.rig,        "--flex",
                                            "Forearm=90", "--method",  "dqs",   "--fit-joints", "--threads",
                                            "1",          "--spacing", "2",     "-o",           out};
    for (const int signal : {SIGINT, SIGKILL}) {
      const int code = exit_code_after(signal, std::chrono::milliseconds(wait), words);
      CAPTURE(code);
      // The program has either finished with a whole output, or it has stopped without one. Before main() runs, the
      // signal itself ends the process.
      const bool done = code == 0;
      CHECK((done || code == (signal == SIGINT ? 3 : 128 + SIGKILL) || (signal == SIGINT && code == 128 + SIGINT)));
      // SIGKILL may come after the output has its final name, but before the program ends.
      if (signal == SIGKILL && code == 128 + SIGKILL && std::filesystem::exists(out))
        CHECK(run_limber({"info", out}).exit_code == 0);
      else CHECK(std::filesystem::exists(out) == done);
      std::filesystem::remove(out);
      CHECK(files_in(arm.folder.path()) == files);
    }
  }
}

TEST_CASE(
    "weights: a rig 900 km away still gives every voxel its weights, one beyond any number of millimetres is refused" *
    doctest::test_suite("slow")) {
  const Arm arm;
  const auto rig = nlohmann::json::parse(bytes_of(arm.rig));
  const auto move_away = [&](double mm) {
    auto moved = rig;
    for (auto& bone : moved["bones"])
      for (const char* end : {"head", "tail"}) bone[end][0] = bone[end][0].get<double>() + mm;
    std::ofstream(arm.rig) << moved;
  };
  for (const char* method : {"heat", "geodesic", "rigid"}) {
    move_away(9e8);
    CHECK_MESSAGE(run_limber({"weights", arm.volume, "--rig", arm.rig, "--method", method, "-o", arm.folder / "w.nrrd"})
                          .exit_code == 0,
                  method);
    move_away(1e300);
    CHECK_MESSAGE(run_limber({"weights", arm.volume, "--rig", arm.rig, "--method", method, "-o", arm.folder / "w.nrrd"})
                          .exit_code == 1,
                  method);
  }
}
