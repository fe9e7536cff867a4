// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/report.h"

#include <sstream>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/volume_io/volume_io.h"
#include "tests/support/program.h"

using namespace limber;
using nlohmann::json;

namespace {
LabelVolume box_of(Label label, int edge) {
  LabelVolume volume{{.size = {20, 20, 20}, .spacing = {2, 2, 2}}, ZeroedVector<Label>(8000)};
  for (int z = 5; z < 5 + edge; ++z)
    for (int y = 5; y < 5 + edge; ++y)
      for (int x = 5; x < 5 + edge; ++x) volume.at({x, y, z}) = label;
  return volume;
}

TissueTable table_of(Label label, double file_value, const std::string& name, TissueKind kind = TissueKind::Fat) {
  TissueTable tissues;
  tissues.tissues.push_back({.label = label, .file_value = file_value, .name = name, .kind = kind});
  return tissues;
}
}  // namespace

TEST_CASE("report: what was not measured is left out, not filled with zeros") {
  const json empty = json::parse(to_json(Report{}));
  CHECK(empty["schema"] == "limber-report/1");
  CHECK(empty.contains("version"));
  CHECK(empty["peak_memory_mb"] > 1.0);
  CHECK(empty.size() == 3);

  Report compared{.metrics = compare(box_of(1, 8), box_of(1, 8), table_of(1, 5, "fat"))};
  const json some = json::parse(to_json(compared));
  CHECK_FALSE(some.contains("skin"));
  CHECK_FALSE(some.contains("method"));
  CHECK_FALSE(some.contains("seconds"));
  CHECK_FALSE(some["total"].contains("new_hole_voxels"));
  CHECK_FALSE(some["tissues"][0].contains("overlap_voxels"));

  compared.metrics = compare(box_of(0, 8), box_of(1, 8), table_of(1, 5, "fat"));
  CHECK_FALSE(json::parse(to_json(compared))["tissues"][0].contains("volume_change_percent"));
}

TEST_CASE("report: carries method, settings, inputs, seconds, tissues, totals and bones under the schema's keys") {
  Report report;
  report.method = "dqs";
  report.settings = {{"nearest", false},
                     {"spacing", 2.0},
                     {"threads", std::int64_t{4}},
                     {"flex", std::vector<std::string>{"Forearm=45"}},
                     {"weights", std::string("heat")}};
  report.inputs = {{"arm.mha", "00ff"}};
  report.seconds.read = 0.5;
  report.seconds.total = 1.5;
  report.metrics = compare(box_of(3, 10), box_of(3, 5), table_of(3, 143, "skin", TissueKind::Skin));
  DeformReport deform{.dropped_voxels = 1, .new_hole_voxels = 2, .overlap_voxels = 3, .bone_overlap_voxels = 4};
  deform.overlap_by_label.assign(65536, 0);
  deform.overlap_by_label[3] = 3;
  deform.bones = {{"Forearm", 0.004}};
  report.deform = deform;

  const json written = json::parse(to_json(report));
  CHECK(written["method"] == "dqs");
  CHECK(written["settings"]["nearest"] == false);
  CHECK(written["settings"]["threads"] == 4);
  CHECK(written["settings"]["flex"][0] == "Forearm=45");
  CHECK(written["inputs"][0]["path"] == "arm.mha");
  CHECK(written["inputs"][0]["sha256"] == "00ff");
  CHECK(written["seconds"] == json{{"read", 0.5}, {"total", 1.5}});
  const json& tissue = written["tissues"][0];
  CHECK(tissue["label"] == 143);
  CHECK(tissue["name"] == "skin");
  CHECK(tissue["voxels_before"] == 1000);
  CHECK(tissue["voxels_after"] == 125);
  CHECK(tissue["volume_change_percent"] == -87.5);
  CHECK(tissue["mass_change_percent"] == -87.5);
  CHECK(tissue["components_before"] == 1);
  CHECK(tissue["components_after"] == 1);
  CHECK(tissue["overlap_voxels"] == 3);
  const json& total = written["total"];
  CHECK(total["voxels_before"] == 1000);
  CHECK(total["voxels_after"] == 125);
  CHECK(total["overlap_voxels"] == 3);
  CHECK(total["new_hole_voxels"] == 2);
  CHECK(total["trapped_air_voxels"] == 0);
  CHECK(total["dropped_voxels"] == 1);
  CHECK(written["skin"]["surface_share_before"] == 1.0);
  CHECK(written["bones"][0]["name"] == "Forearm");
  CHECK(written["bones"][0]["rigid_residual_mm"] == 0.004);
}

TEST_CASE("report: what the method took is without weights, files and the report, and nothing where nothing is said") {
  Report report;
  report.seconds = {.read = 1,
                    .weights = 20,
                    .deform = 0.25,
                    .mesh = 0.5,
                    .solve = 4,
                    .rasterize = 0.125,
                    .report = 2,
                    .write = 1,
                    .total = 30};
  CHECK(method_seconds(to_json(report)) == 4.875);
  CHECK(method_seconds("{\"seconds\": 3}") == 0);
  CHECK(method_seconds("no report") == 0);
}

TEST_CASE("report: a name that is not UTF-8 does not cost the report") {
  Report report{.metrics = compare(box_of(1, 4), box_of(1, 4), table_of(1, 5, "f\xfc\xdf"))};
  CHECK(json::parse(to_json(report))["tissues"].size() == 1);
}

TEST_CASE("report: reads as a table") {
  Report report{.metrics = compare(box_of(1, 10), box_of(1, 9), table_of(1, 5, "fat"))};
  report.seconds.total = 1.25;
  std::ostringstream text;
  print_report(text, report);
  CHECK(text.str().find("fat") != std::string::npos);
  CHECK(text.str().find("-27.10") != std::string::npos);
  CHECK(text.str().find("total 1.25") != std::string::npos);
}

TEST_CASE("report: the command matches labels by their file values, whatever else the volumes hold") {
  const test::TemporaryFolder folder;
  TissueTable both = table_of(1, 40, "a");
  both.tissues.push_back({.label = 2, .file_value = 200, .name = "b"});
  LabelVolume before = box_of(2, 10), after = box_of(1, 5);
  before.at({0, 0, 0}) = 1;
  write_volume(before, folder / "before.nrrd", both);
  write_volume(after, folder / "after.nrrd", table_of(1, 200, "b"));
  const auto run =
      test::run_limber({"report", (folder / "before.nrrd").string(), (folder / "after.nrrd").string(), "--json"});
  REQUIRE(run.exit_code == 0);
  const json report = json::parse(run.out);
  CHECK(report["inputs"][0]["sha256"].get<std::string>().size() == 64);
  REQUIRE(report["tissues"].size() == 2);
  CHECK(report["tissues"][0]["label"] == 40);
  CHECK(report["tissues"][0]["voxels_after"] == 0);
  CHECK(report["tissues"][1]["label"] == 200);
  CHECK(report["tissues"][1]["voxels_before"] == 1000);
  CHECK(report["tissues"][1]["voxels_after"] == 125);

  CHECK(test::run_limber({"report", (folder / "before.nrrd").string(), (folder / "none.nrrd").string()}).exit_code ==
        1);
}

TEST_CASE(
    "report: finite elements add mesh and solve under the schema's keys, labels as files call them, what was not "
    "measured is left out") {
  Report report{.method = "fem", .metrics = compare(box_of(3, 8), box_of(3, 8), table_of(3, 143, "skin"))};
  report.seconds.mesh = 1.25;
  report.seconds.solve = 20.5;
  DeformReport deform;
  deform.mesh = MeshReport{.tets = 1000,
                           .nodes = 300,
                           .inverted = 0,
                           .min_det_f = 0.125,
                           .volume_change_percent = {{3, 0.02}},
                           .stretch = {{3, {{0.5, 0.75, 1}, {1, 1.25, 2}}}}};
  deform.solve = SolveReport{.converged = false,
                             .reached = 0.75,
                             .blocked_by = "bone Forearm",
                             .steps = 6,
                             .iterations = 30,
                             .residual_mm = 0.25,
                             .parameters = {.tet_mm = 8, .tolerance_mm = 0.3, .contact_mm = 1.4}};
  report.deform = deform;
  json written = json::parse(to_json(report));
  CHECK(written["seconds"]["mesh"] == 1.25);
  CHECK(written["seconds"]["solve"] == 20.5);
  const json& mesh = written["mesh"];
  CHECK(mesh["tets"] == 1000);
  CHECK(mesh["nodes"] == 300);
  CHECK(mesh["inverted"] == 0);
  CHECK(mesh["min_det_f"] == 0.125);
  CHECK(mesh["volume_change_percent_by_label"]["143"] == 0.02);
  CHECK(mesh["stretch_by_label"]["143"]["least"] == std::vector{0.5, 0.75, 1.0});
  CHECK(mesh["stretch_by_label"]["143"]["most"] == std::vector{1.0, 1.25, 2.0});
  for (const char* unmeasured : {"self_intersections", "min_gap_mm", "fallback"})
    CHECK_FALSE(mesh.contains(unmeasured));
  const json& solve = written["solve"];
  CHECK(solve["converged"] == false);
  CHECK(solve["reached"] == 0.75);
  CHECK(solve["blocked_by"] == "bone Forearm");
  CHECK(solve["steps"] == 6);
  CHECK(solve["iterations"] == 30);
  CHECK(solve["residual"] == 0.25);
  CHECK(solve["parameters"]["tet_mm"] == 8);
  CHECK(solve["parameters"]["tolerance_mm"] == 0.3);
  CHECK(solve["parameters"]["contact_mm"] == 1.4);
  std::ostringstream table;
  print_report(table, report);
  CHECK(table.str().find("NOT SOLVED, ended at 75.0 % of the pose") != std::string::npos);

  // The report states the number of factorizations in double precision only if there were some.
  CHECK_FALSE(solve.contains("repeated_in_double"));
  CHECK(table.str().find("double precision") == std::string::npos);
  report.deform->solve->factorizations = 31;
  report.deform->solve->repeated_in_double = 2;
  CHECK(json::parse(to_json(report))["solve"]["repeated_in_double"] == 2);
  std::ostringstream repeated;
  print_report(repeated, report);
  CHECK(repeated.str().find("2 of 31 factorizations repeated in double precision") != std::string::npos);

  report.deform->mesh->self_intersections = 0;
  report.deform->mesh->min_gap_mm = 0.5;
  written = json::parse(to_json(report));
  CHECK(written["mesh"]["self_intersections"] == 0);
  CHECK(written["mesh"]["min_gap_mm"] == 0.5);
}
