// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/app/script_player.h"

#include <charconv>
#include <chrono>
#include <thread>

#include "core/base/error.h"
#include "editor/context/frame_timing.h"
#include "editor/motion/timeline.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

// A drag is divided into this many moves of the pointer, so that it resembles a slow hand.
constexpr int kDragSteps = 8;
constexpr double kLongestJob = 300;  // a job that takes longer stops the script with an error, s
// A script that needs more frames until the editor is idle stops with an error.
constexpr int kLongestSettling = 20'000;

// A drag in a script that is longer than this, or a position beyond this, is an error, pixels.
constexpr double kFarthestMove = 20'000;
constexpr double kLargestWindow = 16'384;  // a larger width or height of the window is an error in the script, pixels
constexpr double kMostSteps = 1000;        // more steps of the wheel in one command are an error in the script
constexpr double kLongestWait = 3600;      // a longer `wait` is an error in the script, s

double number(const std::string& word, double least = -kFarthestMove, double most = kFarthestMove) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !(value >= least && value <= most)) {
    char range[80];
    std::snprintf(range, sizeof range, "write a number from %g to %g", least, most);
    throw Error("a number is expected", "'" + word + "'", range);
  }
  return value;
}

std::optional<Key> modifier(const std::string& word) {
  const auto key = key_from_name(word);
  return key && (*key == Key::Ctrl || *key == Key::Shift || *key == Key::Alt) ? key : std::nullopt;
}

std::optional<MouseButton> mouse_button(const std::string& word) {
  const auto chord = chord_from_text(word);
  return chord && chord->kind == Chord::Kind::Press && chord->modifiers == Modifiers{} ? std::optional(chord->button)
                                                                                       : std::nullopt;
}

void need(const std::vector<std::string>& words, std::size_t count) {
  if (words.size() < count)
    throw Error("the command lacks an argument", "after '" + words.back() + "'", "complete the line");
}

std::u32string characters_of(const std::string& utf8) {
  std::u32string characters;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto lead = static_cast<unsigned char>(utf8[i]);
    const int more = lead < 0x80 ? 0 : lead < 0xE0 ? 1 : lead < 0xF0 ? 2 : 3;
    char32_t character = more == 0 ? lead : lead & (0x3F >> more);
    for (int k = 1; k <= more && i + k < utf8.size(); ++k)
      character = character << 6 | (static_cast<unsigned char>(utf8[i + k]) & 0x3F);
    characters.push_back(character);
    i += more + 1;
  }
  return characters;
}

}  // namespace

std::vector<ScriptLine> parse_script(const std::string& text) {
  std::vector<ScriptLine> script;
  ScriptLine line{1, {}};
  std::string word;
  bool quoted = false, any = false, comment = false;
  const auto end_word = [&] {
    if (any) line.words.push_back(word);
    word.clear();
    any = false;
  };
  for (const char c : text + "\n") {
    if (c == '\n') {
      if (quoted)
        throw Error("a quote has no end", "line " + std::to_string(line.number), "close the quote on the same line");
      end_word();
      if (!line.words.empty()) script.push_back(line);
      line = {line.number + 1, {}};
      comment = false;
    } else if (comment) {
    } else if (c == '"') {
      quoted = !quoted;
      any = true;
    } else if (!quoted && (c == ' ' || c == '\t' || c == '\r')) {
      end_word();
    } else if (!quoted && c == '#' && !any) {
      comment = true;
    } else {
      word += c;
      any = true;
    }
  }
  return script;
}

Player::Player(Editor& editor, Offscreen& host) : editor_(editor), host_(host) {
  editor.timeline->frame_log = std::make_unique<FrameLog>();
}

void Player::frame() {
  editor_.timeline->frame_log->begin();
  editor_.frame(now_);
  editor_.timeline->frame_log->end(doing_);
}

void Player::step() {
  now_ += kStep;
  frame();
}

void Player::play(const std::vector<ScriptLine>& script, const Path& folder) {
  settle();
  for (const ScriptLine& line : script) {
    doing_ = "line " + std::to_string(line.number) + ":";
    for (const std::string& word : line.words) doing_ += " " + word;
    try {
      play_line(line, folder);
    } catch (const Error& error) {
      throw Error("the script stops at line " + std::to_string(line.number), line.words[0], error.what());
    }
  }
}

void Player::settle() {
  do step();
  while (!host_.events.empty());
  for (int i = 0; i < 3; ++i) step();
}

void Player::hold(const std::vector<std::string>& words, std::size_t first, bool down) {
  for (std::size_t i = first; i < words.size(); ++i)
    if (const auto key = modifier(words[i])) host_.events.push(KeyChanged{*key, down});
}

glm::vec2 Player::place_of(const std::string& name) {
  const Widget* widget = editor_.ui->widgets.find(name);
  // The rows of a menu exist only while the menu is open, so this opens the menu first.
  if (const auto slash = name.rfind('/'); !widget && slash != std::string::npos) {
    const std::string parent = name.substr(0, slash);
    host_.events.push(PointerMoved{place_of(parent)});
    settle();
    widget = editor_.ui->widgets.find(name);
    if (!widget) {
      click(parent, MouseButton::Left, 1);
      widget = editor_.ui->widgets.find(name);
    }
  }
  if (!widget) throw Error("no widget has this name", name, "compare the name with the widgets that are shown");
  return widget->rect.centre();
}

void Player::click(const std::string& name, MouseButton button, int times) {
  host_.events.push(PointerMoved{place_of(name)});
  settle();
  for (int i = 0; i < times; ++i) {
    host_.events.push(ButtonChanged{button, true});
    host_.events.push(ButtonChanged{button, false});
  }
  settle();
}

void Player::wait_for_jobs() {
  const auto start = std::chrono::steady_clock::now();
  do {
    while (editor_.busy()) {
      frame();  // the script's clock does not advance, so the result does not depend on the job's duration
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      if (std::chrono::steady_clock::now() - start > std::chrono::duration<double>(kLongestJob))
        throw Error("the job did not end in time", "wait-job", "find out why the job takes so long, or wait longer");
    }
    settle();  // a finished job may start another job
  } while (editor_.busy());
}

void Player::wait_until_idle() {
  if (editor_.timeline->play.on)
    throw Error("the editor is never idle while a clip plays", "wait-idle", "stop the clip first, or use 'wait'");
  wait_for_jobs();
  for (int i = 0; i < kLongestSettling; ++i) {
    if (editor_.at_rest()) return;
    if (editor_.rest() > 0) wait_for_jobs();
    else step();
  }
  throw Error("the editor does not become idle", "wait-idle", "find out what the editor keeps drawing");
}

void Player::expect(const std::vector<std::string>& words) {
  need(words, 2);
  const std::string found = fact(editor_, words[1]);
  const std::string wanted = words.size() > 2 ? words[2] : "shown";
  if (found != wanted)
    throw Error("expected " + words[1] + " '" + wanted + "'", "it is '" + found + "'",
                "correct the script or the editor");
}

void Player::play_line(const ScriptLine& line, const Path& folder) {
  const std::vector<std::string>& words = line.words;
  const std::string& command = words[0];
  const auto file_of = [&](const std::string& word) { return Path(word).is_absolute() ? Path(word) : folder / word; };
  if (command == "click" || command == "double-click" || command == "right-click") {
    need(words, 2);
    hold(words, 2, true);
    click(words[1], command == "right-click" ? MouseButton::Right : MouseButton::Left,
          command == "double-click" ? 2 : 1);
    hold(words, 2, false);
    settle();
  } else if (command == "press") {
    if (words.size() > 1) host_.events.push(PointerMoved{place_of(words[1])});
    settle();
    host_.events.push(ButtonChanged{MouseButton::Left, true});
    settle();
  } else if (command == "release") {
    host_.events.push(ButtonChanged{MouseButton::Left, false});
    settle();
  } else if (command == "drag") {
    need(words, 4);
    const glm::vec2 from = place_of(words[1]),
                    by = glm::vec2(number(words[2]), number(words[3])) * editor_.ui->look.scale;
    MouseButton button = MouseButton::Left;
    for (std::size_t i = 4; i < words.size(); ++i) button = mouse_button(words[i]).value_or(button);
    host_.events.push(PointerMoved{from});
    hold(words, 4, true);
    settle();
    host_.events.push(ButtonChanged{button, true});
    const glm::vec2 shifted = host_.shifted();
    for (int i = 1; i <= kDragSteps; ++i) {
      host_.events.push(PointerMoved{from + by * (static_cast<float>(i) / kDragSteps) + host_.shifted() - shifted});
      step();
    }
    host_.events.push(ButtonChanged{button, false});
    hold(words, 4, false);
    settle();
  } else if (command == "wheel") {
    need(words, 3);
    host_.events.push(PointerMoved{place_of(words[1])});
    hold(words, 3, true);
    settle();
    const int steps = static_cast<int>(number(words[2], -kMostSteps, kMostSteps));
    for (int i = 0; i < std::abs(steps); ++i) {
      host_.events.push(Wheeled{steps > 0 ? 1.0f : -1.0f});
      step();
    }
    hold(words, 3, false);
    settle();
  } else if (command == "move") {
    need(words, 2);
    host_.events.push(PointerMoved{words.size() > 2
                                       ? glm::vec2(number(words[1]), number(words[2])) * editor_.ui->look.scale
                                       : place_of(words[1])});
    settle();
  } else if (command == "key") {
    need(words, 2);
    const auto chord = chord_from_text(words[1]);
    if (!chord || chord->kind != Chord::Kind::Key)
      throw Error("the key is unknown", words[1], "write it like Ctrl+Shift+Z");
    const std::vector<std::string> caps = key_caps(*chord);
    hold(caps, 0, true);
    host_.events.push(KeyChanged{chord->key, true});
    host_.events.push(KeyChanged{chord->key, false});
    hold(caps, 0, false);
    settle();
  } else if (command == "key-down" || command == "key-up") {
    need(words, 2);
    const auto key = key_from_name(words[1]);
    if (!key) throw Error("the key is unknown", words[1], "write one key, like W or Shift");
    host_.events.push(KeyChanged{*key, command == "key-down"});
    settle();
  } else if (command == "type") {
    need(words, 2);
    for (const char32_t character : characters_of(words[1])) host_.events.push(TextTyped{character});
    settle();
  } else if (command == "drop") {
    need(words, 2);
    host_.events.push(FilesDropped{{file_of(words[1])}});
    settle();
  } else if (command == "resize") {
    need(words, 3);
    host_.resize(
        {static_cast<int>(number(words[1], 1, kLargestWindow)), static_cast<int>(number(words[2], 1, kLargestWindow))});
    settle();
  } else if (command == "wait") {
    need(words, 2);
    for (const double end = now_ + number(words[1], 0, kLongestWait); now_ < end;) step();
  } else if (command == "wait-job") {
    wait_for_jobs();
  } else if (command == "wait-idle") {
    wait_until_idle();
  } else if (command == "expect") {
    expect(words);
  } else if (command == "shot" || command == "shot-now") {
    need(words, 2);
    if (command == "shot" && !editor_.timeline->play.on) wait_until_idle();
    render::write_png(host_.picture(), file_of(words[1]));
  } else if (command == "frame-log") {
    need(words, 2);
    write_file_atomically(file_of(words[1]), editor_.timeline->frame_log->text());
    editor_.timeline->frame_log->clear();
  } else {
    throw Error("the command is unknown", command, "use a command listed at the top of editor/app/script_player.h");
  }
}

}  // namespace limber::editor
