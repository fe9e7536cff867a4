// SPDX-License-Identifier: AGPL-3.0-or-later
// The tissue table of the phantoms. Densities in g/cm3 are after ICRP 89 (2002) and the IT'IS tissue database. Young's
// moduli in kPa are for quasi-static loads: bone after Rho (1998), tendon after Maganaris (1999), cartilage after
// Athanasiou (1991), skin after Pailler-Mattei (2008), muscle and fat as in finite element models of resting limbs,
// organs from elastography.
#include "core/phantom/anatomy.h"

namespace limber::phantom {

namespace {
struct Row {
  Label label;
  const char* name;
  std::uint32_t colour;  // sRGB colour, 0xRRGGBB
  TissueKind kind;
  double density, young_modulus, poisson_ratio;
  // A tissue with a higher priority wins where two tissues overlap. Hard tissue wins over soft, inner over outer.
  int priority;
};

using K = TissueKind;
constexpr std::uint32_t kRed = 0xa9423c;  // typical red of muscles; each muscle has a slightly different red

constexpr Row kRows[] = {
    {kSkin, "skin", 0xe0ac8b, K::Skin, 1.10, 120, 0.48, 10},
    {kNail, "nail", 0xf0d9c8, K::Nail, 1.30, 4e5, 0.40, 15},
    {kFat, "fat", 0xf2d684, K::Fat, 0.91, 3, 0.4999, 20},
    {kVisceralFat, "visceral fat", 0xe8cf8e, K::Fat, 0.91, 2, 0.4999, 21},
    {kCorticalBone, "cortical bone", 0xefe6cf, K::CorticalBone, 1.92, 1.7e7, 0.30, 100},
    {kCancellousBone, "cancellous bone", 0xdcc6a0, K::CancellousBone, 1.18, 5e5, 0.30, 98},
    {kMarrow, "marrow", 0xc98a5e, K::Marrow, 0.98, 5, 0.49, 96},
    {kCartilage, "cartilage", 0xbfd9e6, K::Cartilage, 1.10, 800, 0.40, 80},
    {kDisc, "intervertebral disc", 0xa8c9d9, K::Cartilage, 1.10, 2500, 0.45, 82},
    {kTendon, "tendon", 0xefeadb, K::Tendon, 1.14, 1.2e6, 0.45, 70},
    {kLigament, "ligament", 0xe3dcc4, K::Tendon, 1.14, 3e5, 0.45, 71},
    {kDeltoid, "deltoid", 0xb54a42, K::Muscle, 1.06, 12, 0.4999, 40},
    {kBiceps, "biceps brachii", 0xa83a36, K::Muscle, 1.06, 12, 0.4999, 40},
    {kTriceps, "triceps brachii", 0x973530, K::Muscle, 1.06, 12, 0.4999, 40},
    {kBrachialis, "brachialis", 0xbd5a4d, K::Muscle, 1.06, 12, 0.4999, 40},
    {kBrachioradialis, "brachioradialis", 0xb0453f, K::Muscle, 1.06, 12, 0.4999, 40},
    {kForearmFlexors, "forearm flexors", 0xa03c3a, K::Muscle, 1.06, 12, 0.4999, 40},
    {kForearmExtensors, "forearm extensors", 0xc05f50, K::Muscle, 1.06, 12, 0.4999, 40},
    {kHandMuscles, "hand muscles", 0xb85248, K::Muscle, 1.06, 12, 0.4999, 40},
    {kTrapezius, "trapezius", 0xb44d44, K::Muscle, 1.06, 12, 0.4999, 40},
    {kPectoralis, "pectoralis major", 0xab4039, K::Muscle, 1.06, 12, 0.4999, 40},
    {kLatissimus, "latissimus dorsi", 0x9f3833, K::Muscle, 1.06, 12, 0.4999, 40},
    {kShoulderMuscles, "rotator cuff", 0xc2634f, K::Muscle, 1.06, 12, 0.4999, 40},
    {kBackMuscles, "erector spinae", 0x93302d, K::Muscle, 1.06, 12, 0.4999, 40},
    {kAbdominalMuscles, "abdominal wall", 0xb9564a, K::Muscle, 1.06, 12, 0.4999, 40},
    {kNeckMuscles, "neck muscles", kRed, K::Muscle, 1.06, 12, 0.4999, 40},
    {kFaceMuscles, "muscles of the head", 0xb5574b, K::Muscle, 1.06, 12, 0.4999, 40},
    {kIntercostals, "intercostals", 0xa64a40, K::Muscle, 1.06, 12, 0.4999, 40},
    {kDiaphragm, "diaphragm", 0x8f2f2c, K::Muscle, 1.06, 12, 0.4999, 41},
    {kIliopsoas, "iliopsoas", 0xad463d, K::Muscle, 1.06, 12, 0.4999, 40},
    {kGluteals, "gluteals", 0x9a3632, K::Muscle, 1.06, 12, 0.4999, 40},
    {kQuadriceps, "quadriceps", 0xb04741, K::Muscle, 1.06, 12, 0.4999, 40},
    {kHamstrings, "hamstrings", 0x953330, K::Muscle, 1.06, 12, 0.4999, 40},
    {kAdductors, "adductors", 0xbf5e50, K::Muscle, 1.06, 12, 0.4999, 40},
    {kCalf, "calf", 0xa43d38, K::Muscle, 1.06, 12, 0.4999, 40},
    {kShinMuscles, "shin muscles", 0xb9524a, K::Muscle, 1.06, 12, 0.4999, 40},
    {kFootMuscles, "foot muscles", 0xac4a42, K::Muscle, 1.06, 12, 0.4999, 40},
    {kArtery, "artery", 0xd21f26, K::Vessel, 1.06, 500, 0.49, 60},
    {kVein, "vein", 0x3d5a9e, K::Vessel, 1.06, 300, 0.49, 59},
    {kNerve, "nerve", 0xf4e04d, K::Nerve, 1.04, 500, 0.45, 61},
    {kSpinalCord, "spinal cord", 0xf0d860, K::Nerve, 1.04, 10, 0.49, 62},
    {kBrain, "brain", 0xd9a6a0, K::Brain, 1.04, 2, 0.4999, 50},
    {kEye, "eye", 0xf5f3ee, K::Organ, 1.03, 20, 0.49, 50},
    {kTongue, "tongue", 0xc4605f, K::Muscle, 1.05, 10, 0.4999, 45},
    {kTrachea, "trachea", 0xc6dde2, K::Cavity, 0.30, 50, 0.30, 30},
    {kOesophagus, "oesophagus", 0xb87b6b, K::Organ, 1.04, 20, 0.49, 46},
    {kLung, "lung", 0xe3a9a2, K::Organ, 0.30, 3, 0.30, 32},
    {kHeart, "heart", 0x8e1f24, K::Organ, 1.06, 20, 0.4999, 52},
    {kLiver, "liver", 0x7a3527, K::Organ, 1.06, 6, 0.4999, 50},
    {kStomach, "stomach", 0xc98478, K::Organ, 1.04, 10, 0.49, 48},
    {kSpleen, "spleen", 0x6b2a3a, K::Organ, 1.06, 15, 0.4999, 50},
    {kKidney, "kidney", 0x8a3b33, K::Organ, 1.05, 10, 0.4999, 51},
    {kIntestine, "small intestine", 0xd69c83, K::Organ, 1.03, 5, 0.49, 46},
    {kColon, "colon", 0xb98063, K::Organ, 1.03, 6, 0.49, 47},
    {kBladder, "bladder", 0xd8c07a, K::Organ, 1.02, 10, 0.49, 49},
};
static_assert(std::size(kRows) == kLabelCount - 1);

glm::vec3 colour_of(std::uint32_t rgb) { return glm::vec3(rgb >> 16 & 255, rgb >> 8 & 255, rgb & 255) / 255.0f; }
}  // namespace

TissueTable phantom_tissues(const LabelVolume& volume) {
  std::vector<bool> present(kLabelCount, false);
  for (Label label : volume.voxels) present[label] = true;
  TissueTable table;
  table.source = "phantom";
  for (const Row& row : kRows)
    if (present[row.label])
      table.tissues.push_back({row.label, static_cast<double>(row.label), row.name, colour_of(row.colour), row.kind,
                               row.density, row.young_modulus, row.poisson_ratio, row.priority});
  return table;
}

}  // namespace limber::phantom
