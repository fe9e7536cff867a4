// SPDX-License-Identifier: AGPL-3.0-or-later
// Describes each label of a volume: name, colour, kind and material. The descriptions come from the user's table (JSON,
// Slicer .ctbl, ITK-SNAP), else from names in the volume file (.seg.nrrd), else from a built-in table that covers every
// label present.
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
  Bone,  // bone that is not divided into cortical and cancellous
  Cartilage,
  Tendon,  // includes ligaments
  Connective,
  Vessel,
  Blood,
  Nerve,
  Brain,
  Organ,
  Cavity,  // body cavity filled with gas or fluid
  Nail,
};

// Returns true if tissue of this kind moves rigidly: cortical bone, cancellous bone, marrow and plain bone.
bool is_bone(TissueKind kind);
std::string_view to_string(TissueKind kind);  // returns the name of a kind, for example "cortical bone"
std::optional<TissueKind> tissue_kind_from_text(std::string_view);  // parses the field `kind` or `class` of a table
// Finds the kind of a tissue by words in its name: "Left femur" is Bone.
TissueKind tissue_kind_from_name(std::string_view tissue_name);

struct Tissue {
  Label label = 0;
  // The label's value in files; whole numbers up to 2^53 are exact, and larger values are refused.
  double file_value = 0;
  std::string name;
  glm::vec3 colour{0.7f};  // colour in pictures, sRGB, [0, 1]
  TissueKind kind = TissueKind::Unknown;
  double density = 1.0;         // density of the tissue, g/cm3
  double young_modulus = 10.0;  // stiffness (Young's modulus), kPa
  double poisson_ratio = 0.45;
  // If two tissues move into the same voxel, the one with the higher priority wins; skin lowest, bone highest.
  int priority = 0;
};

// The tissues of a volume: one Tissue per non-zero label, sorted by label.
struct TissueTable {
  std::vector<Tissue> tissues;
  // The source of names and kinds, as messages state it: "tissues.json", "names in the file", "built-in table Bender
  // arm".
  std::string source;

  const Tissue* find(Label label) const;  // returns nullptr if the table has no entry
  Tissue* find(Label label);
  const Tissue* find_file_value(double value) const;
  // Returns the kind of each label from 0 to 65535; Unknown for labels without an entry in the table.
  std::vector<TissueKind> kinds() const;
};

// Index of a TissueTable that makes many look-ups by file value fast. The table must outlive the index.
class FileValueIndex {
 public:
  explicit FileValueIndex(const TissueTable& table);
  const Tissue* find(double value) const;  // returns nullptr if the table has no entry

 private:
  std::unordered_map<double, const Tissue*> by_value_;
};

// Sets the tissue's colour, stiffness and priority to the initial values of its kind. Sets its density to that of the
// row of tissues.csv that matches the tissue's name, or else its kind (tissue_rows.h).
void apply_kind_defaults(Tissue& tissue);
// The sources of the initial material values of a tissue kind, in words for the user.
struct MaterialSources {
  std::string_view density, stiffness, poisson;
};
MaterialSources material_sources(TissueKind kind);

// Reads a label table: Limber's JSON, Slicer .ctbl or an ITK-SNAP label file, recognized by content. The keys in the
// file are the labels' values in the volume file. If the file is not valid, throws Error, which names the wrong line or
// key.
TissueTable read_tissue_table(const Path& path);
// Returns true if the file is a label table. Its name decides, and for two extensions also its content: a .json must be
// an object whose keys are all whole numbers, and a .txt must not be the header of a Virtual Family volume.
bool is_tissue_table(const Path& path);
// Writes a label table in the format that the extension selects: .json, .ctbl or .txt (ITK-SNAP).
void write_tissue_table(const TissueTable& table, const Path& path);

// Returns the completed table of a volume file. `in_file` has the file's labels with their values and whatever else the
// file states about them. For each label, an entry of the user's table `user` (nullptr: none) replaces that of
// `in_file`. If there is no user's table, or it is empty, and `in_file` has no name or kind, the result comes from a
// built-in table that covers every label present, if there is one.
TissueTable merge_tissue_tables(const TissueTable& in_file, const TissueTable* user);

// Returns the table in which exactly the tissues with the file values `values` are bone. Throws Error for a value that
// the table does not have.
TissueTable with_bones(TissueTable table, const std::vector<double>& values);

}  // namespace limber
