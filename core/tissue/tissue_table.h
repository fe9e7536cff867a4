// SPDX-License-Identifier: AGPL-3.0-or-later
// What each label of a volume is: name, colour, kind, material. Sources, strongest first: the user's table (JSON,
// Slicer .ctbl, ITK-SNAP), names in the volume file (.seg.nrrd), a built-in table that covers every label present.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <glm/glm.hpp>

#include "core/base/file.h"
#include "core/volume/label_volume.h"

namespace limber {

enum class TissueKind {
  Unknown,
  Skin,
  Fat,
  Muscle,
  CorticalBone,
  CancellousBone,
  Marrow,
  Bone,  // bone without finer distinction
  Cartilage,
  Tendon,  // and ligament
  Connective,
  Vessel,
  Blood,
  Nerve,
  Brain,
  Organ,
  Cavity,  // body cavity, gas or fluid inside the body
  Nail,
};

// Bone moves rigidly: cortical, cancellous, marrow and plain bone.
bool is_bone(TissueKind kind);
std::string_view to_string(TissueKind kind);                        // "cortical bone"
std::optional<TissueKind> tissue_kind_from_text(std::string_view);  // of a `kind` or `class` field
TissueKind tissue_kind_from_name(std::string_view tissue_name);     // by words in a name: "Left femur" -> Bone

struct Tissue {
  Label label = 0;
  double file_value = 0;  // the value this label has in files, exact up to 2^53 (64-bit labels above are refused)
  std::string name;
  glm::vec3 colour{0.7f};  // sRGB, [0, 1]
  TissueKind kind = TissueKind::Unknown;
  double density = 1.0;         // g/cm3
  double young_modulus = 10.0;  // kPa
  double poisson_ratio = 0.45;
  int priority = 0;  // of two tissues that claim one voxel the higher wins; bone highest, skin lowest
};

// One Tissue per non-zero label, sorted by label.
struct TissueTable {
  std::vector<Tissue> tissues;
  // Where names and kinds came from, for messages: "tissues.json", "names in the file", "built-in table Bender arm".
  std::string source;

  const Tissue* find(Label label) const;  // nullptr when absent
  Tissue* find(Label label);
  const Tissue* find_file_value(double value) const;
  // kind per label, 0 .. 65535, Unknown where absent
  std::vector<TissueKind> kinds() const;
};

// Many look-ups by file value. Lives no longer than the table.
class FileValueIndex {
 public:
  explicit FileValueIndex(const TissueTable& table);
  const Tissue* find(double value) const;  // nullptr when absent

 private:
  std::unordered_map<double, const Tissue*> by_value_;
};

// Colour, stiffness and priority that a tissue of this kind starts with, and the density of the tissue that its name
// says, else its kind (tissue_rows.h).
void apply_kind_defaults(Tissue& tissue);
// Where the numbers come from that a tissue of a kind starts with, for a user to read.
struct MaterialSources {
  std::string_view density, stiffness, poisson;
};
MaterialSources material_sources(TissueKind kind);

// Reads a label table: our JSON, Slicer .ctbl, ITK-SNAP label file; told apart by content. Keys are file values.
// Throws Error naming the line or key that is wrong.
TissueTable read_tissue_table(const Path& path);
// By name, and for .json by content: an object whose every key is a whole number.
bool is_tissue_table(const Path& path);
void write_tissue_table(const TissueTable& table, const Path& path);  // by extension: .json, .ctbl, .txt (ITK-SNAP)

// `table` completed for a volume whose labels and file values stand in `in_file` (as read from the volume's file):
// entries of `user` win, then what the file said, then a built-in table if it covers every label present.
TissueTable merge_tissue_tables(const TissueTable& in_file, const TissueTable* user);

// The same table with `values` (file values) as its only bone tissues. Throws Error for a value that is not present.
TissueTable with_bones(TissueTable table, const std::vector<double>& values);

}  // namespace limber
