// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the operators of projects, imports, exports, recent files and samples, and of dialogs, help and preferences.
#include <fstream>

#include "core/motion/bvh.h"
#include "core/pose/pose_io.h"
#include "core/project/session.h"
#include "core/rig_io/gltf_rig.h"
#include "core/rig_io/rig_io.h"
#include "editor/context/project_life.h"
#include "editor/context/start_screen_state.h"
#include "editor/files/import.h"
#include "editor/input/keymap.h"
#include "render/image_io.h"
#include "tests/editor/operator_proofs.h"
#include "tests/editor/small_clip.h"

namespace limber::test {

using namespace editor;

namespace {

using Effect = std::function<bool(Stage&, const Seen&)>;

Effect becomes(const char* fact, const char* value = "shown") {
  return [=](Stage& s, const Seen&) { return s.is(fact, value); };
}
// Returns a check that the home folder has a file of this name, and that `same` finds the file equal to the document.
template <class Same>
Effect writes(const char* name, Same same) {
  return [=](Stage& s, const Seen&) {
    return std::filesystem::exists(s.home / name) && s.is("error", "none") && same(s.home / name, s.document());
  };
}
// Returns a script that opens the file browser from a menu, types a file name, and waits for the job.
std::string answer(const std::string& menu, const std::string& name) {
  return "click \"" + menu + "\"\n type \"" + name + "\"\n key Return\n wait-job";
}
// Returns a check that an import of this file was the last edit, and replaced this part of the document.
template <class Part>
Effect brings(const char* file, Part Document::*part) {
  return [=](Stage& s, const Seen& b) {
    return s.is("edit", (std::string("Import ") + file).c_str()) && s.document().*part &&
           s.document().*part != b.document.*part;
  };
}

Effect brings_clip(const char* name) {
  return [=](Stage& s, const Seen& b) {
    return s.is("edit", std::string("Import ") + name + ".bvh") &&
           s.document().clips.size() == b.document.clips.size() + 1 && s.is("clip", name);
  };
}

// Writes one element of a DICOM file in explicit little-endian form.
void put(std::ofstream& out, std::uint16_t group, std::uint16_t element, const char* kind, std::string value) {
  const auto number = [&](std::uint32_t n, int bytes) {
    for (int i = 0; i < bytes; ++i) out.put(static_cast<char>(n >> (8 * i)));
  };
  if (value.size() % 2) value += std::string(kind) == "UI" ? '\0' : ' ';
  number(group, 2);
  number(element, 2);
  out << kind;
  const bool wide = std::string(kind) == "OW" || std::string(kind) == "OB";
  if (wide) number(0, 2);
  number(static_cast<std::uint32_t>(value.size()), wide ? 4 : 2);
  out << value;
}
std::string two_bytes(int n) { return {static_cast<char>(n), static_cast<char>(n >> 8)}; }

// Writes slices of 8 x 8 voxels with a square in their middle.
void write_dicom_series(const std::filesystem::path& folder, int slices) {
  std::filesystem::create_directories(folder);
  for (int i = 0; i < slices; ++i) {
    std::ofstream out(folder / ("slice" + std::to_string(i) + ".dcm"), std::ios::binary);
    const std::string own = "1.2.3.4." + std::to_string(i + 1);
    out << std::string(128, '\0') << "DICM";
    put(out, 2, 0x10, "UI", "1.2.840.10008.1.2.1");
    put(out, 8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2");
    put(out, 8, 0x18, "UI", own);
    put(out, 8, 0x60, "CS", "CT");
    put(out, 0x20, 0xD, "UI", "1.2.3.5");
    put(out, 0x20, 0xE, "UI", "1.2.3.6");
    put(out, 0x20, 0x13, "IS", std::to_string(i + 1));
    put(out, 0x20, 0x32, "DS", "0\\0\\" + std::to_string(3 * i));
    put(out, 0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0");
    put(out, 0x28, 2, "US", two_bytes(1));
    put(out, 0x28, 4, "CS", "MONOCHROME2");
    put(out, 0x28, 0x10, "US", two_bytes(8));
    put(out, 0x28, 0x11, "US", two_bytes(8));
    put(out, 0x28, 0x30, "DS", "2\\2");
    put(out, 0x28, 0x100, "US", two_bytes(16));
    put(out, 0x28, 0x101, "US", two_bytes(16));
    put(out, 0x28, 0x102, "US", two_bytes(15));
    put(out, 0x28, 0x103, "US", two_bytes(0));
    std::string pixels;
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x) pixels += two_bytes(x > 1 && x < 6 && y > 1 && y < 6 ? 7 : 0);
    put(out, 0x7FE0, 0x10, "OW", pixels);
  }
}

// Leaves the edits of an editor session that crashed.
void leave_edits(Stage& s) {
  Document document = small_limb();
  {
    const auto session = Session::start({.edits_folder = s.home / "edits"});
    session->keep(document, "Open limb");
    document.clips = {
        std::make_shared<const Clip>(clip_of(std::make_shared<const Motion>(motion_of(*document.armature)), "Motion"))};
    session->keep(document, "An edit");
    REQUIRE(session->flush(20));
  }
  look_for_leftovers(s.editor());
  s.play("wait-job");
}

void make_ten_recent(Stage& s) {
  std::vector<Recent> recents;
  for (int k = 1; k <= 10; ++k) {
    const std::filesystem::path path = s.home / ("scan" + std::to_string(k) + ".nrrd");
    write_volume(*small_body().volume, path, *small_body().tissues);
    recents.push_back({path, 1000 - k});
  }
  s.editor().recent_files->recents = recents;
}

Proof sample(const char* id, const std::string& name, Effect effect) {
  return {id, "click \"File/Samples/" + name + "\"\n wait-job", std::move(effect), Shows::InBody};
}

}  // namespace

std::vector<Proof> proofs_of_files() {
  std::vector<Proof> proofs = {
      {"file.save_as", answer("File/Save as...", "limb"),
       [](Stage& s, const Seen&) {
         return is_project(s.home / "limb.limber") && s.is("unsaved", "no") && s.is("name", "limb.limber");
       }},
      {"file.save", "key Ctrl+S\n wait-job",
       [](Stage& s, const Seen&) {
         return s.is("unsaved", "no") &&
                document_hash(read_project(s.home / "limb.limber").document) == s.fact("document");
       },
       Shows::Nothing, "click Muscle/17/eye"},
      {"file.save_copy", answer("File/Save a copy...", "copy"),
       [](Stage& s, const Seen&) { return is_project(s.home / "copy.limber") && s.is("name", "limb.limber"); }},

      {"file.export_volume", answer("File/Export/Volume...", "out"),
       writes("out.nrrd",
              [](const Path& p, const Document& d) { return read_volume(p).volume.voxels == d.volume->voxels; })},
      {"file.export_tissues", answer("File/Export/Tissues...", "out-tissues"),
       writes("out-tissues.json",
              [](const Path& p, const Document& d) {
                return read_tissue_table(p).tissues.size() == d.tissues->tissues.size();
              })},
      {"file.export_rig", answer("File/Export/Rig...", "out-rig"),
       writes("out-rig.json",
              [](const Path& p, const Document& d) {
                return read_armature_file(p).armature.bones.size() == d.armature->bones.size();
              })},
      {"file.export_weights", answer("File/Export/Weights...", "out-weights"),
       writes("out-weights.nrrd", [](const Path& p, const Document&) { return kind_of(p) == FileKind::Weights; }),
       Shows::Nothing, "click Edit/Weights/Rigid\n wait-job"},
      {"file.export_pose", answer("File/Export/Pose...", "out-pose"),
       writes("out-pose.json", [](const Path& p, const Document& d) { return read_pose(p, *d.armature) == *d.pose; }),
       Shows::Nothing,
       "click \"Edit/Pose/Flex a joint...\"\n double-click Angle/value\n type \"30\"\n key Return\n key Return"},
      {"file.import_motion", answer("File/Import/Motion...", "moves.bvh") + "\n wait-idle\n key Return",
       brings_clip("moves"), Shows::Nothing, "",
       [](Stage& s) { write_bvh(bending_motion(*s.document().armature), s.home / "moves.bvh"); }},
      {"file.export_motion", answer("File/Export/Motion...", "out-motion"),
       writes("out-motion.bvh",
              [](const Path& p, const Document& d) { return read_bvh(p).joints == d.shown_clip()->motion->joints; })},
      {"file.export_gltf", answer("File/Export/glTF...", "out"),
       writes("out.glb",
              [](const Path& p, const Document& d) {
                const GltfSummary file = parse_gltf(read_file(p), true, p.string());
                return file.armature.bones.size() == d.armature->bones.size() &&
                       file.animations == std::ssize(d.clips) && file.triangles > 100;
              })},
      {"view.screenshot", "key F12\n type view\n key Return\n wait-job",
       writes("view.png", [](const Path& p, const Document&) { return render::read_png(p).size.x > 300; })},
      {"file.export_figure",
       "click \"File/Export/Figure...\"\n double-click Width/value\n type \"60\"\n key Return\n type paper.svg\n"
       " key Return\n wait-job",
       writes("paper.svg",
              [](const Path& p, const Document& d) {
                const std::string svg = read_file(p);
                const auto has = [&](const std::string& text) { return svg.find(text) != std::string::npos; };
                const auto& tissues = d.tissues->tissues;
                return has("width=\"60mm\" height=\"90mm\"") && has(" mm at the focus</text>") &&
                       std::any_of(tissues.begin(), tissues.end(),
                                   [&](const Tissue& tissue) { return has(">" + tissue.name + "</text>"); });
              })},
      {"view.turntable", "key Ctrl+F12\n type turn\n key Return\n wait-job",
       writes("turn-0035.png",
              [](const Path& p, const Document&) {
                return render::read_png(p).rgba != render::read_png(p.parent_path() / "turn-0009.png").rgba;
              })},
      {"file.export_motion_pictures",
       "click \"Motion/Clip/Export/Motion as pictures...\"\n wait-idle\n key Ctrl+A\n type steps\n key Return\n "
       "wait-idle\n key Return\n wait-job",
       writes("steps-0001.png",
              [](const Path& p, const Document&) {
                return render::read_png(p).rgba != render::read_png(p.parent_path() / "steps-0000.png").rgba;
              })},

      {"file.import_volume", answer("File/Import/Volume...", "out.nrrd"), brings("out.nrrd", &Document::volume)},
      {"file.import_rig", answer("File/Import/Rig...", "out-rig.json"), brings("out-rig.json", &Document::armature),
       Shows::InBody},
      {"file.import_weights", answer("File/Import/Weights...", "out-weights.nrrd"),
       brings("out-weights.nrrd", &Document::weights)},
      {"file.import_pose", answer("File/Import/Pose...", "out-pose.json"), brings("out-pose.json", &Document::pose),
       Shows::InBody, "key Ctrl+3"},
      {"file.import_tissues", answer("File/Import/Tissues...", "out-tissues.json"),
       brings("out-tissues.json", &Document::tissues)},
      {"file.import", "key Ctrl+I\n type out-motion.bvh\n key Return\n wait-job\n wait-idle\n key Return",
       brings_clip("out-motion")},

      {"file.new", "key Ctrl+N\n click \"Don't save\"",
       [](Stage& s, const Seen& b) { return b.document.volume && !s.document().volume && !s.document().armature; }},
      {"file.open", "click File/Open...\n type limb.limber\n key Return\n wait-job",
       [](Stage& s, const Seen&) {
         return s.is("name", "limb.limber") && s.is("hidden", "1") && s.document().armature;
       }},
      {"file.import_dicom",
       answer("File/Import/DICOM folder...", "scan") + "\n click \"Open as one volume\"\n wait-job",
       [](Stage& s, const Seen&) {
         return s.document().volume && s.document().volume->grid.size == glm::ivec3(8, 8, 4) &&
                s.document().volume->grid.spacing.z == 3;
       },
       Shows::Nothing, "", [](Stage& s) { write_dicom_series(s.home / "scan", 4); }},
  };
  for (int k = 1; k <= 10; ++k) {
    const std::string name = "scan" + std::to_string(k);
    proofs.push_back({"file.recent_" + std::to_string(k), "click \"File/Open recent/" + name + ".nrrd\"\n wait-job",
                      [name](Stage& s, const Seen&) { return s.fact("name") == name; }, Shows::Nothing, "",
                      k == 1 ? make_ten_recent : std::function<void(Stage&)>()});
  }
  proofs.push_back(sample("file.sample_arm", "Arm", [](Stage& s, const Seen&) {
    return s.is("name", "Arm") && s.is("display", "solid") && s.document().armature;
  }));
  proofs.push_back(sample("file.sample_arm_xray", "Arm, X-ray", becomes("display", "xray")));
  proofs.push_back(sample("file.sample_body", "Body", becomes("name", "Body")));
  proofs.push_back(sample("file.sample_body_open", "Body, opened", [](Stage& s, const Seen&) {
    return s.is("name", "Body, opened") && s.fact("hidden") != "0";
  }));
  proofs.push_back({"file.open_recent", "key Ctrl+Shift+O",
                    [](Stage& s, const Seen&) { return s.editor().start_screen->shown && s.is("text:Samples"); }});
  proofs.push_back({"file.recover", "click File/Recover...\n click dialog/Recover\n wait-job",
                    [](Stage& s, const Seen&) {
                      return s.editor().life->recoverable.empty() && s.document().shown_clip() &&
                             s.is("unsaved", "yes");
                    },
                    Shows::Nothing, "", leave_edits});
  proofs.push_back({"file.quit", "key Ctrl+Q\n click \"Don't save\"", becomes("quit", "yes")});
  return proofs;
}

std::vector<Proof> proofs_of_pages() {
  return {
      {"search.commands", "key F3", becomes("text:assign a key")},
      {"edit.repeat_last", "key Shift+R", becomes("display", "solid"), Shows::InBody,
       "move \"3D view/view\"\n key Alt+Z"},
      {"edit.preferences", "key Ctrl+,", becomes("text:Preferences")},
      {"edit.keymap", "click \"Edit/Change keys...\"", becomes("widget:dialog/Keymap")},
      {"edit.other_theme", "key F3\n type \"switch theme\"\n key Return", becomes("theme", "light"), Shows::InBody},
      {"help.guide", "click \"Help/User guide\"",
       [](Stage& s, const Seen&) { return s.is("dialog", "yes") && s.is("text:User guide"); }},
      {"help.new", "click \"Help/What is new\"",
       [](Stage& s, const Seen&) { return s.is("dialog", "yes") && s.is("text:What is new"); }},
      {"edit.export_keymap", "key F3\n type \"export keymap\"\n key Return\n type mine\n key Return\n wait-job",
       [](Stage& s, const Seen&) { return std::filesystem::exists(s.home / "mine.json"); }},
      {"edit.import_keymap", "key F3\n type \"import keymap\"\n key Return\n type other.json\n key Return\n wait-job",
       [](Stage& s, const Seen&) {
         return s.editor().keymap->find(*chord_from_text("Ctrl+F9"), {"global"}) != nullptr;
       },
       Shows::Nothing, "",
       [](Stage& s) {
         std::string keys = read_file(s.home / "mine.json");
         keys.replace(keys.find("\"F3\""), 4, "\"Ctrl+F9\"");
         std::ofstream(s.home / "other.json") << keys;
       }},
      {"help.keys", "click Help/Keys",
       [](Stage& s, const Seen&) { return s.is("dialog", "yes") && s.is("text:Search commands"); }},
      {"help.last_error", "click \"Help/Error details\"", becomes("error", "It broke"), Shows::Nothing, "",
       [](Stage& s) { s.editor().messages->toast_failure("it broke: here: mend it", "A job"); }},
      {"help.system_facts", "click \"Help/Copy system facts\"",
       [](Stage& s, const Seen&) { return s.sitting.test.host->clipboard().find("OpenGL") != std::string::npos; }},
      {"help.about", "click \"Help/About and licences\"", becomes("text:GNU Affero")},
      {"help.tour", "click Help/Tour\n wait-job", becomes("text:Turn the view")},
  };
}

TEST_CASE("operators: projects and files come in and go out") {
  Stage stage;
  prove(stage, proofs_of_files());
}

TEST_CASE("operators: pages, search and preferences") {
  Stage stage;
  prove(stage, proofs_of_pages());
}

}  // namespace limber::test
