// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/screen/help_dialog.h"

#include <cstdio>
#include <thread>

#include <epoxy/gl.h>

#include "core/platform/host.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/interaction.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/platform_window.h"
#include "editor/dialogs/dialog.h"
#include "editor/screen/preferences_dialog.h"
#include "editor/ui/fuzzy_match.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"

namespace limber::editor {

namespace {

class KeysPage final : public Dialog {
 public:
  void draw(Context& context) override;

 private:
  std::string search_;
};

void KeysPage::draw(Context& context) {
  const Look& look = context.ui->look;
  const Rect rect = begin_dialog(context, "Keys", 600, 560);
  const float search_bottom = rect.low.y + look.px(26);
  text_field(context.ui, "search", {rect.low, {rect.high.x - look.px(150), search_bottom}}, search_, "Search keys");
  operator_button(context, "edit.keymap", {{rect.high.x - look.px(140), rect.low.y}, {rect.high.x, search_bottom}},
                  "Change keys...");
  {
    Column column(context.ui, "keys",
                  {{rect.low.x - look.px(18) + look.line(), search_bottom + look.px(10)},
                   {rect.high.x + look.px(18) - look.line(), rect.high.y + look.px(10)}});
    bool any = false;
    for (const char* key_context : {"global", "view3d", "slice", "sidebar", "select", "rig", "skin", "pose", "resample",
                                    "timeline", "graph", "strips"}) {
      const auto bindings = context.keymap->contexts.find(key_context);
      if (bindings == context.keymap->contexts.end()) continue;
      int index = 0;
      for (const Binding& binding : bindings->second) {
        const Operator* op = find_operator(context.operators, binding.operator_id);
        if (!op || (!fuzzy_match(search_, op->label) && to_text(binding.chord) != search_)) continue;
        if (index == 0) {
          const Rect title = column.row(30);
          put_text(context.ui, look.fonts.semibold, look.theme.text2,
                   Rect{{title.low.x + look.px(18), title.low.y}, title.high}, title_of_context(key_context));
        }
        any = true;
        Rect row;
        if (!column.list_row(row, index++, false)) continue;
        const std::vector<std::string> caps = key_caps(binding.chord);
        put_key_caps(context.ui, row.low.x + look.px(18), row.centre().y, caps);
        put_text(context.ui, look.fonts.regular, look.theme.text,
                 Rect{{row.low.x + look.px(190), row.low.y}, {row.high.x - look.px(18), row.high.y}}, op->label);
        if (binding.chord.kind == Chord::Kind::Drag)
          put_text(context.ui, look.fonts.small, look.theme.text2,
                   Rect{{row.low.x + look.px(24) + width_of_key_caps(context.ui, caps), row.low.y},
                        {row.low.x + look.px(186), row.high.y}},
                   "drag");
      }
    }
    if (!any && empty_state(context.ui, column.row(72), "No key for '" + search_ + "'", "Clear search"))
      search_.clear();
  }
  end_dialog(context);
}

struct Part {
  const char *name, *licence, *use;
};
constexpr Part kParts[] = {
    {"Dear ImGui", "MIT", "interface"},
    {"GLFW", "zlib", "window"},
    {"libepoxy", "MIT", "OpenGL"},
    {"FreeType", "FTL", "typefaces"},
    {"Inter", "OFL 1.1", "typeface"},
    {"JetBrains Mono", "OFL 1.1", "typeface"},
    {"Font Awesome 4.7", "OFL 1.1", "icons"},
    {"GLM", "MIT", "vectors"},
    {"Eigen", "MPL 2.0", "linear algebra"},
    {"oneTBB", "Apache 2.0", "threads"},
    {"nlohmann json", "MIT", "JSON"},
    {"CLI11", "BSD 3-clause", "command line"},
    {"SQLite", "public domain", "projects"},
    {"Zstandard", "BSD 3-clause", "projects"},
    {"ISA-L", "BSD 3-clause", "volumes"},
    {"bzip2", "bzip2", "volumes"},
    {"libpng", "libpng", "pictures"},
    {"Expat", "MIT", "XML"},
    {"OpenSSL", "Apache 2.0", "checksums"},
    {"GDCM", "BSD 3-clause", "DICOM"},
};

class AboutPage final : public Dialog {
 public:
  void draw(Context& context) override;
};

void AboutPage::draw(Context& context) {
  const Look& look = context.ui->look;
  const Rect rect = begin_dialog(context, "About and licences", 600, 520);
  float y = rect.low.y;
  const auto line = [&](ImFont* font, Colour colour, const std::string& text, float height) {
    put_text(context.ui, font, colour, Rect{{rect.low.x, y}, {rect.high.x, y + look.px(height)}}, text);
    y += look.px(height);
  };
  line(look.fonts.title, look.theme.text, "Limber", 40);
  line(look.fonts.regular, look.theme.text2,
       std::string("Version ") + LIMBER_VERSION + ". Changes the pose of labelled voxel anatomy.", 24);
  line(look.fonts.regular, look.theme.text2,
       "Free software under the GNU Affero General Public License, version 3 or later.", 24);
  line(look.fonts.regular, look.theme.text2, "It comes without any warranty, to the extent permitted by law.", 30);
  line(look.fonts.semibold, look.theme.text, "Made with", 26);
  const float foot = rect.high.y - look.px(28);
  {
    Column column(
        context.ui, "parts",
        {{rect.low.x - look.px(18) + look.line(), y}, {rect.high.x + look.px(18) - look.line(), foot - look.px(10)}});
    int index = 0;
    for (const Part& part : kParts) {
      Rect row;
      if (!column.list_row(row, index++, false)) continue;
      put_text(context.ui, look.fonts.regular, look.theme.text,
               Rect{{row.low.x + look.px(18), row.low.y}, {row.low.x + look.px(220), row.high.y}}, part.name);
      put_text(context.ui, look.fonts.regular, look.theme.text2,
               Rect{{row.low.x + look.px(220), row.low.y}, {row.low.x + look.px(400), row.high.y}}, part.licence);
      put_text(context.ui, look.fonts.regular, look.theme.text2, Rect{{row.low.x + look.px(400), row.low.y}, row.high},
               part.use);
    }
  }
  const float width = look.px(170);
  operator_button(context, "help.system_facts", {{rect.high.x - width, foot}, rect.high}, "Copy system facts");
  end_dialog(context);
}

const char* gl_text(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text ? reinterpret_cast<const char*>(text) : "unknown";
}

}  // namespace

std::unique_ptr<Dialog> open_keys_page() { return std::make_unique<KeysPage>(); }
std::unique_ptr<Dialog> open_about_page() { return std::make_unique<AboutPage>(); }

std::string system_facts(const Context& context) {
  const SystemName system = system_name();
  const glm::ivec2 size = context.host->size();
  char facts[1024];
  std::snprintf(facts, sizeof facts, "Limber %s\n%s %s %s, %u threads\nOpenGL %s\n%s\nWindow %d x %d, scale %.2f\n",
                LIMBER_VERSION, system.name.c_str(), system.release.c_str(), system.architecture.c_str(),
                std::thread::hardware_concurrency(), gl_text(GL_VERSION), gl_text(GL_RENDERER), size.x, size.y,
                static_cast<double>(context.ui->look.scale));
  return facts;
}

}  // namespace limber::editor
