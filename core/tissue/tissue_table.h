// SPDX-License-Identifier: AGPL-3.0-or-later
// Describes each label of a volume: name, colour, kind and material. These come from the user's table (JSON, Slicer
// .ctbl, ITK-SNAP), else from names in the volume file (.seg.nrrd), else from a built-in table that covers every label
// present.
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
  Bone,  // bone that is not split into cortical and cancellous
  Cartilage,
  Tendon,  // also ligament
  Connective,
  Vessel,
  Blood,
  Nerve,
  Brain,
  Organ,
  Cavity,  // body cavity with gas or fluid
  Nail,
};

// Returns whether tissue of this kind moves rigidly: cortical bone, cancellous bone, marrow and plain bone.
bool is_bone(TissueKind kind);
std::string_view to_string(TissueKind kind);                        // as in "cortical bone"
std::optional<TissueKind> tissue_kind_from_text(std::string_view);  // from a table's field `kind` or `class`
TissueKind tissue_kind_from_name(std::string_view tissue_name);     // from words in a name: "Left femur" -> Bone

struct Tissue {
  Label label = 0;
  double file_value = 0;  // the label's value in files; exact up to 2^53, and larger values are refused
  std::string name;
  glm::vec3 colour{0.7f};  // sRGB, [0, 1]
  TissueKind kind = TissueKind::Unknown;
  double density = 1.0;         // g/cm3
  double young_modulus = 10.0;  // kPa
  double poisson_ratio = 0.45;
  int priority = 0;  // where two tissues move to one voxel, the higher priority wins; skin lowest, bone highest
};

// The tissues of a volume: one Tissue per non-zero label, sorted by label.
struct TissueTable {
  std::vector<Tissue> tissues;
  // The source of the names and kinds, for messages: "tissues.json", "names in the file", "built-in table Bender arm".
  std::string source;

  const Tissue* find(Label label) const;  // nullptr when absent
  Tissue* find(Label label);
  const Tissue* find_file_value(double value) const;
  // Returns the kind of each label 0 .. 65535; Unknown where the table has no entry.
  std::vector<TissueKind> kinds() const;
};

// Index of a TissueTable for many look-ups by file value. It must not outlive the table.
class FileValueIndex {
 public:
  explicit FileValueIndex(const TissueTable& table);
  const Tissue* find(double value) const;  // nullptr when absent

 private:
  std::unordered_map<double, const Tissue*> by_value_;
};

// Sets the tissue's colour, stiffness and priority to the initial values of its kind. Sets its density to that of the
// row of tissues.csv that matches its name, else its kind (tissue_rows.h).
void apply_kind_defaults(Tissue& tissue);
// The sources of a kind's initial material values, in words for the user.
struct MaterialSources {
  std::string_view density, stiffness, poisson;
};
MaterialSources material_sources(TissueKind kind);

// Reads a label table: Limber's JSON, Slicer .ctbl or an ITK-SNAP label file, recognized by content. The table's keys
// are the labels' values in the volume file. Throws Error, which names the line or key that is wrong.
TissueTable read_tissue_table(const Path& path);
// Returns whether the file is a label table. The file's name decides, for .json also its content, which must be an
// object whose keys are all whole numbers.
bool is_tissue_table(const Path& path);
void write_tissue_table(const TissueTable& table,
                        const Path& path);  // the extension selects the format: .json, .ctbl, .txt (ITK-SNAP)

// Returns the completed table of a volume file. `in_file` has the file's labels, their values and what else the file
// states. For each label, an entry of the user's table `user` (nullptr: none) replaces that of `in_file`. When neither
// table has a name or kind, the result comes from a built-in table that covers every label present, if there is one.
TissueTable merge_tissue_tables(const TissueTable& in_file, const TissueTable* user);

// Returns the table in which exactly the tissues with the file values `values` are bone. Throws Error for a value that
// the table does not have.
TissueTable with_bones(TissueTable table, const std::vector<double>& values);

}  // namespace limber
