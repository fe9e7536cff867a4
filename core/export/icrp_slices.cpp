// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/export/exporter.h"
#include "core/export/simulation_export.h"

namespace limber {

namespace {
constexpr int kNumbersALine = 16;  // organ numbers per line, as in ICRP Publication 110

std::string organs_text(const LabelVolume& volume, const TissueTable& tissues, const std::vector<int>& medium) {
  const Grid& grid = volume.grid;
  std::string text = "columns (x) " + std::to_string(grid.size.x) + " rows (y) " + std::to_string(grid.size.y) +
                     " slices (z) " + std::to_string(grid.size.z) + "\nvoxel mm " + text_of(grid.spacing.x) + " " +
                     text_of(grid.spacing.y) + " " + text_of(grid.spacing.z) + "\nfirst voxel's centre mm " +
                     text_of(grid.origin.x) + " " + text_of(grid.origin.y) + " " + text_of(grid.origin.z) +
                     "\n\norgan\tmedium\tdensity g/cm3\tname\n";
  for (std::size_t i = 0; i < tissues.tissues.size(); ++i) {
    const Tissue& tissue = tissues.tissues[i];
    text += text_of(tissue.file_value) + "\t" + std::to_string(medium[i] + 1) + "\t" + text_of(tissue.density) + "\t" +
            tissue.name + "\n";
  }
  return text;
}

// Returns the text of the table of media (materials), with a row per medium and a column per chemical element. Elements
// that occur only in implants get columns only if one of the media contains such an element.
//   used  the media to write, indices into `media`
std::string media_text(const CompositionTable& media, const std::vector<int>& used) {
  const bool has_implant = std::any_of(used.begin(), used.end(), [&](int row) {
    const Composition& shares = media.shares[row];
    return std::any_of(shares.begin() + kTissueElements, shares.end(), [](double share) { return share > 0; });
  });
  const std::size_t columns = has_implant ? kElements.size() : kTissueElements;
  std::string text = "medium";
  for (std::size_t i = 0; i < columns; ++i) text += std::string("\t") + kElements[i].symbol;
  text += "\tname (shares in % by mass)\n";
  std::vector<bool> written(media.names.size());
  for (const int row : used) {
    if (written[row]) continue;
    written[row] = true;
    text += std::to_string(row + 1);
    for (std::size_t i = 0; i < columns; ++i) text += "\t" + text_of(std::round(media.shares[row][i] * 1e5) / 1e3);
    text += "\t" + media.names[row].name + "\n";
  }
  return text;
}
}  // namespace

void write_icrp_slices(const LabelVolume& volume, const TissueTable& tissues, const CompositionTable& media,
                       const Path& path) {
  const std::vector<int> medium = media_of(tissues, media, path.string());
  std::vector<std::string> number_of_label(65536, "0");
  for (const Tissue& tissue : tissues.tissues) {
    if (tissue.file_value < 1 || tissue.file_value > 65535)
      throw Error("the label " + text_of(tissue.file_value) + " is not an organ number", path.string(),
                  "number labels from 1 to 65535 with `limber prepare --merge`");
    number_of_label[tissue.label] = text_of(tissue.file_value);
  }
  write_file_atomically(beside(path, "_organs.dat"), organs_text(volume, tissues, medium));
  write_file_atomically(beside(path, "_media.dat"), media_text(media, medium));
  std::string text;
  text.reserve(4 * volume.voxels.size());
  for (std::size_t i = 0; i < volume.voxels.size(); ++i) {
    text += number_of_label[volume.voxels[i]];
    text += i % kNumbersALine == kNumbersALine - 1 || i + 1 == volume.voxels.size() ? '\n' : ' ';
  }
  write_file_atomically(path, text);
}

Exporter icrp_slices_exporter() {
  return {.name = "ICRP 110 slices",
          .endings = {".dat"},
          .beside =
              [](const Path& path) {
                return std::vector<Path>{beside(path, "_organs.dat"), beside(path, "_media.dat")};
              },
          .write =
              [](const ExportInput& input, const Path& path) {
                write_icrp_slices(turned_to_lps(input.volume, input.warnings), input.tissues, read_composition_table(),
                                  path);
              }};
}

}  // namespace limber
