// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/tissue/atlas_colours.h"

#include <algorithm>
#include <cctype>
#include <cstdint>

namespace limber {

namespace {

// The colour of an organ. `row` is the name of a row of tissues.csv, which lists the organ's names in many
// vocabularies.
struct OrganColour {
  std::string_view row;
  std::uint32_t colour;
};
constexpr OrganColour kOrgans[] = {{"tongue", 0xC66A62},
                                   {"teeth", 0xF7F3E6},
                                   {"grey matter", 0xC9A3A0},
                                   {"white matter", 0xEFE3DA},
                                   {"cerebellum", 0xC58C8C},
                                   {"cerebrospinal fluid", 0x9CC7DD},
                                   {"spinal cord", 0xE9DA86},
                                   {"heart", 0xB5483D},
                                   {"kidney", 0x97463A},
                                   {"liver", 0x8A3A2D},
                                   {"spleen", 0x7D3948},
                                   {"pancreas", 0xE3B778},
                                   {"lung", 0xE6ADAC},
                                   {"lung deflated", 0xD99896},
                                   {"trachea", 0xC6D8DC},
                                   {"bronchi", 0xB6CCD2},
                                   {"oesophagus", 0xC98F7A},
                                   {"stomach", 0xD9967E},
                                   {"duodenum", 0xD3A37D},
                                   {"small intestine", 0xE0AE93},
                                   {"colon", 0xC6996F},
                                   {"gall bladder", 0x6B8F3A},
                                   {"urinary bladder", 0xE2C27A},
                                   {"ureter", 0xD8BE8A},
                                   {"prostate", 0xC58B77},
                                   {"uterus", 0xD08A86},
                                   {"cervix", 0xC67F7E},
                                   {"ovary", 0xE5C6A8},
                                   {"testis", 0xE0C9AE},
                                   {"adrenal gland", 0xD9A441},
                                   {"thyroid", 0xA9503F},
                                   {"thymus", 0xD7A6A0},
                                   {"gland", 0xD9B79C},
                                   {"lymph node", 0x8FA860},
                                   {"eye", 0xF2EEE6},
                                   {"cornea", 0xCFE1E6},
                                   {"sclera", 0xF4F0E8},
                                   {"retina", 0xD8905F},
                                   {"lens cortex", 0xDDE6E8},
                                   {"lens nucleus", 0xD2DEE2},
                                   {"eye lens", 0xDDE6E8},
                                   {"vitreous humour", 0xDCE8EA},
                                   {"bile", 0x8B9A3A},
                                   {"urine", 0xE5CF63},
                                   {"stomach contents", 0xB89B6A},
                                   {"breast gland", 0xE0B3A6},
                                   {"breast", 0xE8C2AE},
                                   {"intestine contents", 0xA5855A},
                                   {"mucous membrane", 0xD98C86}};
constexpr std::uint32_t kVein = 0x4A6FC4;

glm::vec3 srgb_of(std::uint32_t colour) {
  return glm::vec3(colour >> 16 & 255, colour >> 8 & 255, colour & 255) / 255.0f;
}

}  // namespace

std::optional<glm::vec3> organ_colour(std::string_view row) {
  for (const OrganColour& organ : kOrgans)
    if (organ.row == row) return srgb_of(organ.colour);
  return std::nullopt;
}

std::optional<glm::vec3> vein_colour(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const std::string_view word : {"vein", "vena", "venous"})
    if (name.find(word) != std::string::npos) return srgb_of(kVein);
  return std::nullopt;
}

}  // namespace limber
