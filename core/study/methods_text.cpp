// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/methods_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <set>

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "core/resample/deformation_method.h"
#include "core/study/text.h"

namespace limber {

namespace {

using Json = nlohmann::json;

// The papers in which the algorithms were published.
const std::map<std::string, const char*> kPapers = {
    {"linear",
     "N. Magnenat-Thalmann, R. Laperrière, D. Thalmann: Joint-dependent local deformations for hand animation and "
     "object grasping. Proc. Graphics Interface 1988, 26–33."},
    {"dual",
     "L. Kavan, S. Collins, J. Žára, C. O’Sullivan: Geometric skinning with approximate dual quaternion blending. ACM "
     "Trans. Graph. 27(4), 105, 2008."},
    {"projective",
     "S. Bouaziz, S. Martin, T. Liu, L. Kavan, M. Pauly: Projective dynamics: fusing constraint projections for fast "
     "simulation. ACM Trans. Graph. 33(4), 154, 2014."},
    {"heat",
     "I. Baran, J. Popović: Automatic rigging and animation of 3D characters. ACM Trans. Graph. 26(3), 72, 2007."},
    {"geodesic",
     "O. Dionne, M. de Lasa: Geodesic voxel binding for production character meshes. Proc. ACM SIGGRAPH/Eurographics "
     "Symp. Computer Animation 2013, 173–180."},
    {"net",
     "S. F. F. Gibson: Constrained elastic surface nets: generating smooth surfaces from binary segmented data. Proc. "
     "MICCAI 1998, 888–898."},
    {"stuffing",
     "F. Labelle, J. R. Shewchuk: Isosurface stuffing: fast tetrahedral meshes with good dihedral angles. ACM Trans. "
     "Graph. 26(3), 57, 2007."},
    {"tetgen",
     "H. Si: TetGen, a Delaunay-based quality tetrahedral mesh generator. ACM Trans. Math. Softw. 41(2), 11, 2015."},
    {"neohooke",
     "J. Bonet, R. D. Wood: Nonlinear continuum mechanics for finite element analysis, 2nd ed. Cambridge University "
     "Press, 2008."},
    {"fbar",
     "E. A. de Souza Neto, F. M. A. Pires, D. R. J. Owen: F-bar-based linear triangles and tetrahedra for finite "
     "strain "
     "analysis of nearly incompressible solids. Int. J. Numer. Methods Eng. 62(3), 353–383, 2005."},
    {"eigen",
     "B. Smith, F. de Goes, T. Kim: Analytic eigensystems for isotropic distortion energies. ACM Trans. Graph. 38(1), "
     "3, 2019."},
    {"ipc",
     "M. Li, Z. Ferguson, T. Schneider, T. Langlois, D. Zorin, D. Panozzo, C. Jiang, D. M. Kaufman: Incremental "
     "potential contact: intersection- and inversion-free, large-deformation dynamics. ACM Trans. Graph. 39(4), 49, "
     "2020."},
    {"codim",
     "M. Li, D. M. Kaufman, C. Jiang: Codimensional incremental potential contact. ACM Trans. Graph. 40(4), 170, "
     "2021."},
    {"cholmod",
     "Y. Chen, T. A. Davis, W. W. Hager, S. Rajamanickam: Algorithm 887: CHOLMOD, supernodal sparse Cholesky "
     "factorization and update/downdate. ACM Trans. Math. Softw. 35(3), 22, 2008."},
    {"flows", "R. K. Ahuja, T. L. Magnanti, J. B. Orlin: Network flows. Prentice Hall, 1993."},
};

class MethodsWriter {
 public:
  MethodsWriter(const Study& study, const std::vector<CellResult>& cells, bool of_session)
      : study_(study),
        of_session_(of_session) {
    for (const CellResult& cell : cells)
      if (cell.done()) reports_.push_back(Json::parse(sound_json(cell.report), nullptr, false));
  }

  MethodsText operator()() {
    const std::string text = body() + weights() + blends() + finite_elements() + labels() + measures();
    return cited(text);
  }

 private:
  // Marks a reference to a paper by control characters, which escaped text does not contain.
  static std::string cite(const std::string& paper) { return "\1" + paper + "\2"; }
  // Replaces the marked references by numbers such as "[3]", in the order of the text, and lists the papers.
  static MethodsText cited(const std::string& text) {
    MethodsText result;
    std::map<std::string, int> numbers;
    std::size_t at = 0;
    for (std::size_t begin; (begin = text.find('\1', at)) != std::string::npos;) {
      const std::size_t end = text.find('\2', begin);
      const std::string paper = text.substr(begin + 1, end - begin - 1);
      const auto [number, is_new] = numbers.try_emplace(paper, int(numbers.size()) + 1);
      if (is_new) result.references += "<li>" + escaped(kPapers.at(paper)) + "</li>";
      result.paragraphs += text.substr(at, begin - at) + "\u00a0[" + std::to_string(number->second) + "]";
      at = end + 1;
    }
    result.paragraphs += text.substr(at);
    return result;
  }

  static std::string paragraph(const std::string& text) { return text.empty() ? "" : "<p>" + text + "</p>\n"; }
  static std::string mm(const std::string& number) { return number + "\u00a0mm"; }

  bool uses(const std::function<bool(const Technique&)>& rule) const {
    return std::any_of(study_.techniques.begin(), study_.techniques.end(), rule);
  }

  static std::string short_number(double value) {
    if (value == std::floor(value)) return grouped(static_cast<std::int64_t>(value));
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
  }

  // Returns the values at a path of the cells' reports as text: "8", or "6.2 to 8" if the reports differ.
  std::string used(const std::string& path) const {
    std::set<double> numbers;
    std::set<std::string> words;
    const Json::json_pointer pointer(path);
    for (const Json& report : reports_) {
      if (!report.contains(pointer)) continue;
      const Json& value = report.at(pointer);
      if (value.is_number()) numbers.insert(value.get<double>());
      if (value.is_string()) words.insert(value.get<std::string>());
    }
    if (!numbers.empty()) {
      const std::string least = short_number(*numbers.begin()), most = short_number(*numbers.rbegin());
      return least == most ? least : least + " to " + most;
    }
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return escaped(text);
  }

  std::string body() const {
    if (of_session_) return "";
    std::string spacings;
    for (const auto& spacing : study_.spacings) spacings += (spacings.empty() ? "" : ", ") + spacing_text(spacing);
    std::string text = study_.phantom.empty()
                           ? "The body is the labelled volume " + escaped(study_.volume.filename().string())
                           : "The body is Limber’s procedural " + study_.phantom;
    text += ", at voxel spacings of " + escaped(spacings) + " (" + used("/total/voxels_before") + " voxels of tissue).";
    std::string given;
    for (const auto& [spacing, file] : study_.ready) given += (given.empty() ? "" : ", ") + spacing_text(spacing);
    if (!given.empty()) text += " It was given at " + given + ", and resampled to other spacings.";
    else if (study_.phantom.empty() && study_.spacings.front()) text += " It was resampled to these spacings.";
    if (study_.fit_joints) text += " The rig’s joints were fitted to the bones before each pose.";
    return paragraph(text + glide());
  }
  std::string glide() const {
    const std::string word = used("/settings/glide");
    if (word.empty() || word == "off") return "";
    const std::string how = word == "joint"   ? "5 % of the shorter of its two bones"
                            : word == "voxel" ? "the edge of a voxel"
                                              : mm(word);
    return " Joints whose bones would overlap were shifted by the smallest distance that separates them, at most by " +
           how + ".";
  }

  std::string weights() {
    if (of_session_) return "";
    std::string text = "Weights of bones were computed ";
    if (study_.weights == "heat")
      text += "by the diffusion of heat through the tissue" + cite("heat") +
              ", from voxels of bone held at fixed temperatures.";
    else if (study_.weights == "geodesic")
      text += "from the lengths of shortest paths through the tissue to each bone" + cite("geodesic") + ".";
    else text += "rigidly: each voxel follows only one bone.";
    return paragraph(text + " Bone tissue always moves rigidly with its bone.");
  }

  std::string blends() {
    std::string text;
    std::set<std::string> told;
    for (const Technique& technique : study_.techniques) {
      if (technique.is_fem() || !told.insert(technique.method).second) continue;
      text += (text.empty() ? "" : " ") + blend(technique.method);
    }
    return paragraph(text);
  }
  std::string blend(const std::string& word) {
    if (word == "lbs")
      return "Linear blend moves each point by the weighted mean of the bones’ motions" + cite("linear") + ".";
    if (word == "dqs") return "Dual quaternions blend the motions as screw motions" + cite("dual") + ".";
    if (word == "mix")
      return "The mixed blend lies between linear blend" + cite("linear") + " and dual quaternions" + cite("dual") +
             "; the smallest and smoothest displacements then restore the volume of soft tissue" + cite("projective") +
             ".";
    const DeformationMethod* method = find_method(word);
    return method ? escaped(method->description) : "";
  }

  std::string finite_elements() {
    if (!uses([](const Technique& technique) { return technique.is_fem(); })) return "";
    const std::string tet = used("/solve/parameters/tet_mm"), finest = used("/solve/parameters/finest_tet_mm");
    if (tet.empty()) return "";  // there are only rest poses, which are not solved
    const auto parameter = [&](const char* name) { return used(std::string("/solve/parameters/") + name); };
    std::string text = "Finite elements: the tissue that a pose bends was meshed with tetrahedra, with nodes about " +
                       mm(tet) + (finest == tet ? "" : " (" + mm(finest) + " around joints)") + " apart (quality " +
                       used("/settings/quality") + "; " + used("/mesh/tets") + " tetrahedra), ";
    text +=
        used("/settings/mesher") == "tetgen"
            ? "by TetGen" + cite("tetgen") + " inside a surface net" + cite("net") + ". "
            : "on a body-centred cubic lattice" + cite("stuffing") + " bounded by a surface net" + cite("net") + ". ";
    text +=
        "Soft tissue is a compressible neo-Hookean solid" + cite("neohooke") +
        " with Young’s moduli and Poisson ratios of the tissue table; the mean volume of patches of tetrahedra "
        "avoids locking" +
        cite("fbar") +
        ", and a pressure of its own keeps the volume of each soft tissue of 500 voxels or more in the pose. Barriers "
        "keep tetrahedra from inverting" +
        cite("ipc") + ". The pose was reached in steps of at most " + parameter("step_degrees") +
        "°, each solved by projected Newton" + cite("eigen") + " with sparse Cholesky factors" + cite("cholmod") +
        " until no node would move by more than " + mm(parameter("step_tolerance_mm")) + ", at the end " +
        mm(parameter("tolerance_mm")) + " (" + used("/solve/iterations") + " iterations). Ends of bones within " +
        mm(parameter("joint_mm")) + " of another bone count as the joint and are not held.";
    const std::string contact = parameter("contact_mm");
    if (!contact.empty())
      text += " With contact, skin nearer than " + mm(contact) + " to other skin is pushed apart" + cite("ipc") +
              cite("codim") + "; without, skin may pass through skin.";
    return paragraph(text);
  }

  std::string labels() {
    std::string text =
        study_.nearest
            ? "A posed voxel has the label of the nearest voxel at rest."
            : "A posed voxel has the label that has the largest share at the voxel's rest position, by interpolation.";
    if (uses([](const Technique& technique) { return technique.mass_exact; }))
      text += " Mass-exact techniques then change the least certain voxels at borders, by cheapest paths of a flow" +
              cite("flows") + ", until soft tissues have their volumes again.";
    return paragraph(text);
  }

  std::string measures() const {
    const QualityLimits& gates = study_.gates;
    std::string text =
        "Volume changes are changes of the number of voxels, relative to rest at the same spacing. Every label of " +
        grouped(gates.least_voxels) + " voxels or more at rest is judged by its change: at most " +
        number(gates.tissue_percent) + " %. Bones may deviate from a rigid motion by " +
        mm(number(gates.bone_residual_mm)) + ", skin may lose " + number(gates.skin_share_percent) +
        " % of its share of the surface, and joints may exceed their limits by " + number(gates.joint_excess_degrees) +
        "°.";
    if (of_session_) return paragraph(text);
    text += study_.repeats > 1
                ? " Each cell was computed " + std::to_string(study_.repeats) +
                      " times, one after another, in processes of their own; all repeats gave the same voxels and "
                      "numbers. Times are medians, with the range from the smallest to the largest."
                : " Each cell was computed once, in a process of its own.";
    return paragraph(text + " Times are processor seconds of the whole process, over all its threads.");
  }

  const Study& study_;
  const bool of_session_;
  std::vector<Json> reports_;
};

}  // namespace

MethodsText methods_text(const Study& study, const std::vector<CellResult>& cells, bool of_session) {
  return MethodsWriter(study, cells, of_session)();
}

}  // namespace limber
