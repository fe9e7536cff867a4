// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs `limber resample --method fem` as a user or a worker process does.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/resample/fem_steps.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;
using nlohmann::json;

namespace {

// The phantom arm in files, with coarse voxels, so that tests are quick.
struct Arm {
  TemporaryFolder folder;
  Arm() {
    REQUIRE(run_limber({"phantom", "arm", "--spacing", "5", "-o", folder.path()}).exit_code == 0);
    REQUIRE(run_limber(words("weights", {"-o", folder / "w.nrrd"})).exit_code == 0);
  }
  std::vector<std::string> words(const std::string& command, const std::vector<std::string>& more) const {
    std::vector<std::string> all{command,     folder / "volume.nrrd", "--rig", folder / "rig.json",
                                 "--tissues", folder / "tissues.json"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  ProgramRun resample(std::vector<std::string> more) const {
    more.insert(more.end(), {"--weights", folder / "w.nrrd"});
    return run_limber(words("resample", more));
  }
};

}  // namespace

TEST_CASE(
    "fem command: options of finite elements are refused with other methods, unknown ones with it, in one line and "
    "without output" *
    doctest::test_suite("slow")) {
  const Arm arm;
  const std::string out = arm.folder / "out.nrrd";
  for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--method", "dqs", "--contact"},
                                                {"--method", "lbs", "--quality", "fine"},
                                                {"--method", "lbs", "--mesher", "tetgen"},
                                                {"--method", "dqs", "--solver-mesh", arm.folder / "m"}}) {
    auto words = wrong;
    words.insert(words.end(), {"--flex", "Forearm=20", "-o", out});
    const auto run = arm.resample(words);
    INFO(run.err);
    CHECK(run.exit_code == 1);
    CHECK(run.err.starts_with("limber: " + wrong[2]));
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
  }
  CHECK(arm.resample({"--method", "fem", "--quality", "perfect", "-o", out}).exit_code == 2);
  CHECK(arm.resample({"--method", "fem", "--mesher", "cubes", "-o", out}).exit_code == 2);
  CHECK(arm.resample({"--method", "fem", "--friction", "-o", out}).exit_code == 2);
  const auto no_mesh = arm.resample({"--method", "fem", "--solver-mesh", arm.folder / "m", "-o", out});
  CHECK(no_mesh.exit_code == 1);
  CHECK(no_mesh.err.starts_with("limber: the pose bends no tissue"));
  const auto twice = arm.resample({"--method", "fem", "--flex", "Forearm=20", "--solver-mesh", arm.folder / "m", "-o",
                                   out, "--report", arm.folder / "m.ele"});
  CHECK(twice.exit_code == 2);
  CHECK(twice.err.find("two outputs would be the same file") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(out));
}

TEST_CASE("fem command: the steps that it leaves for a watcher end where the mesh does" * doctest::test_suite("slow")) {
  const Arm arm;
  const auto run =
      arm.resample({"--method", "fem", "--quality", "draft", "--mesher", "tetgen", "--flex", "Forearm=20", "-o",
                    arm.folder / "out.nrrd", "--solver-mesh", arm.folder / "posed", "--steps", arm.folder / "solve"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const auto mesh = read_fem_mesh(arm.folder / "solve");
  const auto step = read_fem_step(arm.folder / "solve");
  REQUIRE(mesh);
  REQUIRE(step);
  CHECK(step->reached == 1);
  CHECK(step->iteration > 0);
  CHECK_FALSE(step->motions.empty());
  std::ifstream nodes(arm.folder / "posed.node");
  std::size_t count = 0, skipped = 0;
  nodes >> count >> skipped >> skipped >> skipped;
  REQUIRE(count == static_cast<std::size_t>(step->V.rows()));
  REQUIRE(mesh->tets.V.rows() == step->V.rows());
  double worst = 0;
  for (std::size_t v = 0; v < count; ++v) {
    double index, x, y, z;
    nodes >> index >> x >> y >> z;
    worst = std::max(worst, (step->V.row(v) - Eigen::RowVector3d(x, y, z)).norm());
  }
  CHECK(nodes);
  CHECK(worst < 1e-3);
  CHECK((step->V - mesh->tets.V).rowwise().norm().maxCoeff() > 10);  // mm: the forearm has moved

  // The command prints which share of the body the mesh holds. The test computes it from the volumes of the tets at
  // rest, which reach a little beyond the tissue.
  double mesh_mm3 = 0;
  for (int t = 0; t < mesh->tets.T.rows(); ++t) {
    const auto corner = [&](int i) -> Eigen::RowVector3d { return mesh->tets.V.row(mesh->tets.T(t, i)); };
    mesh_mm3 += std::abs((corner(1) - corner(0)).dot((corner(2) - corner(0)).cross(corner(3) - corner(0)))) / 6;
  }
  const LabelVolume rest = read_volume(arm.folder / "volume.nrrd").volume;
  const double body_mm3 =
      rest.grid.voxel_volume() *
      double(rest.voxels.size() - std::size_t(std::count(rest.voxels.begin(), rest.voxels.end(), Label{0})));
  const std::size_t told = run.err.find("the soft tissue that bends: ");
  REQUIRE(told != std::string::npos);
  const double share = std::stod(run.err.substr(told + 28));
  CHECK(share > 5);
  CHECK(share < 100 * mesh_mm3 / body_mm3);
  CHECK(share > 80 * mesh_mm3 / body_mm3);
  CHECK(run.err.find("rigid and unbent parts are missing") != std::string::npos);
  CHECK(arm.resample({"--method", "dqs", "--flex", "Forearm=20", "-o", arm.folder / "out.nrrd", "--steps",
                      arm.folder / "solve"})
            .err.starts_with("limber: --steps"));
}

TEST_CASE(
    "fem command: writes volume, report and mesh, tells angle, iteration, residual and time left, a job does the same "
    "bit for bit" *
    doctest::test_suite("slow")) {
  const Arm arm;
  const auto run =
      arm.resample({"--method", "fem", "--quality", "draft", "--flex", "Forearm=25", "-o", arm.folder / "out.nrrd",
                    "--report", arm.folder / "r.json", "--solver-mesh", arm.folder / "posed", "--progress", "json"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);

  const json report = json::parse(read_file(arm.folder / "r.json"));
  CHECK(report["method"] == "fem");
  CHECK(report["settings"]["contact"] == false);
  CHECK(report["settings"]["quality"] == "draft");
  CHECK(report["solve"]["converged"] == true);
  CHECK(report["solve"]["iterations"] > 0);
  CHECK(report["mesh"]["inverted"] == 0);
  CHECK(report["seconds"].contains("mesh"));
  CHECK(report["seconds"].contains("solve"));

  int iterations = 0;
  double last = 0;
  std::istringstream lines(run.err);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('{')) continue;
    const json step = json::parse(line);
    CHECK(step.contains("fraction"));
    if (!step.contains("iteration")) continue;
    ++iterations;
    CHECK(step["stage"] == "solving");
    CHECK(step["angle_degrees"].get<double>() == doctest::Approx(25 * step["fraction"].get<double>()).epsilon(0.001));
    CHECK(step["residual_mm"] >= 0.0);
    CHECK(step["seconds_left"] >= 0.0);
    last = step["fraction"];
  }
  CHECK(iterations == report["solve"]["iterations"].get<int>());
  CHECK(last == 1);

  // The files hold as many nodes and tets as the report says, and each tet has a tissue of the volume.
  std::ifstream nodes(arm.folder / "posed.node"), tets(arm.folder / "posed.ele");
  std::int64_t count = 0;
  nodes >> count;
  CHECK(count == report["mesh"]["nodes"].get<std::int64_t>());
  int four = 0, one = 0;
  tets >> count >> four >> one;
  CHECK(count == report["mesh"]["tets"].get<std::int64_t>());
  std::int64_t without = 0;
  double index, corner, label;
  while (tets >> index >> corner >> corner >> corner >> corner >> label) without += label == 0;
  CHECK(without == 0);

  std::ofstream(arm.folder / "job.json")
      << R"({"command": "resample", "volume": "volume.nrrd", "rig": "rig.json", "tissues": "tissues.json",
        "weights": "w.nrrd",
    "flex": ["Forearm=25"], "method": "fem", "quality": "draft", "contact": false, "output": "job.nrrd"})";
  REQUIRE(run_limber({"job", arm.folder / "job.json"}).exit_code == 0);
  CHECK(read_file(arm.folder / "job.nrrd") == read_file(arm.folder / "out.nrrd"));
}

namespace {

// Waits until the process handles Ctrl-C itself. Before that, the signal ends it.
void await_handler(pid_t child) {
  for (int tries = 0; tries < 5000; ++tries) {
    std::ifstream in("/proc/" + std::to_string(child) + "/status");
    for (std::string line; std::getline(in, line);)
      if (line.starts_with("SigCgt:") && std::stoull(line.substr(7), nullptr, 16) >> (SIGINT - 1) & 1) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

}  // namespace

TEST_CASE("fem command: Ctrl-C ends a solve within a tenth of a second and leaves nothing behind" *
          doctest::test_suite("slow")) {
  const Arm arm;
  const auto words = [&] {
    auto all = arm.words("resample", {"--weights", arm.folder / "w.nrrd", "--method", "fem", "--contact", "--flex",
                                      "Forearm=80", "-o", arm.folder / "out.nrrd"});
    all.insert(all.begin(), LIMBER_PROGRAM);
    return all;
  }();
  for (const int wait_ms : {150, 600, 1500}) {
    const pid_t child = ::fork();
    if (child == 0) {
      std::vector<char*> argv;
      for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
      argv.push_back(nullptr);
      ::execv(LIMBER_PROGRAM, argv.data());
      ::_exit(127);
    }
    await_handler(child);
    std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
    const auto asked = std::chrono::steady_clock::now();
    ::kill(child, SIGINT);
    int status = 0;
    ::waitpid(child, &status, 0);
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - asked).count();
    INFO("after ", wait_ms, " ms");
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) continue;  // the program had finished before the signal
    CHECK(took < 0.1);
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 3);
    CHECK_FALSE(std::filesystem::exists(arm.folder / "out.nrrd"));
  }
}
