// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/tissue_table.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/base/error.h"
#include "core/volume/builtin_tissues.h"
#include "core/volume/header_text.h"

namespace limber {

namespace {
struct KindDefaults {
  TissueKind kind;
  std::string_view name;
  glm::vec3 colour;
  double density;        // g/cm3 [ICRP 110, 2009], rounded
  double young_modulus;  // kPa: the finite elements' shear moduli times 3, bone far stiffer than flesh
  double poisson_ratio;
  int priority;  // bone first, then what is thin and stiff, skin last
};
// One row per kind, in the order of the enumeration.
constexpr int kKinds = 18;
const std::array<KindDefaults, kKinds> kDefaults = {{
    {TissueKind::Unknown, "unknown", {0.70f, 0.70f, 0.70f}, 1.05, 12, 0.49, 20},
    {TissueKind::Skin, "skin", {0.91f, 0.74f, 0.65f}, 1.09, 120, 0.49, 10},
    {TissueKind::Fat, "fat", {0.96f, 0.87f, 0.55f}, 0.95, 3, 0.49, 15},
    {TissueKind::Muscle, "muscle", {0.72f, 0.25f, 0.22f}, 1.05, 12, 0.49, 30},
    {TissueKind::CorticalBone, "cortical bone", {0.93f, 0.90f, 0.80f}, 1.92, 1.7e7, 0.3, 100},
    {TissueKind::CancellousBone, "cancellous bone", {0.86f, 0.78f, 0.62f}, 1.18, 3e5, 0.3, 95},
    {TissueKind::Marrow, "marrow", {0.78f, 0.52f, 0.40f}, 1.03, 12, 0.45, 90},
    {TissueKind::Bone, "bone", {0.93f, 0.90f, 0.80f}, 1.60, 1e7, 0.3, 97},
    {TissueKind::Cartilage, "cartilage", {0.67f, 0.81f, 0.84f}, 1.10, 1000, 0.45, 60},
    {TissueKind::Tendon, "tendon", {0.87f, 0.85f, 0.78f}, 1.12, 500, 0.45, 50},
    {TissueKind::Connective, "connective", {0.83f, 0.73f, 0.66f}, 1.03, 12, 0.49, 25},
    {TissueKind::Vessel, "vessel", {0.75f, 0.20f, 0.35f}, 1.06, 100, 0.49, 45},
    {TissueKind::Blood, "blood", {0.60f, 0.06f, 0.10f}, 1.06, 3, 0.49, 40},
    {TissueKind::Nerve, "nerve", {0.95f, 0.83f, 0.25f}, 1.04, 30, 0.49, 47},
    {TissueKind::Brain, "brain", {0.84f, 0.66f, 0.67f}, 1.04, 6, 0.49, 35},
    {TissueKind::Organ, "organ", {0.66f, 0.40f, 0.34f}, 1.05, 12, 0.49, 33},
    {TissueKind::Cavity, "cavity", {0.45f, 0.55f, 0.62f}, 0.50, 3, 0.45, 12},
    {TissueKind::Nail, "nail", {0.90f, 0.80f, 0.76f}, 1.30, 1000, 0.40, 55},
}};
const KindDefaults& defaults_of(TissueKind kind) { return kDefaults[static_cast<std::size_t>(kind)]; }
}  // namespace

bool is_bone(TissueKind kind) {
  return kind == TissueKind::CorticalBone || kind == TissueKind::CancellousBone || kind == TissueKind::Marrow || kind == TissueKind::Bone;
}

std::string_view to_string(TissueKind kind) { return defaults_of(kind).name; }

void apply_kind_defaults(Tissue& tissue) {
  const KindDefaults& from = defaults_of(tissue.kind);
  tissue.colour = from.colour;
  tissue.density = from.density;
  tissue.young_modulus = from.young_modulus;
  tissue.poisson_ratio = from.poisson_ratio;
  tissue.priority = from.priority;
}

const Tissue* TissueTable::find(Label label) const {
  // Sorted by label.
  const auto found = std::lower_bound(tissues.begin(), tissues.end(), label, [](const Tissue& t, Label l) { return t.label < l; });
  return found != tissues.end() && found->label == label ? &*found : nullptr;
}

Tissue* TissueTable::find(Label label) { return const_cast<Tissue*>(std::as_const(*this).find(label)); }

const Tissue* TissueTable::find_file_value(double value) const {
  const auto found = std::find_if(tissues.begin(), tissues.end(), [&](const Tissue& t) { return t.file_value == value; });
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

TissueTable merge_tissue_tables(const TissueTable& in_file, const TissueTable* user) {
  TissueTable merged = in_file;
  bool named = false;
  static const TissueTable kNone;
  const FileValueIndex by_value(user ? *user : kNone);
  for (Tissue& tissue : merged.tissues) {
    const Tissue* from_user = by_value.find(tissue.file_value);
    if (from_user) {
      const Label label = tissue.label;
      tissue = *from_user;
      tissue.label = label;
    }
    named = named || !tissue.name.empty() || tissue.kind != TissueKind::Unknown;
  }
  if (user && !user->tissues.empty()) {
    merged.source = user->source;
  } else if (!named) {
    if (const TissueTable* built_in = built_in_table_for(merged)) {
      for (Tissue& tissue : merged.tissues) {
        const Label label = tissue.label;
        tissue = *built_in->find_file_value(tissue.file_value);
        tissue.label = label;
      }
      merged.source = built_in->source;
    }
  }
  return merged;
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
