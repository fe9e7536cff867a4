// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/dielectric.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

// Values that others published, none of them the source of the parameters.
//   Ifac   the IFAC-CNR calculator's own output (niremf.ifac.cnr.it/tissprop), as kept at github.com/NeuroForLunch/dielectric-properties-of-body-tissues
//   BMEO   BioMedical Engineering OnLine 17 (2018), s12938-018-0473-9, table 3
//   Duke   the tissue file of the Virtual Family's Duke at 400 and 900 MHz, Chalmers (github.com/ravanis/Hyperthermia_Treatment_Plan), whose
//          values come from fits over that band, so that they agree to 2 % only
enum Source { Ifac, BMEO, Duke };
struct Published {
  const char* row;
  Source source;
  double frequency, permittivity, conductivity;
};
const std::vector<Published> kPublished = {
    {"muscle", BMEO, 1e4, 25909, 0.3408},          {"muscle", BMEO, 1e6, 1836.4, 0.5027},        {"muscle", Duke, 9e8, 54.326, 0.93450},
    {"fat", BMEO, 1e4, 1085.3, 0.0238},            {"fat", BMEO, 1e6, 27.222, 0.0251},           {"fat infiltrated", Duke, 4e8, 11.672, 0.079115},
    {"fat infiltrated", Duke, 9e8, 11.276, 0.11037},
    {"skin dry", BMEO, 1e4, 1133.6, 0.00020},      {"skin dry", BMEO, 1e6, 990.76, 0.0132},      {"skin dry", Duke, 9e8, 41.338, 0.87052},
    {"skin wet", BMEO, 1e4, 29010, 0.0029},        {"skin wet", BMEO, 1e6, 1832.8, 0.2214},      {"skin wet", Duke, 9e8, 46.043, 0.84809},
    {"bone cortical", BMEO, 1e4, 521.64, 0.0204},  {"bone cortical", BMEO, 1e6, 144.51, 0.0243}, {"bone cortical", Duke, 9e8, 12.451, 0.14394},
    {"bone cortical", Ifac, 1e11, 3.2975, 8.6554}, {"bone cancellous", Ifac, 1e6, 248.97, 0.090399}, {"bone cancellous", Ifac, 1e11, 4.1020, 16.041},
    {"bone marrow", Ifac, 1e6, 39.750, 0.0042081}, {"bone marrow", Ifac, 1e11, 2.8897, 3.5594},
    {"bone marrow infiltrated", Duke, 4e8, 11.989, 0.17959}, {"bone marrow infiltrated", Duke, 9e8, 11.138, 0.22887},
    {"cartilage", Duke, 4e8, 45.402, 0.58546},     {"cartilage", Duke, 9e8, 42.639, 0.78523},
    {"tendon", Ifac, 12.023, 1.9860e7, 0.25133},   {"tendon", Duke, 9e8, 45.481, 0.72681},       {"tendon", Ifac, 1e11, 5.9789, 34.891},
    {"nerve", Duke, 4e8, 35.349, 0.44542},         {"nerve", Duke, 9e8, 32.501, 0.57645},
    {"blood", Duke, 4e8, 65.085, 1.3406},          {"blood", Duke, 9e8, 60.427, 1.5239},
    {"blood vessel", Duke, 9e8, 44.756, 0.69896},  {"blood vessel", Ifac, 1e11, 6.8640, 43.022},
    {"brain grey matter", Duke, 4e8, 57.336, 0.73541},  {"brain grey matter", Duke, 9e8, 52.681, 0.94683},
    {"brain white matter", Duke, 4e8, 42.003, 0.44331}, {"brain white matter", Duke, 9e8, 38.859, 0.59392},
    {"cerebellum", Duke, 4e8, 55.890, 1.0272},     {"cerebellum", Duke, 9e8, 49.358, 1.2682},
    {"cerebrospinal fluid", Duke, 4e8, 71.848, 2.2635}, {"cerebrospinal fluid", Ifac, 1e11, 9.2945, 76.558},
    {"heart", Ifac, 1e6, 1967.3, 0.32753},         {"heart", Ifac, 1e11, 8.2366, 59.905},
    {"kidney", Ifac, 1e6, 2251.4, 0.27823},        {"kidney", Ifac, 1e11, 8.0374, 57.089},
    {"lung", Duke, 4e8, 23.775, 0.37347},          {"lung", Duke, 9e8, 21.981, 0.45852},
    {"small intestine", Ifac, 1e6, 5675.5, 0.86488}, {"small intestine", Ifac, 1e11, 8.1837, 60.494},
    {"spleen", Ifac, 1e6, 2290.0, 0.18239},        {"spleen", Ifac, 1e11, 8.0335, 57.351},
    {"stomach", Duke, 4e8, 68.224, 0.99179},       {"stomach", Duke, 9e8, 64.272, 1.1830},
    {"thyroid", Duke, 4e8, 62.091, 0.86665},       {"thyroid", Duke, 9e8, 59.093, 1.0405},
    {"tongue", Duke, 4e8, 57.608, 0.77282},        {"tongue", Duke, 9e8, 55.261, 0.93908},
    {"trachea", Duke, 4e8, 44.144, 0.63530},       {"trachea", Duke, 9e8, 41.996, 0.77360},
    {"cornea", Duke, 4e8, 59.184, 1.1908},         {"cornea", Duke, 9e8, 55.197, 1.3986},
    {"sclera", Duke, 4e8, 58.435, 0.99633},        {"sclera", Duke, 9e8, 54.480, 1.1557},
    {"eye lens", Duke, 4e8, 48.622, 0.66040},      {"eye lens", Duke, 9e8, 46.063, 0.79279},
    {"vitreous humour", Duke, 4e8, 69.002, 1.5292}, {"vitreous humour", Duke, 9e8, 68.901, 1.6363},
};

int row_named(const DielectricTable& table, const std::string& name) {
  for (std::size_t i = 0; i < table.names.size(); ++i)
    if (table.names[i].name == name) return static_cast<int>(i);
  return -1;
}

Tissue tissue_named(const std::string& name) {
  Tissue tissue;
  tissue.name = name;
  tissue.kind = tissue_kind_from_name(name);
  return tissue;
}

}  // namespace

TEST_CASE("dielectric: every tissue of the table gives what others published, at two frequencies or more") {
  const DielectricTable table = read_dielectric_table();
  std::vector<int> checked(table.names.size());
  for (const Published& published : kPublished) {
    const int row = row_named(table, published.row);
    REQUIRE_MESSAGE(row >= 0, published.row);
    ++checked[row];
    const Dielectric d = dielectric_at(table.parameters[row], published.frequency);
    // As exact as the digits that were published; conductivities of dry skin at 10 kHz have two.
    const double epsilon = published.source == Duke ? 0.02 : 1e-4;
    const double last_digit = published.source == BMEO ? (published.frequency == 1e4 && published.conductivity < 0.001 ? 5e-6 : 6e-5) : 0;
    INFO(published.row, " at ", published.frequency, " Hz: ", d.permittivity, ", ", d.conductivity, " S/m");
    CHECK(std::abs(d.permittivity - published.permittivity) <= epsilon * published.permittivity);
    CHECK(std::abs(d.conductivity - published.conductivity) <= (last_digit > 0 ? last_digit : epsilon * published.conductivity));
  }
  for (std::size_t row = 0; row < checked.size(); ++row) {
    INFO(table.names[row].name);
    CHECK(checked[row] >= 2);
    CHECK(table.sources[row].size() > 20);
  }
}

TEST_CASE("dielectric: permittivity falls and conductivity rises with frequency, and both limits hold") {
  const DielectricTable table = read_dielectric_table();
  for (std::size_t row = 0; row < table.names.size(); ++row) {
    Dielectric before = dielectric_at(table.parameters[row], 10);
    for (double f = 20; f <= 1e11; f *= 2) {
      const Dielectric here = dielectric_at(table.parameters[row], f);
      INFO(table.names[row].name, " at ", f);
      CHECK(here.permittivity <= before.permittivity);
      CHECK(here.conductivity >= before.conductivity);
      before = here;
    }
  }
  // No dispersion: the same at every frequency.
  const ColeCole plain{.epsilon_infinity = 5, .dispersions = {}, .conductivity = 0.3};
  CHECK(dielectric_at(plain, 10).permittivity == 5);
  CHECK(dielectric_at(plain, 1e11).conductivity == 0.3);
  // One Debye dispersion, by hand, at w tau = 1: half of delta, and delta eps0 / (2 tau).
  const ColeCole debye{.epsilon_infinity = 2, .dispersions = {{{10, 1 / (2 * 3.14159265358979 * 1e9), 0}}}};
  CHECK(dielectric_at(debye, 1e9).permittivity == doctest::Approx(7));
  CHECK(dielectric_at(debye, 1e9).conductivity == doctest::Approx(5 * 2 * 3.14159265358979 * 1e9 * 8.8541878128e-12));
  for (const double wrong : {0.0, 9.9, 1.1e11, -1.0, std::nan("")}) CHECK_THROWS_AS(dielectric_at(plain, wrong), Error);
}

TEST_CASE("dielectric: tissues find their row by the words of their name, else by their kind, else not at all") {
  const DielectricTable table = read_dielectric_table();
  const auto row_of = [&](const std::string& name) {
    const TissueMatch match = table.match(tissue_named(name));
    return match.row < 0 ? std::string("none") : table.names[match.row].name + (match.by_name ? "" : " (kind)");
  };
  for (const auto& [name, row] : std::vector<std::pair<std::string, std::string>>{
           {"muscle", "muscle"}, {"biceps brachii", "muscle (kind)"}, {"shin muscles", "muscle"}, {"visceral fat", "fat"}, {"Fat (Average Infiltrated)", "fat infiltrated"},
           {"skin", "skin dry"}, {"Skin (Wet)", "skin wet"}, {"cortical bone", "bone cortical"}, {"Bone (Cancellous)", "bone cancellous"}, {"femur_left", "bone cortical (kind)"},
           {"marrow", "bone marrow"}, {"BoneMarrow (Red)", "bone marrow infiltrated"}, {"tendon", "tendon"}, {"anterior cruciate ligament", "tendon"},
           {"nerve", "nerve"}, {"spinal_cord", "nerve"}, {"blood", "blood"}, {"vein", "blood"}, {"vessel wall", "blood vessel"}, {"Blood_vessels", "blood vessel"},
           {"costal_cartilages", "cartilage"}, {"intervertebral disc", "cartilage"}, {"nail", "bone cortical"}, {"kidney_left", "kidney"}, {"small_bowel", "small intestine"},
           {"Brain (White Matter)", "brain white matter"}, {"brain", "cerebellum"}, {"liver", "none"}, {"prosthesis", "none"}, {"", "none"}})
    CHECK_MESSAGE(row_of(name) == row, name);
}

TEST_CASE("dielectric: a user's rows go before the table's, and a damaged one is refused with its line") {
  const TemporaryFolder folder;
  const std::string columns = "name,names,kinds,epsilon_infinity,delta1,tau1_ps,alpha1,delta2,tau2_ns,alpha2,delta3,tau3_us,alpha3,delta4,tau4_ms,alpha4,conductivity,source\n";
  const auto table_of = [&](const std::string& text) {
    std::ofstream(folder / "p.csv") << text;
    return read_dielectric_table(folder / "p.csv");
  };
  const DielectricTable table = table_of(columns + "# mine\n\nmy muscle,muscle,,60,0,0,0,0,0,0,0,0,0,0,0,0,1.5,\"measured, by me\"\r\n");
  REQUIRE(table.match(tissue_named("muscle")).row == 0);
  CHECK(table.names[table.match(tissue_named("fat")).row].name == "fat");
  CHECK(table.sources[0] == "measured, by me");
  CHECK(dielectric_at(table.parameters[0], 5e7).conductivity == 1.5);
  for (const char* row : {"a,a,,60,0,0\n", "a,a,,60,0,0,0,0,0,0,0,0,0,0,0,0,x,s\n", "a,a,,60,0,0,0,0,0,0,0,0,0,0,0,0,-1,s\n", "a,a,,0.5,0,0,0,0,0,0,0,0,0,0,0,0,1,s\n",
                          "a,a,,60,1,1,1,0,0,0,0,0,0,0,0,0,1,s\n", "a,a,plastic,60,0,0,0,0,0,0,0,0,0,0,0,0,1,s\n", ",a,,60,0,0,0,0,0,0,0,0,0,0,0,0,1,s\n"})
    CHECK_THROWS_WITH_AS(table_of(columns + row), doctest::Contains("p.csv line 2"), Error);
  CHECK_THROWS_AS(table_of(""), Error);
  CHECK_THROWS_AS(table_of("a,b\n"), Error);
}

TEST_CASE("tissues command: lists a volume's tissues as text, JSON and CSV, and tells which have no properties") {
  const TemporaryFolder folder;
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "10", "-o", folder.path()}).exit_code == 0);
  const std::string volume = folder / "volume.nrrd", tissues = folder / "tissues.json", csv = folder / "t.csv";
  const auto text = run_limber({"tissues", volume, "--tissues", tissues, "--frequency", "900e6"});
  CHECK(text.exit_code == 0);
  CHECK(text.err.empty());
  CHECK(text.out.find("55.032") != std::string::npos);
  const auto json = run_limber({"tissues", volume, "--tissues", tissues, "--frequency", "900e6", "--json", "-o", csv});
  CHECK(json.out.find("\"unmatched\": []") != std::string::npos);
  CHECK(std::filesystem::file_size(csv) > 500);
  CHECK(run_limber({"tissues", "--frequency", "1e6"}).out.find("vitreous humour") != std::string::npos);

  std::ofstream(folder / "odd.json") << R"({"1": {"name": "liver"}})";
  const auto unmatched = run_limber({"tissues", volume, "--tissues", folder / "odd.json", "--frequency", "1e6"});
  CHECK(unmatched.exit_code == 0);
  CHECK(unmatched.err.find("liver") != std::string::npos);
  const auto wrong = run_limber({"tissues", volume, "--frequency", "5"});
  CHECK(wrong.exit_code == 1);
  CHECK(std::count(wrong.err.begin(), wrong.err.end(), '\n') == 1);
  CHECK(run_limber({"tissues", volume}).exit_code == 2);
}
