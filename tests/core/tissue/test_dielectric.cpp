// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/tissue/dielectric.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

// Published values, none of which is the source of the parameters:
//   Ifac    output of the IFAC-CNR calculator (niremf.ifac.cnr.it/tissprop), from
//           github.com/NeuroForLunch/dielectric-properties-of-body-tissues
//   BMEO    BioMedical Engineering OnLine 17 (2018), s12938-018-0473-9, table 3
//   Duke    tissue file of the Virtual Family's Duke at 400 and 900 MHz, Chalmers
//           (github.com/ravanis/Hyperthermia_Treatment_Plan); its values are fits over that band, so they agree to 2 %
//   Mhz900  output of the IFAC-CNR calculator at 900 MHz for all its tissues, four digits, from gprMax's
//           AustinManWoman_materials.txt
enum Source { Ifac, BMEO, Duke, Mhz900 };
struct Published {
  const char* row;
  Source source;
  double frequency, permittivity, conductivity;
};
const std::vector<Published> kPublished = {
    {"muscle", BMEO, 1e4, 25909, 0.3408},
    {"muscle", BMEO, 1e6, 1836.4, 0.5027},
    {"muscle", Duke, 9e8, 54.326, 0.93450},
    {"fat", BMEO, 1e4, 1085.3, 0.0238},
    {"fat", BMEO, 1e6, 27.222, 0.0251},
    {"fat infiltrated", Duke, 4e8, 11.672, 0.079115},
    {"fat infiltrated", Duke, 9e8, 11.276, 0.11037},
    {"skin dry", BMEO, 1e4, 1133.6, 0.00020},
    {"skin dry", BMEO, 1e6, 990.76, 0.0132},
    {"skin dry", Duke, 9e8, 41.338, 0.87052},
    {"skin wet", BMEO, 1e4, 29010, 0.0029},
    {"skin wet", BMEO, 1e6, 1832.8, 0.2214},
    {"skin wet", Duke, 9e8, 46.043, 0.84809},
    {"bone cortical", BMEO, 1e4, 521.64, 0.0204},
    {"bone cortical", BMEO, 1e6, 144.51, 0.0243},
    {"bone cortical", Duke, 9e8, 12.451, 0.14394},
    {"bone cortical", Ifac, 1e11, 3.2975, 8.6554},
    {"bone cancellous", Ifac, 1e6, 248.97, 0.090399},
    {"bone cancellous", Ifac, 1e11, 4.1020, 16.041},
    {"bone marrow", Ifac, 1e6, 39.750, 0.0042081},
    {"bone marrow", Ifac, 1e11, 2.8897, 3.5594},
    {"bone marrow infiltrated", Duke, 4e8, 11.989, 0.17959},
    {"bone marrow infiltrated", Duke, 9e8, 11.138, 0.22887},
    {"cartilage", Duke, 4e8, 45.402, 0.58546},
    {"cartilage", Duke, 9e8, 42.639, 0.78523},
    {"tendon", Ifac, 12.023, 1.9860e7, 0.25133},
    {"tendon", Duke, 9e8, 45.481, 0.72681},
    {"tendon", Ifac, 1e11, 5.9789, 34.891},
    {"nerve", Duke, 4e8, 35.349, 0.44542},
    {"nerve", Duke, 9e8, 32.501, 0.57645},
    {"blood", Duke, 4e8, 65.085, 1.3406},
    {"blood", Duke, 9e8, 60.427, 1.5239},
    {"blood vessel", Duke, 9e8, 44.756, 0.69896},
    {"blood vessel", Ifac, 1e11, 6.8640, 43.022},
    {"brain grey matter", Duke, 4e8, 57.336, 0.73541},
    {"brain grey matter", Duke, 9e8, 52.681, 0.94683},
    {"brain white matter", Duke, 4e8, 42.003, 0.44331},
    {"brain white matter", Duke, 9e8, 38.859, 0.59392},
    {"cerebellum", Duke, 4e8, 55.890, 1.0272},
    {"cerebellum", Duke, 9e8, 49.358, 1.2682},
    {"cerebrospinal fluid", Duke, 4e8, 71.848, 2.2635},
    {"cerebrospinal fluid", Ifac, 1e11, 9.2945, 76.558},
    {"heart", Ifac, 1e6, 1967.3, 0.32753},
    {"heart", Ifac, 1e11, 8.2366, 59.905},
    {"kidney", Ifac, 1e6, 2251.4, 0.27823},
    {"kidney", Ifac, 1e11, 8.0374, 57.089},
    {"lung", Duke, 4e8, 23.775, 0.37347},
    {"lung", Duke, 9e8, 21.981, 0.45852},
    {"small intestine", Ifac, 1e6, 5675.5, 0.86488},
    {"small intestine", Ifac, 1e11, 8.1837, 60.494},
    {"spleen", Ifac, 1e6, 2290.0, 0.18239},
    {"spleen", Ifac, 1e11, 8.0335, 57.351},
    {"stomach", Duke, 4e8, 68.224, 0.99179},
    {"stomach", Duke, 9e8, 64.272, 1.1830},
    {"thyroid", Duke, 4e8, 62.091, 0.86665},
    {"thyroid", Duke, 9e8, 59.093, 1.0405},
    {"tongue", Duke, 4e8, 57.608, 0.77282},
    {"tongue", Duke, 9e8, 55.261, 0.93908},
    {"trachea", Duke, 4e8, 44.144, 0.63530},
    {"trachea", Duke, 9e8, 41.996, 0.77360},
    {"cornea", Duke, 4e8, 59.184, 1.1908},
    {"cornea", Duke, 9e8, 55.197, 1.3986},
    {"sclera", Duke, 4e8, 58.435, 0.99633},
    {"sclera", Duke, 9e8, 54.480, 1.1557},
    {"lens cortex", Duke, 4e8, 48.622, 0.66040},
    {"lens cortex", Duke, 9e8, 46.063, 0.79279},
    {"vitreous humour", Duke, 4e8, 69.002, 1.5292},
    {"vitreous humour", Duke, 9e8, 68.901, 1.6363},
    {"bladder", Ifac, 10, 5.0997e6, 0.20278},
    {"bladder", Ifac, 12.023, 4.1888e6, 0.20329},
    {"bladder", Ifac, 1e11, 3.6516, 17.371},
    {"breast fat", Ifac, 1e11, 2.5891, 1.8358},
    {"cervix", Ifac, 1e11, 7.6893, 52.569},
    {"colon", Ifac, 1e11, 8.1777, 59.211},
    {"dura", Ifac, 1e11, 8.2149, 47.578},
    {"gall bladder", Ifac, 1e11, 7.5090, 64.825},
    {"bile", Ifac, 1e11, 8.2107, 78.118},
    {"lung deflated", Ifac, 1e11, 7.7319, 52.895},
    {"ovary", Ifac, 1e11, 7.9463, 46.426},
    {"testis", Ifac, 1e11, 8.5170, 64.401},
    {"uterus", Ifac, 1e11, 8.5337, 64.615},
    {"lung", Ifac, 1e11, 4.0026, 21.384},
    {"thyroid", Ifac, 1e11, 8.5046, 64.066},
    {"lens cortex", Ifac, 1e11, 7.4369, 48.910},
    {"muscle", Ifac, 1e11, 8.6307, 62.499},
    {"brain grey matter", Ifac, 1e11, 7.7561, 53.246},
    {"brain white matter", Ifac, 1e11, 6.7126, 38.009},
    {"uterus", Ifac, 9.0053e10, 9.1887, 62.924},
    {"cervix", Ifac, 100, 2.0139e7, 0.41134},
    {"colon", Ifac, 100, 2.0091e7, 0.12134},
    {"dura", Ifac, 100, 19486, 0.50056},
    {"ovary", Ifac, 100, 4.8714e5, 0.32211},
    {"testis", Ifac, 100, 4.9453e5, 0.42211},
    {"uterus", Ifac, 100, 2.4512e7, 0.29009},
    {"gas", Mhz900, 9e8, 1, 0},
    {"gas", Ifac, 1e11, 1, 0},
    {"blood vessel", Mhz900, 9e8, 44.77, 0.6961},
    {"bladder", Mhz900, 9e8, 18.94, 0.3831},
    {"blood", Mhz900, 9e8, 61.36, 1.538},
    {"bone cancellous", Mhz900, 9e8, 20.79, 0.34},
    {"bone cortical", Mhz900, 9e8, 12.45, 0.1433},
    {"bone marrow", Mhz900, 9e8, 5.504, 0.04021},
    {"brain grey matter", Mhz900, 9e8, 52.73, 0.9423},
    {"brain white matter", Mhz900, 9e8, 38.89, 0.5908},
    {"breast fat", Mhz900, 9e8, 5.424, 0.04896},
    {"cartilage", Mhz900, 9e8, 42.65, 0.7824},
    {"cerebellum", Mhz900, 9e8, 49.44, 1.263},
    {"cerebrospinal fluid", Mhz900, 9e8, 68.64, 2.413},
    {"cervix", Mhz900, 9e8, 49.78, 0.9591},
    {"colon", Mhz900, 9e8, 57.94, 1.08},
    {"cornea", Mhz900, 9e8, 55.23, 1.394},
    {"dura", Mhz900, 9e8, 44.43, 0.9611},
    {"sclera", Mhz900, 9e8, 55.27, 1.167},
    {"fat", Mhz900, 9e8, 5.462, 0.05104},
    {"gall bladder", Mhz900, 9e8, 59.14, 1.257},
    {"bile", Mhz900, 9e8, 70.19, 1.838},
    {"heart", Mhz900, 9e8, 59.89, 1.23},
    {"kidney", Mhz900, 9e8, 58.67, 1.392},
    {"lens cortex", Mhz900, 9e8, 46.57, 0.7934},
    {"liver", Mhz900, 9e8, 46.83, 0.855},
    {"lung deflated", Mhz900, 9e8, 51.42, 0.858},
    {"lung", Mhz900, 9e8, 22, 0.4567},
    {"muscle", Mhz900, 9e8, 55.03, 0.9429},
    {"nerve", Mhz900, 9e8, 32.53, 0.5737},
    {"ovary", Mhz900, 9e8, 50.47, 1.29},
    {"skin dry", Mhz900, 9e8, 41.41, 0.8667},
    {"skin wet", Mhz900, 9e8, 46.08, 0.8447},
    {"small intestine", Mhz900, 9e8, 59.49, 2.165},
    {"spleen", Mhz900, 9e8, 57.18, 1.273},
    {"stomach", Mhz900, 9e8, 65.06, 1.187},
    {"tendon", Mhz900, 9e8, 45.83, 0.7184},
    {"testis", Mhz900, 9e8, 60.55, 1.21},
    {"thyroid", Mhz900, 9e8, 59.68, 1.038},
    {"tongue", Mhz900, 9e8, 55.27, 0.9363},
    {"trachea", Mhz900, 9e8, 42.01, 0.7711},
    {"uterus", Mhz900, 9e8, 61.12, 1.27},
    {"vitreous humour", Mhz900, 9e8, 68.9, 1.636},
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

TEST_CASE("dielectric: tissues give what others published from 10 Hz to 100 GHz") {
  const DielectricTable table = read_dielectric_table();
  std::vector<int> checked(table.names.size());
  for (const Published& published : kPublished) {
    const int row = row_named(table, published.row);
    REQUIRE_MESSAGE(row >= 0, published.row);
    ++checked[row];
    const Dielectric d = dielectric_at(table.parameters[row], published.frequency);
    // The tolerance follows the digits that were published. Conductivities of dry skin at 10 kHz have two.
    const double epsilon = published.source == Duke ? 0.02 : published.source == Mhz900 ? 6e-4 : 1e-4;
    const double last_digit =
        published.source == BMEO ? (published.frequency == 1e4 && published.conductivity < 0.001 ? 5e-6 : 6e-5) : 0;
    INFO(published.row, " at ", published.frequency, " Hz: ", d.permittivity, ", ", d.conductivity, " S/m");
    CHECK(std::abs(d.permittivity - published.permittivity) <= epsilon * published.permittivity);
    CHECK(std::abs(d.conductivity - published.conductivity) <=
          (last_digit > 0 ? last_digit : epsilon * published.conductivity));
  }
  CHECK(checked.size() == 46);  // 44 tissues, gas, and the metal of implants
  for (const std::string& source : table.sources) CHECK(source.size() > 20);
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
  // Without dispersions, the values are the same at every frequency.
  const ColeCole plain{.epsilon_infinity = 5, .dispersions = {}, .conductivity = 0.3};
  CHECK(dielectric_at(plain, 10).permittivity == 5);
  CHECK(dielectric_at(plain, 1e11).conductivity == 0.3);
  // One Debye dispersion at w tau = 1, by hand: the permittivity gains delta / 2, the conductivity delta eps0 / (2
  // tau).
  const ColeCole debye{.epsilon_infinity = 2, .dispersions = {{{10, 1 / (2 * 3.14159265358979 * 1e9), 0}}}};
  CHECK(dielectric_at(debye, 1e9).permittivity == doctest::Approx(7));
  CHECK(dielectric_at(debye, 1e9).conductivity == doctest::Approx(5 * 2 * 3.14159265358979 * 1e9 * 8.8541878128e-12));
  for (const double wrong : {0.0, 9.9, 1.1e11, -1.0, std::nan("")}) CHECK_THROWS_AS(dielectric_at(plain, wrong), Error);
}

TEST_CASE(
    "dielectric: a whole bone lies between the bones it is made of, by the share that its density tells, and a brain "
    "is no cerebellum") {
  TissueTable tissues;
  for (const char* name :
       {"vertebrae_L3", "brain", "cortical bone", "cancellous bone", "cerebellum", "grey matter", "white matter"}) {
    tissues.tissues.push_back(tissue_named(name));
    tissues.tissues.back().label = static_cast<Label>(tissues.tissues.size());
    apply_kind_defaults(tissues.tissues.back());
  }
  const TissueMaterials found = tissue_materials(tissues, read_dielectric_table(), 900e6);
  REQUIRE(found.unmatched.empty());
  const auto& m = found.materials;
  const double cortical = (1.33 - 1.18) / (1.92 - 1.18);
  CHECK(m[0].density == doctest::Approx(1330));
  CHECK(m[0].dielectric.permittivity == doctest::Approx(cortical * 12.454 + (1 - cortical) * 20.788).epsilon(1e-4));
  CHECK(m[0].dielectric.conductivity == doctest::Approx(cortical * 0.14332 + (1 - cortical) * 0.34).epsilon(1e-4));
  CHECK(m[0].properties == "20 % bone cortical + 80 % bone cancellous");
  CHECK(m[0].found == "name: vertebrae");
  CHECK_FALSE(m[0].stand_in.empty());
  CHECK(m[1].dielectric.permittivity ==
        doctest::Approx((m[5].dielectric.permittivity + m[6].dielectric.permittivity) / 2));
  CHECK(m[1].row == "brain");
  CHECK(m[1].stand_in.find("grey and white matter") != std::string::npos);
  CHECK(m[4].dielectric.permittivity == doctest::Approx(49.44).epsilon(1e-3));
  CHECK(stand_ins_text(found.materials).find("brain as 50 % brain grey matter + 50 % brain white matter") !=
        std::string::npos);
  CHECK(stand_ins_text({m[2], m[3]}).empty());
}

TEST_CASE("dielectric: a user's rows go before the table's, and a damaged one is refused with its line") {
  const TemporaryFolder folder;
  const std::string columns =
      "name,names,kinds,epsilon_infinity,delta1,tau1_ps,alpha1,delta2,tau2_ns,alpha2,delta3,tau3_us,alpha3,delta4,tau4_"
      "ms,alpha4,conductivity,source\n";
  const auto table_of = [&](const std::string& text) {
    std::ofstream(folder / "p.csv") << text;
    return read_dielectric_table(folder / "p.csv");
  };
  const DielectricTable table =
      table_of(columns + "# mine\n\nmy muscle,muscle,,60,0,0,0,0,0,0,0,0,0,0,0,0,1.5,\"measured, by me\"\r\n");
  REQUIRE(table.match_user(tissue_named("muscle")).row == 0);
  CHECK(table.match_user(tissue_named("fat")).row == -1);
  TissueTable tissues;
  for (const char* name : {"muscle", "fat"}) tissues.tissues.push_back(tissue_named(name));
  const auto materials = tissue_materials(tissues, table, 5e7).materials;
  CHECK(materials[0].row == "my muscle");
  CHECK(materials[0].found == "own row, name: muscle");
  CHECK(materials[1].row == "fat");
  CHECK(table.sources[0] == "measured, by me");
  CHECK(dielectric_at(table.parameters[0], 5e7).conductivity == 1.5);
  for (const char* row :
       {"a,a,,60,0,0\n", "a,a,,60,0,0,0,0,0,0,0,0,0,0,0,0,x,s\n", "a,a,,60,0,0,0,0,0,0,0,0,0,0,0,0,-1,s\n",
        "a,a,,0.5,0,0,0,0,0,0,0,0,0,0,0,0,1,s\n", "a,a,,60,1,1,1,0,0,0,0,0,0,0,0,0,1,s\n",
        "a,a,plastic,60,0,0,0,0,0,0,0,0,0,0,0,0,1,s\n", ",a,,60,0,0,0,0,0,0,0,0,0,0,0,0,1,s\n"})
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

  std::ofstream(folder / "odd.json") << R"({"1": {"name": "unobtainium"}})";
  const auto unmatched = run_limber({"tissues", volume, "--tissues", folder / "odd.json", "--frequency", "1e6"});
  CHECK(unmatched.exit_code == 0);
  CHECK(unmatched.err.find("unobtainium") != std::string::npos);
  const auto wrong = run_limber({"tissues", volume, "--frequency", "5"});
  CHECK(wrong.exit_code == 1);
  CHECK(std::count(wrong.err.begin(), wrong.err.end(), '\n') == 1);
  CHECK(run_limber({"tissues", volume}).exit_code == 2);
}
