// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/app/editor.h"

#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <imgui.h>
#include <imgui_internal.h>

#include "editor/app/editor_parts.h"
#include "editor/app/editor_session.h"
#include "editor/app/event_dispatch.h"
#include "editor/app/poll_jobs.h"
#include "editor/context/arriving_body.h"
#include "editor/context/document_edits.h"
#include "editor/context/keep_preferences.h"
#include "editor/context/panels.h"
#include "editor/files/import.h"
#include "editor/files/project_session.h"
#include "editor/files/tour.h"
#include "editor/resample/refined_pose.h"
#include "editor/resample/results.h"
#include "editor/rig/joint_axis_fit.h"
#include "editor/screen/steady.h"
#include "editor/skin/paint_mode.h"
#include "editor/ui/asset_path.h"
#include "editor/ui/keyboard.h"
#include "editor/ui/tooltip.h"

namespace limber::editor {

namespace {

constexpr double kCameraMove = 0.18;  // duration of a camera move, s
constexpr double kLongestRest = 60;   // the editor waits at most this long for an event before it draws again, s
constexpr double kJobPulse = 0.1;     // time between frames while a job runs, s
// In one frame, the panels are drawn at most this many extra times to handle typed keys. Further keys wait for the next
// frame.
constexpr int kMostTurns = 200;
// If a widget has moved under the pointer while the panels were drawn, they are drawn again, at most this many times
// per frame.
constexpr int kMostAgain = 3;
constexpr float kTurnSeconds = 1e-5f;  // ImGui's time step in an extra draw of the panels, s: almost no time passes
constexpr double kUploadTime = 0.008;  // time limit per frame for uploading to the GPU, s: weights, images, bodies

// Returns the picture, and creates it first if it does not exist yet.
template <class Picture>
Picture& drawn(Views& views, std::unique_ptr<Picture>& picture) {
  if (!picture) picture = std::make_unique<Picture>(views.renderer);
  return *picture;
}

// Draws the picture of the body: the preview of a pose until the picture of the refined pose is complete, then that
// one.
void draw_body_picture(Views& views, const glm::ivec2& size, double now) {
  BodyView& body = views.body;
  if (!body.shows_refined) body.picture->draw(views.scene, body.camera, size, now);
  if (!views.refined_scene || (!body.shows_refined && !body.picture->complete())) return;
  drawn(views, body.refined).draw(*views.refined_scene, body.camera, size, now);
  if (body.refined->complete()) body.shows_refined = true;
}

bool is_complete(const Views& views) {
  const BodyView& body = views.body;
  const bool preview = body.shows_refined || body.picture->complete();
  const bool refined = !views.refined_scene || (body.refined && body.refined->complete());
  return preview && refined && (!body.other || body.other->complete());
}

// Draws a view's picture. If two results A and B are compared side by side, each view shows one of them. In other
// comparisons a view draws pictures of both results, one over the other.
void draw_view_picture(Views& views, const Document& document, const Layout& layout, const ViewPlace& place,
                       double now) {
  const glm::ivec2 size(place.rect.size());
  if (size.x < 1 || size.y < 1) return;
  const bool one = !place.side_a, other = views.other_scene && (place.side_a || !layout.by_sides);
  if (place.id == ViewId::Body) {
    if (one) draw_body_picture(views, size, now);
    if (other) drawn(views, views.body.other).draw(*views.other_scene, views.body.camera, size, now);
    else if (!views.other_scene) views.body.other.reset();
    return;
  }
  SliceState& slice = slice_of(views, place.id);
  if (!slice.fitted) fit(slice, tissue_box(views, document, std::nullopt), place.rect.size());
  const glm::dvec3 normal = render::frame_of(slice.camera.axis).normal;
  slice.camera.centre += normal * glm::dot(views.cross_hair - slice.camera.centre, normal);
  if (one) slice.picture->draw(drawn_scene(views), slice.camera, views.slice_display, size);
  if (other) drawn(views, slice.other).draw(*views.other_scene, slice.camera, views.slice_display, size);
  else if (!views.other_scene) slice.other.reset();
}

Layout layout_of(const Context& context, const glm::ivec2& size) {
  Layout layout = arrange(size, context.ui->look.scale, context.screen->arrangement());
  return side_by_side(context) ? in_sides(std::move(layout), context.comparison->share, context.ui->look.scale)
                               : layout;
}

bool is_complete(const SliceState& slice) {
  return slice.picture->complete() && (!slice.other || slice.other->complete());
}

void move_camera(BodyView& body, double now, bool at_once) {
  if (!body.move) return;
  const double t = at_once ? 1 : glm::clamp((now - body.move->start) / kCameraMove, 0.0, 1.0);
  body.camera = between(body.move->from, body.move->to, 1 - (1 - t) * (1 - t) * (1 - t));
  if (t >= 1) body.move.reset();
}

// Returns true if an event is a button press, a wheel step or a key press. Each of these ends a running camera move.
bool begins_something(const Event& event) {
  if (const auto* button = std::get_if<ButtonChanged>(&event)) return button->down;
  if (const auto* key = std::get_if<KeyChanged>(&event)) return key->down && key->key < Key::Ctrl;
  return std::holds_alternative<Wheeled>(event);
}

void ended(const Context& context, const char* part_of_frame) {
  if (context.timeline->frame_log) context.timeline->frame_log->part(part_of_frame);
}

// Begins another ImGui frame without input, so that the panels are drawn again before the window shows the frame.
void begin_turn_without_input(Ui& ui) {
  ImGuiIO& io = ImGui::GetIO();
  ImGui::EndFrame();
  io.DeltaTime = kTurnSeconds;
  io.MouseWheel = io.MouseWheelH = ui.input.wheel = ui.input.wheel_sideways = 0;
  ImGui::NewFrame();
}

void show_preferred(Context& context) {
  const Preferences& preferences = context.preferences;
  Views& views = *context.views;
  views.grid = preferences.grid;
  views.axes = preferences.axes;
  views.scale_bar = preferences.scale_bar;
  views.letters = preferences.letters;
  views.show_cross_hair = preferences.cross_hair;
  views.display = preferences.display == "xray"     ? render::Display::XRay
                  : preferences.display == "tissue" ? render::Display::Tissue
                                                    : render::Display::Solid;
  apply_preferences(context);
}

}  // namespace

Editor::Editor(Host& owner, const Preferences& preferred) : parts_(std::make_unique<Parts>(owner, preferred)) {
  host.refer_to(&owner);
  refer_to_parts();
  IMGUI_CHECKVERSION();
  window->imgui = ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.LogFilename = nullptr;
  io.ConfigInputTextCursorBlink = false;  // no blinking, so that an idle editor draws nothing
  io.ConfigDragClickToInputText = true;   // a click without a drag starts typing the number
  io.ClipboardUserData = &owner;
  io.GetClipboardTextFn = [](void* user) {
    static std::string text;
    text = static_cast<Host*>(user)->clipboard();
    return text.c_str();
  };
  io.SetClipboardTextFn = [](void* user, const char* text) { static_cast<Host*>(user)->set_clipboard(text); };
  teach_imgui_keys();
  ImGui_ImplOpenGL3_Init("#version 330 core");
  views.refer_to(&parts_->views.emplace());
  live.refer_to(&parts_->live.emplace([&owner] { owner.wake(); }));
  show_preferred(*this);
  apply_look(ui->look, preferences->theme, scale_for(preferences, host));
  screen->layout = arrange(host->size(), ui->look.scale, screen->arrangement());
}

Editor::~Editor() {
  preferences->arrangements = screen->arrangements;
  write_preferences(*this);
  ImGui::SetCurrentContext(window->imgui);
  background->each_frame.clear();
  pictures->clear();
  views.refer_to(nullptr);
  parts_->views.reset();
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext(window->imgui);
}

bool Editor::busy() const { return jobs->busy() || live->busy() || skin->shares.busy(); }

bool Editor::at_rest() const { return rest() > 0 && !busy() && !awaits_refined(*this); }

double Editor::rest() const {
  if (ui->time_to_next_frame() <= 0 || !host->events.empty() || views->body.move ||
      (interaction->modal && interaction->modal->moving()))
    return 0;
  if (screen->layout.place_of(ViewId::Body) && !is_complete(views)) return 0;
  for (const ViewPlace& place : screen->layout.view_places)
    if (place.id != ViewId::Body && !is_complete(views->slices[static_cast<std::size_t>(axis_of(place.id))])) return 0;
  double seconds = std::min(kLongestRest, ui->time_to_next_frame());
  if (busy()) seconds = std::min(seconds, kJobPulse);
  return std::clamp(seconds, 0.0, kLongestRest);
}

void Editor::take_input() {
  std::vector<Event> events;
  if (!ui->keyboard.waits())
    events = host->events.take_frame(ui->keyboard.typed ? KeysFor::Text : KeysFor::Commands, ui->input.modifiers());
  const InputState before = ui->input;
  ui->input.wheel = ui->input.wheel_sideways = 0;
  for (const Event& event : events) ui->input.apply(event);
  if (!events.empty()) ui->touch();
  if (std::any_of(events.begin(), events.end(), begins_something)) views->body.move.reset();
  tell_imgui(events, ui->input);
  ImGui::NewFrame();
  dispatch(*this, events, before);
}

// Handles all typed keys in one frame while a text field has the keyboard. A text field reads one group of keys each
// time the panels are drawn. So the panels are drawn here, without the views, once for each group except the last; the
// last group is read when the frame is drawn.
void Editor::read_typed_text() {
  for (int turn = 0; turn < kMostTurns && (ui->keyboard.typed || ui->keyboard.waits()) && !host->events.empty();
       ++turn) {
    screen->layout = layout_of(*this, host->size());
    draw();
    dialogs->change();
    ImGui::EndFrame();
    ImGui::GetIO().DeltaTime = kTurnSeconds;
    take_input();
  }
}

// Handles finished jobs. Their dialogs and messages wait while they would take the keyboard from a text field or appear
// under a pressed mouse button.
void Editor::meet_jobs() {
  const std::size_t errors = messages->errors.size();
  dialogs->of_users_act = false;
  open_waiting_files(*this);
  if (interaction->modal && !interaction->modal->frame(*this, ImGui::GetIO().DeltaTime)) interaction->modal.reset();
  if (poll_jobs(*this)) ui->touch();
  std::erase_if(background->each_frame, [this](const auto& act) { return !act(*this); });
  dialogs->of_users_act = true;
  const auto first = messages->errors.begin() + static_cast<std::ptrdiff_t>(std::min(errors, messages->errors.size()));
  std::move(first, messages->errors.end(), std::back_inserter(waiting_errors_));
  messages->errors.erase(first, messages->errors.end());
  if ((waiting_errors_.empty() && dialogs->waiting.empty()) || dialogs->next || !may_interrupt(*this)) return;
  if (!waiting_errors_.empty()) {
    messages->errors = std::exchange(waiting_errors_, {});
  } else {
    dialogs->open(std::move(dialogs->waiting.front()));
    dialogs->waiting.pop_front();
  }
  ui->touch();
}

void Editor::draw_views() {
  update_scene(*views, document(), selection, preferences->theme == "dark");
  views->scene.line_scale = ui->look.scale;
  live->follow(*this);
  show_posed(*this);
  show_weights(*this);
  show_fem(*this);
  show_difference(*this);
  show_overlap(*this);
  show_bone_table(*this);
  show_proposed_joint(*this);
  show_refined(*this);
  move_camera(views->body, ui->now, preferences->reduce_motion);
  ended(*this, "pose");
  const Document shown = shown_document(*this);
  views->renderer.begin_frame(kUploadTime);
  if (views->arriving->upload(views->renderer)) ui->touch();
  for (const ViewPlace& place : screen->layout.view_places) {
    draw_view_picture(*views, shown, screen->layout, place, ui->now);
    ended(*this, place.id == ViewId::Body ? "body" : "slice");
  }
  hover_views(*this);
  follow_brush(*this);
  ended(*this, "hover");
}

void Editor::draw() {
  ui->widgets.begin_frame();
  window->cursor = Cursor::Arrow;
  ui->place.windows.clear();
  ui->window = screen->layout.window;
  ui->tooltip_delay = preferences->tooltip_delay;
  ui->dialog_open = dialogs->shown || !messages->errors.empty();
  draw_top_bar(*this);
  draw_tool_header(*this);
  draw_views_region(*this);
  draw_tool_strip(*this);
  draw_bottom(*this);
  draw_status_bar(*this);
  draw_sidebar(*this);
  draw_splitters(*this);
  draw_start_screen(*this);
  draw_tour(*this);
  draw_toasts(*this);
  if (dialogs->shown && messages->errors.empty()) dialogs->shown->draw(*this);
  draw_error_message(*this);
  draw_tooltip(ui);
  ui->widgets.end_frame();
  follow_keyboard(ui);
  if (interaction->modal && interaction->modal->hides_pointer()) window->cursor = Cursor::Hidden;
  host->set_cursor(ImGui::GetIO().WantTextInput ? Cursor::Text : window->cursor);
  // Moves the ImGui windows of the regions behind popups and dialogs. The regions' windows keep the order in which they
  // were drawn.
  for (auto name = ui->place.windows.rbegin(); name != ui->place.windows.rend(); ++name)
    ImGui::BringWindowToDisplayBack(ImGui::FindWindowByName(name->c_str()));
}

void Editor::frame(double time) {
  ImGui::SetCurrentContext(window->imgui);
  ImGuiIO& io = ImGui::GetIO();
  io.DeltaTime = static_cast<float>(glm::clamp(time - ui->now, 1e-4, 0.25));
  ui->begin_frame(time);

  const glm::ivec2 size = host->size();
  if (size.x < 1 || size.y < 1) return;  // the window is minimized
  if (glm::vec2(size) != screen->layout.window.size()) ui->touch();
  if (apply_look_if_changed(*this)) ui->touch();
  io.DisplaySize = {static_cast<float>(size.x), static_cast<float>(size.y)};
  screen->layout = layout_of(*this, size);
  ImGui_ImplOpenGL3_NewFrame();
  const bool pressed = ui->input.down(MouseButton::Left) || ui->input.down(MouseButton::Right);
  take_input();
  read_typed_text();
  // A press or release of a button acts on what the user saw at that moment. It is therefore handled before a finished
  // job changes the panels.
  if (pressed != (ui->input.down(MouseButton::Left) || ui->input.down(MouseButton::Right))) {
    draw();
    note_pressed(*this);
    dialogs->change();
    begin_turn_without_input(ui);
  }
  ended(*this, "input");
  meet_jobs();
  ended(*this, "jobs");
  screen->layout = layout_of(*this, size);
  advance_time(*this);
  ended(*this, "time");
  draw_views();
  draw();
  for (int again = 0; again < kMostAgain && has_moved_under_pointer(*this); ++again) {
    begin_turn_without_input(ui);
    draw();
  }
  ended(*this, "panels");
  await_next_frame(*this);
  follow_tour(*this);
  keep_edits(*this);
  keep_recent_files(*this);
  ended(*this, "keeping");
  dialogs->change();

  if (const std::string title = project->name.empty() ? "Limber" : project->name + " - Limber"; title != shown_title_)
    host->set_title(shown_title_ = title);

  ImGui::Render();
  host->present([this, size] {
    ImGui::SetCurrentContext(window->imgui);
    glViewport(0, 0, size.x, size.y);
    const ImVec4 gap = ImGui::ColorConvertU32ToFloat4(ui->look.theme.void_);
    glClearColor(gap.x, gap.y, gap.z, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  });
  ended(*this, "window");
}

}  // namespace limber::editor
