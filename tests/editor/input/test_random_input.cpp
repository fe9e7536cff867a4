// SPDX-License-Identifier: AGPL-3.0-or-later
// Sends random keys, text, clicks and drags while jobs end and messages and dialogs appear. The environment variables
// LIMBER_RANDOM_SEED and LIMBER_RANDOM_EVENTS set the seed and the number of events. The same seed gives the same
// events.
#include <cstdlib>
#include <random>

#include "editor/context/dialogs.h"
#include "editor/context/interaction.h"
#include "editor/context/outliner_state.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/ui/ui.h"
#include "tests/editor/keyboard.h"
#include "tests/editor/small_limb.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

std::uint64_t number_from(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

class MessageDialog final : public Dialog {
 public:
  void draw(Context&) override {}
};

class RandomUser {
 public:
  explicit RandomUser(std::uint64_t seed) : test_({860, 640}, small()), random_(seed) {
    document_ = test_.editor->document();
    auto volume = std::make_shared<LabelVolume>(*document_.volume);
    volume->voxels.assign(volume->voxels.size(), 0);
    volume->at({12, 10, 15}) = 111;
    document_.volume = volume;
    test_.editor->preferences->reduce_motion = true;
    begin_again();
  }

  void act() {
    begin_again();
    const int what = upto(6);
    INFO("act ", what);
    switch (what) {
      case 0: return rename();
      case 1: return search();
      case 2: return type_number();
      case 3: return hold_widget();
      case 4: return press_command();
      case 5: return drag_view();
      default: return do_anything();
    }
  }
  int events() const { return events_; }
  int numbers() const { return numbers_; }  // number fields that were clicked

 private:
  static Preferences small() {
    Preferences preferences;
    preferences.scale = 0.75;
    return preferences;
  }
  Editor& editor() { return *test_.editor; }
  int upto(int last) { return static_cast<int>(random_() % static_cast<std::uint64_t>(last + 1)); }
  bool now_and_then() { return upto(2) == 0; }

  // Presses Escape until no dialog, menu, message, tool or field is open.
  void put_away() {
    const auto open = [this] {
      return editor().dialogs->shown || !editor().messages->errors.empty() || editor().interaction->modal ||
             editor().ui->keyboard.typed || menu_is_open();
    };
    test_.player.settle();
    // Escape is pressed at least twice, because open() does not notice lists of choices.
    for (int i = 0; i < 200 && (i < 2 || open()); ++i) {
      press_key(*test_.host, Key::Escape);
      test_.player.settle();
    }
    REQUIRE_FALSE(open());
  }

  // Shows the limb in the Rig workspace, with nothing open and nothing pending.
  void begin_again() {
    Context& c = editor();
    put_away();
    c.messages->toasts.clear();
    c.history->reset(document_, "Open limb");
    c.screen->workspace = Workspace::Rig;
    c.screen->arrangements = default_arrangements();
    c.screen->arrangement().sidebar = true;
    c.ui->open_sections = {{"Steps", true}};
    *c.outliner = {};
    *c.selection = {};
    c.selection->bone = 1;
    c.selection->bones = {1};
    c.ui->list_focus = {};
    c.ui->renaming.reset();
    c.interaction->tool = Tool::Select;
    test_.host->events.push(PointerMoved{c.screen->layout.views.centre()});
    put_away();
  }

  // Randomly makes something happen that the user did not cause.
  void let_something_happen() {
    if (!now_and_then()) return;
    Context& c = editor();
    const std::string words =
        "Message " + std::to_string(upto(30)) +
        (now_and_then()
             ? " that is so long that it takes two lines of its box, or even three of them where they are narrow"
             : "");
    switch (upto(6)) {
      case 0: return c.messages->ok(words, now_and_then() ? words : "");
      case 1: return c.messages->toast_error(words);
      case 2: return at_end_of_job([](Context& c) { c.messages->show_error("it failed: here: try again"); });
      case 3: return at_end_of_job([](Context& c) { c.dialogs->open(std::make_unique<MessageDialog>()); });
      case 4: return at_end_of_job([words](Context& c) { c.messages->info(words, words); });
      case 5:
        if (held_.find("/Steps/") != std::string::npos) return;
        return at_end_of_job([](Context& c) { c.ui->open_sections["Steps"] = !c.ui->open_sections["Steps"]; });
      default: return at_end_of_job([words](Context& c) { c.messages->warn(words); });
    }
  }
  // Starts a job that ends before the next frame. Time stands still until then.
  void at_end_of_job(Finish finish) {
    pending_ = true;
    start_task(editor(), "", [this, finish](Progress&) -> Finish {
      return [this, finish](Context& c) {
        finish(c);
        pending_ = false;
      };
    });
  }

  bool menu_is_open() {
    const auto& widgets = editor().ui->widgets.widgets();
    return std::any_of(widgets.begin(), widgets.end(),
                       [](const Widget& widget) { return widget.region == Region::Popup; });
  }
  void push(Event event) {
    test_.host->events.push(std::move(event));
    ++events_;
  }
  void key(Key key) {
    push(KeyChanged{key, true});
    push(KeyChanged{key, false});
  }
  void letter(char c) {
    push(KeyChanged{key_of(c), true});
    push(TextTyped{static_cast<char32_t>(c)});
    push(KeyChanged{key_of(c), false});
  }
  void step() {
    test_.player.step();
    for (int i = 0; pending_ && i < 100'000; ++i) editor().frame(test_.player.now());
    REQUIRE_FALSE(pending_);
  }
  void settle() {
    do step();
    while (!test_.host->events.empty());
    for (int i = 0; i < 3; ++i) step();
  }
  // Returns a number that changes when a command runs, and when a tool starts or ends.
  std::size_t commands() {
    std::size_t count = editor().history->position();
    for (const auto& [id, times] : editor().preferences->command_counts)
      count += id == "edit.rename" ? 0 : static_cast<std::size_t>(times);  // F2 does not count
    return count + 1000 * static_cast<std::size_t>(editor().interaction->modal != nullptr);
  }
  // Types letters and Backspaces in bursts, with events between the frames. Returns the text that the field must hold.
  std::string type(const std::string& letters, std::size_t commands_before) {
    std::string text;
    const int bursts = 1 + upto(3);
    for (int burst = 0; burst < bursts; ++burst) {
      for (int i = upto(9); i >= 0; --i) {
        if (upto(5) == 0) {
          key(Key::Backspace);
          if (!text.empty()) text.pop_back();
        } else {
          text += letters[static_cast<std::size_t>(upto(static_cast<int>(letters.size()) - 1))];
          letter(text.back());
        }
      }
      let_something_happen();
      if (now_and_then()) {
        step();
        CHECK(commands() == commands_before);
      }
    }
    settle();
    CHECK(commands() == commands_before);
    INFO("dialog ", test_.fact("dialog"), ", error ", test_.fact("error"), ", menu ", menu_is_open());
    CHECK(test_.fact("typed") == text);
    return text;
  }

  void rename();
  void search();
  void type_number();
  void hold_widget();
  void press_command();
  void drag_view();
  void do_anything();

  LimbEditor test_;
  Document document_;
  std::mt19937_64 random_;
  int events_ = 0, numbers_ = 0;
  bool pending_ = false;
  std::string held_;  // name of the widget that is pressed
};

constexpr char kLetters[] = "abcdefghijklmnopqrstuvwxyz 0123456789";

// ---- The actions of the random user

void RandomUser::rename() {
  const std::size_t before = commands();
  const Widget* row = editor().ui->widgets.find("Outliner/bone Fore/name");
  REQUIRE(row);
  push(PointerMoved{row->rect.centre()});
  push(ButtonChanged{MouseButton::Left, true});
  push(ButtonChanged{MouseButton::Left, false});
  key(Key::F2);
  CHECK(commands() == before);
  // F2 renames the row and must not run any command.
  std::string text = type(kLetters, before);
  text += "q";
  letter('q');
  let_something_happen();
  key(Key::Return);
  const bool sidebar = editor().screen->arrangement().sidebar.value();
  letter('n');  // shows or hides the sidebar
  settle();
  CHECK(editor().document().armature->bones.size() == 2);
  CHECK(editor().document().armature->bones[1].name == text);
  // If a dialog has waited for the name to be entered, it opens first and takes the key.
  if (!editor().dialogs->shown && editor().messages->errors.empty())
    CHECK(editor().screen->arrangement().sidebar.value() != sidebar);
}

void RandomUser::search() {
  key(Key::F3);
  const std::size_t before = commands();
  type(kLetters, before);
  key(Key::Escape);
  settle();
  CHECK(commands() == before);
}

void RandomUser::type_number() {
  const Widget* field = editor().ui->widgets.find("Bone/Length");
  if (!field) return;  // scrolled out of view
  ++numbers_;
  push(PointerMoved{field->rect.centre()});
  push(ButtonChanged{MouseButton::Left, true});
  push(ButtonChanged{MouseButton::Left, false});
  const std::size_t before = commands();
  std::string text = type("0123456789", before) + "7";
  letter('7');
  let_something_happen();
  if (text.size() > 4) return;
  key(Key::Return);
  settle();
  const Bone& bone = editor().document().armature->bones[1];
  CHECK(glm::distance(bone.head, bone.tail) == doctest::Approx(std::stod(text)));
}

void RandomUser::hold_widget() {
  for (int i = upto(4); i > 0; --i) editor().messages->toast_error("Failed " + std::to_string(i));
  settle();
  std::vector<Widget> all;
  for (const Widget& widget : editor().ui->widgets.widgets())
    if (widget.enabled && !widget.name.ends_with("/view") && widget.rect.contains(glm::floor(widget.rect.centre())))
      all.push_back(widget);
  const Widget held = all[static_cast<std::size_t>(upto(static_cast<int>(all.size()) - 1))];
  push(PointerMoved{glm::floor(held.rect.centre())});
  settle();
  const auto place = [&]() -> std::optional<Rect> {
    for (const Widget& widget : editor().ui->widgets.widgets())
      if (widget.name == held.name) return widget.rect;
    return std::nullopt;
  };
  const auto before = place();
  held_ = held.name;
  push(ButtonChanged{MouseButton::Left, true});
  for (int i = 2 + upto(4); i > 0; --i) {
    let_something_happen();
    step();
    INFO(held.name);
    const auto now = place();
    CHECK(now.has_value() == before.has_value());
    if (now && before) {
      const auto text = [](const Rect& r) {
        return std::to_string(r.low.x) + " " + std::to_string(r.low.y) + " " + std::to_string(r.high.x) + " " +
               std::to_string(r.high.y);
      };
      CHECK(text(*now) == text(*before));
    }
  }
  held_.clear();
  push(PointerMoved{glm::vec2(3, 3)});
  push(ButtonChanged{MouseButton::Left, false});
  settle();
}

void RandomUser::press_command() {
  const bool strip = editor().screen->arrangement().tool_strip;
  let_something_happen();
  const bool calm = !pending_;
  letter('t');
  settle();
  if (calm) CHECK(editor().screen->arrangement().tool_strip != strip);
}

void RandomUser::drag_view() {
  const auto before = editor().views->body.camera;
  push(PointerMoved{editor().screen->layout.views.centre()});
  push(ButtonChanged{MouseButton::Middle, true});
  step();
  for (int i = 1; i < 4; ++i) {
    push(PointerMoved{editor().screen->layout.views.centre() + glm::vec2(11 * i, 7 * i)});
    let_something_happen();
    step();
  }
  CHECK(!(editor().views->body.camera == before));
  CHECK(!editor().dialogs->shown);
  CHECK(editor().messages->errors.empty());
  push(ButtonChanged{MouseButton::Middle, false});
  settle();
}

// Sends random events anywhere. A field that has the keyboard must keep it.
void RandomUser::do_anything() {
  constexpr Key kKeys[] = {Key::G,    Key::R,    Key::S,         Key::X,      Key::Y,  Key::A,  Key::Tab,  Key::Up,
                           Key::Down, Key::Left, Key::Backspace, Key::Delete, Key::F2, Key::F3, Key::Num1, Key::Home};
  for (int i = 5 + upto(20); i > 0; --i) {
    const bool field = editor().ui->keyboard.typed && test_.host->events.empty();
    const std::size_t before = commands();
    bool letters = false;
    switch (upto(5)) {
      case 0: push(PointerMoved{glm::vec2(upto(860), upto(640))}); break;
      case 1:
        push(ButtonChanged{MouseButton::Left, true});
        push(ButtonChanged{MouseButton::Left, false});
        break;
      case 2: push(Wheeled{now_and_then() ? 1.0f : -1.0f}); break;
      case 3: key(kKeys[upto(static_cast<int>(std::size(kKeys)) - 1)]); break;
      default: letters = true; letter(kLetters[upto(35)]);
    }
    let_something_happen();
    if (field && letters) {
      settle();
      CHECK(commands() == before);
      CHECK(editor().ui->keyboard.typed);
    } else {
      step();
    }
  }
  settle();
}

}  // namespace

TEST_CASE(
    "random input: no letter of a field is a command, nothing moves under a pressed button, each key reaches what has "
    "it") {
  const std::uint64_t seed = number_from("LIMBER_RANDOM_SEED", 1), wanted = number_from("LIMBER_RANDOM_EVENTS", 1500);
  RandomUser user(seed);
  while (user.events() < static_cast<int>(wanted)) {
    INFO("seed ", seed, ", event ", user.events());
    user.act();
  }
  CHECK(user.numbers() > 0);
}
