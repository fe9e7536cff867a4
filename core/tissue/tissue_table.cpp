// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/tissue/tissue_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/tissue/atlas_colours.h"
#include "core/tissue/tissue_rows.h"

namespace limber {

namespace {
struct KindDefaults {
  TissueKind kind;
  std::string_view name;
  std::uint32_t colour;  // sRGB colour, 0xRRGGBB
  double young_modulus;  // kPa, 3 times the shear modulus that the finite elements use; bone is far stiffer than flesh
  double poisson_ratio;
  int priority;  // where tissues overlap, the one with the higher priority is kept: bone above all, skin below all
};
constexpr std::uint32_t kByLabel = 0xffffffff;  // stands for a colour that is computed from the label
// Initial colour, stiffness and priority of each tissue kind, in the order of TissueKind.
// Stiffness: published moduli of flesh differ by two orders of magnitude with method, load and muscle tone. The shape
// of a posed body depends on the ratios of the moduli and not on their scale, because bones prescribe the motion. What
// matters is their order: skin far above fat and relaxed muscle. Finite element models of bodies under load use shear
// moduli of 8 kPa for skin, 0.8 for fat, 0.5 for relaxed muscle [Int. Wound J. 15(3), 402-416, 2018, table 3]. Here
// they are 40 kPa for skin, 1 for fat, 4 for muscle. (In a volume, skin is two or three voxels thick, which is rarely
// the thickness of real skin.) Poisson ratio: flesh is mostly water, and volume changes of fat under load fit a ratio
// between 0.49 and 0.4999. With lower ratios, flesh would lose volume.
constexpr int kKinds = 18;
const std::array<KindDefaults, kKinds> kDefaults = {{
    {TissueKind::Unknown, "unknown", kByLabel, 12, 0.4999, 20},
    {TissueKind::Skin, "skin", 0xE3B597, 120, 0.4999, 10},
    {TissueKind::Fat, "fat", 0xF0D27A, 3, 0.4999, 15},
    {TissueKind::Muscle, "muscle", 0xB8463F, 12, 0.4999, 30},
    {TissueKind::CorticalBone, "cortical bone", 0xEDE6D4, 1.7e7, 0.3, 100},
    {TissueKind::CancellousBone, "cancellous bone", 0xE0CCA0, 3e5, 0.3, 95},
    {TissueKind::Marrow, "marrow", 0xD9A06B, 12, 0.45, 90},
    {TissueKind::Bone, "bone", 0xEDE6D4, 1e7, 0.3, 97},
    {TissueKind::Cartilage, "cartilage", 0x8FC9D6, 1000, 0.45, 60},
    {TissueKind::Tendon, "tendon", 0xCFC8DC, 500, 0.45, 50},
    {TissueKind::Connective, "connective", 0xD4BAA8, 12, 0.4999, 25},
    {TissueKind::Vessel, "vessel", 0xD9372F, 100, 0.4999, 45},
    {TissueKind::Blood, "blood", 0x4A74D8, 3, 0.4999, 40},
    {TissueKind::Nerve, "nerve", 0xF2E14C, 30, 0.4999, 47},
    {TissueKind::Brain, "brain", 0xD6A8AB, 6, 0.4999, 35},
    {TissueKind::Organ, "organ", kByLabel, 12, 0.4999, 33},
    {TissueKind::Cavity, "cavity", 0x738C9E, 3, 0.45, 12},
    {TissueKind::Nail, "nail", 0xF0C8B4, 1000, 0.40, 55},
}};
glm::vec3 srgb_of(std::uint32_t colour) {
  return glm::vec3(colour >> 16 & 255, colour >> 8 & 255, colour & 255) / 255.0f;
}

// Converts an OKLCH colour to sRGB, clipped to [0, 1] [Ottosson 2020].
glm::vec3 srgb_of(double lightness, double chroma, double hue_degrees) {
  const double hue = glm::radians(hue_degrees), a = chroma * std::cos(hue), b = chroma * std::sin(hue);
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3),
               m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3),
               s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  const glm::dvec3 linear(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s);
  glm::vec3 srgb;
  for (int i = 0; i < 3; ++i) {
    const double c = std::clamp(linear[i], 0.0, 1.0);
    srgb[i] = static_cast<float>(c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055);
  }
  return srgb;
}

// Returns a colour for a label that has none. A label always gets the same colour.
glm::vec3 label_colour(double file_value) {
  const int label = static_cast<int>(std::fmod(std::abs(file_value), 65536.0));
  // The hues of successive labels differ by the golden angle (137.5 degrees), so that neighbouring labels look very
  // different. Hues from 45 to 75 degrees are skipped, because the editor marks selections with them.
  double hue = std::fmod(label * 137.508, 360.0) * 330 / 360;
  if (hue >= 45) hue += 30;
  constexpr double kLightness[] = {0.62, 0.72, 0.82};
  return srgb_of(kLightness[label % 3], 0.11, hue);
}

// Returns the colour that anatomy atlases give a tissue; nothing if its kind decides, as with muscle and bone.
//   row  name of the row of tissues.csv that matches the tissue; empty: none
std::optional<glm::vec3> atlas_colour(const Tissue& tissue, const std::string& row) {
  switch (tissue.kind) {
    case TissueKind::Vessel: return vein_colour(tissue.name);
    case TissueKind::Unknown:
    case TissueKind::Organ:
    case TissueKind::Brain:
    case TissueKind::Nerve:
    case TissueKind::Cavity: return tissue.name.empty() ? std::nullopt : organ_colour(row);
    default: return std::nullopt;
  }
}

const KindDefaults& defaults_of(TissueKind kind) { return kDefaults[static_cast<std::size_t>(kind)]; }
}  // namespace

bool is_bone(TissueKind kind) {
  return kind == TissueKind::CorticalBone || kind == TissueKind::CancellousBone || kind == TissueKind::Marrow ||
         kind == TissueKind::Bone;
}

MaterialSources material_sources(TissueKind kind) {
  constexpr std::string_view kChosen = "chosen by Limber";
  MaterialSources sources{"found by the tissue's name or kind",
                          "chosen by Limber: published values spread over two decades", kChosen};
  if (kind == TissueKind::Skin || kind == TissueKind::Fat || kind == TissueKind::Muscle)
    sources.stiffness =
        "3 times a shear modulus of 40 kPa for skin, 1 for fat, 4 for muscle; others use 8, 0.8 and 0.5: Int. Wound "
        "J. 15(3), 402-416, 2018";
  if (defaults_of(kind).poisson_ratio > 0.49) sources.poisson = "flesh is mostly water; lower ratios lose volume";
  if (is_bone(kind)) sources.stiffness = sources.poisson = "without effect: poses keep bones rigid";
  return sources;
}

std::string_view to_string(TissueKind kind) { return defaults_of(kind).name; }

void apply_kind_defaults(Tissue& tissue) {
  const KindDefaults& from = defaults_of(tissue.kind);
  const UsualDensity density = usual_density(tissue);
  tissue.colour = atlas_colour(tissue, density.row)
                      .value_or(from.colour == kByLabel ? label_colour(tissue.file_value) : srgb_of(from.colour));
  tissue.density = density.value;
  tissue.young_modulus = from.young_modulus;
  tissue.poisson_ratio = from.poisson_ratio;
  tissue.priority = from.priority;
}

const Tissue* TissueTable::find(Label label) const {
  // Binary search works because `tissues` is sorted by label.
  const auto found =
      std::lower_bound(tissues.begin(), tissues.end(), label, [](const Tissue& t, Label l) { return t.label < l; });
  return found != tissues.end() && found->label == label ? &*found : nullptr;
}

Tissue* TissueTable::find(Label label) { return const_cast<Tissue*>(std::as_const(*this).find(label)); }

const Tissue* TissueTable::find_file_value(double value) const {
  const auto found =
      std::find_if(tissues.begin(), tissues.end(), [&](const Tissue& t) { return t.file_value == value; });
  return found != tissues.end() ? &*found : nullptr;
}

FileValueIndex::FileValueIndex(const TissueTable& table) {
  for (const Tissue& tissue : table.tissues) by_value_.emplace(tissue.file_value, &tissue);
}

const Tissue* FileValueIndex::find(double value) const {
  const auto found = by_value_.find(value);
  return found != by_value_.end() ? found->second : nullptr;
}

std::vector<TissueKind> TissueTable::kinds() const {
  std::vector<TissueKind> kinds(65536, TissueKind::Unknown);
  for (const Tissue& tissue : tissues) kinds[tissue.label] = tissue.kind;
  return kinds;
}

TissueTable with_bones(TissueTable table, const std::vector<double>& values) {
  for (double value : values)
    if (!table.find_file_value(value))
      throw Error("the volume has no label " + text_of(value), "--bones", "name labels that `limber info` lists");
  for (Tissue& tissue : table.tissues) {
    const bool wanted = std::find(values.begin(), values.end(), tissue.file_value) != values.end();
    if (wanted == is_bone(tissue.kind)) continue;
    tissue.kind = wanted ? TissueKind::Bone : TissueKind::Unknown;
    const glm::vec3 colour = tissue.colour;
    apply_kind_defaults(tissue);
    tissue.colour = colour;
  }
  return table;
}

}  // namespace limber
