// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/export/tet_phantom.h"

#include <algorithm>
#include <cstdio>

#include "core/base/text_parse.h"

namespace limber {

std::uint16_t organ_number(const Tissue& tissue) {
  const bool fits = tissue.file_value >= 1 && tissue.file_value < 65536;
  return fits ? static_cast<std::uint16_t>(tissue.file_value) : tissue.label;
}

TetMesh organ_mesh(const Eigen::MatrixX3d& V, const Eigen::MatrixX4i& T, const std::vector<Label>& labels,
                   const TissueTable& tissues) {
  std::vector<std::uint16_t> of_tet(static_cast<std::size_t>(T.rows()), 0),
      of_node(static_cast<std::size_t>(V.rows()), 0);
  const auto spread = [&](Eigen::Index t) {
    for (int i = 0; i < 4; ++i) of_node[static_cast<std::size_t>(T(t, i))] = of_tet[static_cast<std::size_t>(t)];
  };
  for (Eigen::Index t = 0; t < T.rows(); ++t) {
    const Label label = labels[static_cast<std::size_t>(t)];
    if (label == 0) continue;
    const Tissue* tissue = tissues.find(label);
    of_tet[static_cast<std::size_t>(t)] = tissue ? organ_number(*tissue) : label;
    spread(t);
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (Eigen::Index t = 0; t < T.rows(); ++t) {
      std::uint16_t& organ = of_tet[static_cast<std::size_t>(t)];
      if (organ != 0) continue;
      for (int i = 0; i < 4 && organ == 0; ++i) organ = of_node[static_cast<std::size_t>(T(t, i))];
      if (organ == 0) continue;
      spread(t);
      changed = true;
    }
  }
  return {.V = V, .T = T, .region = of_tet};
}

namespace {
// Returns the tissues whose organs are in the mesh.
std::vector<Tissue> tissues_in(const TissueTable& tissues, const std::vector<std::uint16_t>& organs) {
  std::vector<bool> in_mesh(65536, false);
  for (const std::uint16_t organ : organs) in_mesh[organ] = true;
  std::vector<Tissue> found;
  for (const Tissue& tissue : tissues.tissues)
    if (in_mesh[organ_number(tissue)]) found.push_back(tissue);
  return found;
}
}  // namespace

std::string colour_list(const TissueTable& tissues, const std::vector<std::uint16_t>& organs) {
  std::string text;
  for (const Tissue& tissue : tissues_in(tissues, organs)) {
    char line[80];
    std::snprintf(line, sizeof line, "%d %.3f %.3f %.3f %.2f\n", int(organ_number(tissue)), tissue.colour.r,
                  tissue.colour.g, tissue.colour.b, tissue.kind == TissueKind::Skin ? 0.1 : 1.0);
    text += line;
  }
  return text;
}

std::string material_list(const TissueTable& tissues, const std::vector<std::uint16_t>& organs,
                          const CompositionTable& media, const std::string& where) {
  TissueTable in_mesh;
  in_mesh.tissues = tissues_in(tissues, organs);
  const std::vector<int> medium = media_of(in_mesh, media, where);
  std::string text;
  for (std::size_t i = 0; i < in_mesh.tissues.size(); ++i) {
    const Tissue& tissue = in_mesh.tissues[i];
    const std::string number = std::to_string(organ_number(tissue));
    std::string name;
    for (const char c : tissue.name.empty() ? "organ" + number : tissue.name)
      name += is_blank(c) || c < ' ' || c > '~' ? '_' : c;
    text += "C " + name + " " + text_of(tissue.density) + " g/cm3\nm" + number;
    for (std::size_t e = 0; e < kElements.size(); ++e) {
      const double share = media.shares[medium[i]][e];
      if (share == 0) continue;
      char line[64];
      std::snprintf(line, sizeof line, "\n      %d -%.6f", 1000 * kElements[e].atomic_number, share);
      text += line;
    }
    text += "\n";
  }
  return text;
}

}  // namespace limber
