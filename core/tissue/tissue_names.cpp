// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the kind of a tissue by the words of its name. Anatomical names mix the tissue with its location ("anterior
// cruciate ligament of the knee", "infrapatellar fat body"), so rules are tried in order: words that state the tissue
// (fat, cartilage, tendon, nerve, artery) before words that may only name a location (patella, femur).
#include <algorithm>
#include <array>
#include <initializer_list>
#include <set>

#include "core/base/text_parse.h"
#include "core/tissue/tissue_match.h"

namespace limber {

namespace {
using Words = TissueWords;

struct Rule {
  TissueKind kind;
  Words words;  // the rule applies to a name that contains one of these words or its plural with s
};

const std::vector<Rule>& rules() {
  static const std::vector<Rule> kRules = {
      {TissueKind::Fat, {"fat", "adipose", "subcutaneous", "sat"}},
      {TissueKind::Cartilage, {"cartilage", "chondral", "meniscus", "menisci", "disc", "disk", "labrum"}},
      {TissueKind::Tendon,
       {"tendon", "ligament", "ligamentum", "retinaculum", "retinacula", "aponeurosis", "iliotibial", "interosseal",
        "linea"}},
      {TissueKind::Nerve, {"nerve", "nervus", "plexus", "ganglion", "cord"}},
      {TissueKind::Vessel,
       {"artery", "arteries", "arteria", "vein", "vena", "vessel", "aorta", "brachiocephalic", "carotid", "jugular",
        "arteriole", "venous", "vascular"}},
      {TissueKind::Blood, {"blood"}},
      {TissueKind::Nail, {"nail", "toenail", "fingernail"}},
      {TissueKind::Skin, {"skin", "dermis", "epidermis", "cutis"}},
      {TissueKind::Marrow, {"marrow", "medullary"}},
      {TissueKind::CancellousBone, {"cancellous", "trabecular", "spongiosa", "spongy"}},
      {TissueKind::Connective, {"membrane", "capsule", "bursa", "fascia", "connective", "synovium", "synovial"}},
      {TissueKind::Brain,
       {"brain", "cerebrum", "cerebral", "cerebellum", "cerebellar", "brainstem", "thalamus", "hypothalamus",
        "hippocampus", "putamen", "pallidum", "amygdala", "pons", "midbrain", "gyrus", "matter"}},
      {TissueKind::Muscle,
       {"muscle",
        "musculus",
        "muscular",
        "abductor",
        "adductor",
        "anconeus",
        "articularis",
        "auricularis",
        "autochthon",
        "biceps",
        "brachialis",
        "brachioradialis",
        "buccinator",
        "bulbospongiosus",
        "coccygeus",
        "coracobrachialis",
        "corrugator",
        "cremaster",
        "deltoid",
        "depressor",
        "diaphragm",
        "digastric",
        "dilator",
        "erector",
        "extensor",
        "fibularis",
        "flexor",
        "frontalis",
        "gastrocnemius",
        "gemellus",
        "genioglossus",
        "geniohyoid",
        "gluteus",
        "gracilis",
        "hamstring",
        "hyoglossus",
        "iliacus",
        "iliococcygeus",
        "iliocostalis",
        "iliopsoas",
        "infraspinatus",
        "intercostal",
        "interossei",
        "interosseous",
        "interosseus",
        "interspinalis",
        "interspinales",
        "intertransversarius",
        "intertransversarii",
        "latissimus",
        "levator",
        "levatores",
        "longissimus",
        "longus",
        "lumbrical",
        "masseter",
        "mentalis",
        "multifidus",
        "mylohyoid",
        "oblique",
        "obliquus",
        "obturator",
        "occipitofrontalis",
        "omohyoid",
        "opponens",
        "orbicularis",
        "palmaris",
        "pectineus",
        "pectoralis",
        "peroneus",
        "piriformis",
        "plantaris",
        "platysma",
        "popliteus",
        "procerus",
        "pronator",
        "psoas",
        "pterygoid",
        "pubococcygeus",
        "puborectalis",
        "quadratus",
        "quadriceps",
        "rectus",
        "rhomboid",
        "rhomboideus",
        "risorius",
        "rotatores",
        "rotator",
        "sartorius",
        "scalene",
        "scalenus",
        "semimembranosus",
        "semispinalis",
        "semitendinosus",
        "serratus",
        "soleus",
        "sphincter",
        "spinalis",
        "splenius",
        "sternocleidomastoid",
        "sternohyoid",
        "sternothyroid",
        "styloglossus",
        "stylohyoid",
        "subclavius",
        "subcostalis",
        "subscapularis",
        "supinator",
        "supraspinatus",
        "temporalis",
        "tensor",
        "teres",
        "thyrohyoid",
        "tibialis",
        "transversospinalis",
        "transversus",
        "trapezius",
        "triceps",
        "vastus",
        "zygomaticus"}},
      {TissueKind::Organ,
       {"organ",    "viscera",    "lung",      "liver",       "spleen",   "kidney",   "stomach", "bowel",   "intestine",
        "colon",    "duodenum",   "esophagus", "oesophagus",  "trachea",  "bronchus", "bronchi", "heart",   "atrium",
        "atrial",   "myocardium", "bladder",   "gallbladder", "prostate", "uterus",   "ovary",   "testis",  "testicle",
        "pancreas", "gland",      "thyroid",   "adrenal",     "thymus",   "eye",      "lens",    "tongue",  "larynx",
        "pharynx",  "breast",     "rectum",    "appendix",    "penis",    "vagina",   "mucosa",  "urethra", "ureter",
        "lymph",    "cornea",     "sclera",    "retina",      "tonsil"}},
      {TissueKind::Cavity, {"cavity", "lumen", "air", "gas", "csf", "cerebrospinal", "airway", "sinus", "sinuses"}},
      {TissueKind::Bone,
       {"bone",     "skeleton",   "humerus",   "radius",     "ulna",       "femur",      "tibia",    "fibula",
        "patella",  "scapula",    "clavicle",  "clavicula",  "sternum",    "manubrium",  "xiphoid",  "rib",
        "vertebra", "vertebrae",  "vertebral", "sacrum",     "coccyx",     "atlas",      "axis",     "skull",
        "cranium",  "mandible",   "maxilla",   "pelvis",     "hip",        "ilium",      "ischium",  "pubis",
        "carpal",   "metacarpal", "tarsal",    "metatarsal", "phalanx",    "phalanges",  "capitate", "hamate",
        "lunate",   "scaphoid",   "trapezium", "trapezoid",  "triquetral", "triquetrum", "pisiform", "calcaneus",
        "talus",    "navicular",  "cuboid",    "cuneiform",  "sesamoid",   "hyoid",      "ethmoid",  "vomer",
        "sphenoid", "zygomatic",  "tooth",     "teeth",      "incisor",    "molar",      "premolar", "canine",
        "concha",   "cortical",   "compact",   "costae",     "claviculae", "scapulae",   "femora",   "humeri",
        "ulnae",    "radii",      "tibiae",    "fibulae",    "patellae",   "innominate", "calvaria"}},
  };
  return kRules;
}

bool has_any(const Words& words, const Words& wanted) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return wanted.contains(word) || (word.size() > 3 && word.back() == 's' &&
                                     wanted.contains(std::string_view(word).substr(0, word.size() - 1)));
  });
}
}  // namespace

std::optional<TissueKind> tissue_kind_from_text(std::string_view text) {
  const std::string wanted = lower_case(trimmed(text));
  for (int kind = 0; kind <= static_cast<int>(TissueKind::Nail); ++kind)
    if (to_string(static_cast<TissueKind>(kind)) == wanted) return static_cast<TissueKind>(kind);
  const TissueKind by_words = tissue_kind_from_name(text);
  return by_words == TissueKind::Unknown ? std::nullopt : std::optional(by_words);
}

TissueKind tissue_kind_from_name(std::string_view tissue_name) {
  const Words words = words_in_tissue_name(tissue_name);
  for (const Rule& rule : rules())
    if (has_any(words, rule.words)) {
      const bool cortical = rule.kind == TissueKind::Bone && (words.contains("cortical") || words.contains("compact"));
      return cortical ? TissueKind::CorticalBone : rule.kind;
    }
  return TissueKind::Unknown;
}

}  // namespace limber
