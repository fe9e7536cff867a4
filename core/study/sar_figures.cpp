// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/sar_figures.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"

namespace limber {

namespace {
using Json = nlohmann::json;

constexpr std::uint64_t kLargest = 1 << 20;

SarFigures::Body body_of(const Json& row) {
  return {.average = row.at("sar_average_w_per_kg"),
          .peak_10g = row.at("sar_peak_10g_w_per_kg"),
          .mass_kg = row.at("mass_kg"),
          .seconds = row.at("seconds"),
          .cells = row.at("cells")};
}

SarFigures figures_of(const Json& json, const Study& study, const std::vector<CellResult>& cells) {
  SarFigures sar{.frequency_hz = json.at("frequency_hz"),
                 .cell_mm = json.at("cell_mm"),
                 .polarization = json.at("polarization"),
                 .towards = json.at("towards")};
  const Json& sphere = json.at("sphere");
  sar.sphere = {sphere.at("cell_mm"), sphere.at("absorbed_w"), sphere.at("absorbed_by_mie_w"),
                sphere.at("difference_percent")};
  for (const Json& row : json.at("poses")) {
    const auto same = std::find_if(cells.begin(), cells.end(), [&](const CellResult& cell) {
      return cell.done() && Json::parse(cell.cell_json).at("key") == row.at("key");
    });
    SarFigures::Body body = body_of(row);
    if (same == cells.end()) {
      sar.outdated.push_back(row.at("pose"));
      continue;
    }
    body.cell = &*same;
    if (!sar.bodies.empty() && (body.cell->cell.spacing != sar.bodies.front().cell->cell.spacing ||
                                body.cell->cell.technique != sar.bodies.front().cell->cell.technique))
      throw Error("SAR is reported for bodies of one spacing and technique",
                  "sar.json, " + text_of(study, body.cell->cell), "write the file again with sar_openems.py study");
    sar.bodies.push_back(body);
  }
  std::sort(sar.bodies.begin(), sar.bodies.end(),
            [](const auto& a, const auto& b) { return a.cell->cell.pose < b.cell->cell.pose; });
  return sar;
}
}  // namespace

std::optional<SarFigures> read_sar(const Path& out, const Study& study, const std::vector<CellResult>& cells) {
  const Path path = out / "sar.json";
  if (!std::filesystem::exists(path)) return {};
  const Json json = Json::parse(checked_json(read_file(path, kLargest), path.string()), nullptr, false);
  if (!json.is_object() || json.value("schema", Json()) != "limber-sar/2")
    throw Error("this is not the SAR file of a study, or it is of an older version", path.string(),
                "delete it, or write it again with sar_openems.py study");
  try {
    return figures_of(json, study, cells);
  } catch (const Json::exception& error) {
    throw Error("the SAR of the study is damaged", path.string(),
                std::string("delete it, or write it again with sar_openems.py study (") + error.what() + ")");
  }
}

}  // namespace limber
