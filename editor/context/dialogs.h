// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <deque>
#include <memory>
#include <optional>

namespace limber::editor {

struct Chord;
struct Context;
struct Ui;

// A dialog in the middle of the window. It blocks everything else; only one dialog is open at a time.
class Dialog {
 public:
  virtual ~Dialog() = default;
  virtual void draw(Context& context) = 0;  // calls begin_dialog() and end_dialog() of dialog.h
  virtual void escape(Context& context);    // closes the dialog; called when the user presses Escape
  // Handles a pressed key before a text field of the dialog gets it. Returns true if the dialog used the key.
  virtual bool key(Context&, const Chord&) { return false; }
};

struct Dialogs {
  explicit Dialogs(Ui& ui) : ui(ui) {}

  // Opens a dialog in the next frame and closes the dialog that is open. A dialog that opens without an action of the
  // user's, such as at the end of a job, waits until it does not interrupt the user.
  void open(std::unique_ptr<Dialog> dialog);
  void close();
  void change();  // shows the dialog that was opened, or none after close(); called once in a frame

  std::unique_ptr<Dialog> shown;                // the open dialog; null: no dialog is open
  std::optional<std::unique_ptr<Dialog>> next;  // the dialog that change() will show; no value: `shown` stays
  std::deque<std::unique_ptr<Dialog>> waiting;  // dialogs that no action of the user's opened
  bool of_users_act = true;                     // true: what happens now was caused by an action of the user's
  Ui& ui;
};

}  // namespace limber::editor
