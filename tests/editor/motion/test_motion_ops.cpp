// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests each operator of the timeline and of clips.
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/screen.h"
#include "editor/motion/motion_path_overlay.h"
#include "editor/pose/pose_edits.h"
#include "tests/editor/operator_proofs.h"
#include "tests/editor/small_clip.h"

namespace limber::test {

using namespace editor;

namespace {

// Opens the limb with its clip at a frame, in the Pose workspace.
std::function<void(Stage&)> stand_at(int frame) {
  return [frame](Stage& s) {
    s.editor().timeline->play = {};
    s.editor().history->reset(bending_limb(), "Open limb");
    s.play("key Ctrl+3\n move \"3D view/view\"\n wait-idle");
    go_to_frame(s.editor(), frame);
    s.play("wait-idle");
  };
}

// Does what stand_at() does, and moves the pointer to the timeline.
std::function<void(Stage&)> point_at(int frame) {
  return [frame](Stage& s) {
    stand_at(frame)(s);
    s.play("move lane\n wait-idle");
  };
}

// Does what stand_at() does at frame 20, and gives the two bones the names `upper` and `fore`.
std::function<void(Stage&)> stand_with_names(const std::string& upper, const std::string& fore) {
  return [=](Stage& s) {
    stand_at(20)(s);
    Document document = s.document();
    Armature rig = *document.armature;
    rig.bones[0].name = upper, rig.bones[1].name = fore;
    document.armature = std::make_shared<const Armature>(rig);
    Clip clip = *document.clips[0];
    clip.motion = std::make_shared<const Motion>(bending_motion(rig));
    document.clips[0] = std::make_shared<const Clip>(clip);
    s.editor().history->reset(std::move(document), "Open limb");
    s.play("wait-idle");
  };
}

std::function<void(Stage&)> with_keys(int frame, std::vector<int> at) {
  return [=](Stage& s) {
    point_at(0)(s);
    for (int key : at) {
      go_to_frame(s.editor(), key);
      run(s.editor(), "motion.insert_key");
    }
    go_to_frame(s.editor(), frame);
    s.play("wait-idle");
  };
}

std::function<bool(Stage&, const Seen&)> frame_is(int frame) {
  return [frame](Stage& s, const Seen&) {
    return s.document().frame == frame && std::abs(bend_of(pose_of(s.document())) - frame) < 1e-6;
  };
}
std::function<bool(Stage&, const Seen&)> keys_are(const std::set<int>& frames) {
  return [frames](Stage& s, const Seen&) { return frames_of(shown_clip(s.editor().document())->keys) == frames; };
}
std::function<bool(Stage&, const Seen&)> plays(int direction) {
  return [direction](Stage& s, const Seen&) {
    return s.editor().timeline->play.on && s.editor().timeline->play.direction == direction;
  };
}

std::function<bool(Stage&, const Seen&)> edit_is(const char* label) {
  return [=](Stage& s, const Seen& b) {
    return s.is("edit", label) && static_cast<int>(s.editor().history->position()) == b.position + 1;
  };
}
std::function<void(Stage&)> edited(int frame, const std::function<void(Clip&)>& edit) {
  return [=](Stage& s) {
    point_at(frame)(s);
    edit_clip(s.editor(), "Make ready", PoseThen::FromClip, edit);
    s.play("wait-idle");
  };
}
// Sets keys at frames 10 and 30, and selects those at the frames `chosen`.
std::function<void(Stage&)> with_chosen(std::set<int> chosen) {
  return [=](Stage& s) {
    with_keys(0, {10, 30})(s);
    s.editor().timeline->chosen = chosen;
    s.play("move keys\n wait-idle");
  };
}
std::function<bool(Stage&, const Seen&)> chosen_are(const std::set<int>& frames) {
  return [=](Stage& s, const Seen&) { return s.editor().timeline->chosen == frames; };
}
std::function<bool(Stage&, const Seen&)> settings_are(const std::function<bool(const RetargetSettings&)>& are) {
  return [=](Stage& s, const Seen&) {
    return shown_clip(s.editor().document()) && are(shown_clip(s.editor().document())->retarget);
  };
}
bool maps(Stage& s, const char* bone, const char* joint) {
  return shown_clip(s.editor().document())->map.joint_of(bone) == joint;
}

std::function<bool(Stage&, const Seen&)> rest_is(RestStance RestStances::*whose, RestStance which) {
  return [=](Stage& s, const Seen&) { return shown_clip(s.editor().document())->map.stances.*whose == which; };
}

}  // namespace

std::vector<Proof> proofs_of_motion() {
  const auto range_is = [](int low, int high) {
    return [=](Stage& s, const Seen&) {
      return shown_clip(s.editor().document())->range_start == low &&
             shown_clip(s.editor().document())->range_end == high;
    };
  };
  const auto speed_is = [](double speed) {
    return [=](Stage& s, const Seen&) { return s.editor().timeline->play.speed == speed; };
  };
  const auto ends_by = [](AtEnd mode) {
    return [=](Stage& s, const Seen&) { return s.editor().timeline->play.at_end == mode; };
  };
  return {
      {"motion.frame_forward", "key Right", frame_is(21), Shows::InBody, "", stand_at(20)},
      {"motion.frame_back", "key Left", frame_is(19), Shows::InBody, "", stand_at(20)},
      {"motion.frame_step", "wheel lane -1 Alt", frame_is(21), Shows::InBody, "", point_at(20)},
      {"motion.first", "key Shift+Left", frame_is(0), Shows::InBody, "", stand_at(20)},
      {"motion.last", "key Shift+Right", frame_is(60), Shows::InBody, "", stand_at(20)},
      {"motion.scrub", "drag ruler 40 0",
       [](Stage& s, const Seen& b) { return s.document().frame != b.document.frame && s.document().frame > 20; },
       Shows::InBody, "", point_at(0)},
      {"motion.play", "key Space\n wait 0.3", plays(1), Shows::InBody, "", stand_at(0)},
      {"motion.play_reverse", "key Shift+Ctrl+Space\n wait 0.3", plays(-1), Shows::InBody, "", stand_at(30)},
      {"motion.next_key", "key Up", frame_is(30), Shows::InBody, "", with_keys(20, {10, 30})},
      {"motion.previous_key", "key Down", frame_is(10), Shows::InBody, "", with_keys(20, {10, 30})},
      {"motion.insert_key", "key I", keys_are({20}), Shows::Nothing, "", stand_at(20)},
      {"motion.delete_key", "key Alt+I", keys_are({30}), Shows::Nothing, "", with_keys(10, {10, 30})},
      {"motion.auto_key", "click timeline/motion.auto_key",
       [](Stage& s, const Seen&) { return s.editor().timeline->auto_key; }, Shows::Nothing, "", stand_at(0)},
      {"motion.marker", "key M",
       [](Stage& s, const Seen&) {
         return shown_clip(s.editor().document())->markers == std::vector<Marker>{{20, "F 20"}};
       },
       Shows::Nothing, "",
       [](Stage& s) {
         s.editor().timeline->auto_key = false;
         point_at(20)(s);
       }},
      {"motion.set_start", "key Ctrl+Home", range_is(20, 60), Shows::Nothing, "", point_at(20)},
      {"motion.set_end", "key Ctrl+End", range_is(0, 20), Shows::Nothing, "", point_at(20)},
      {"motion.loop", "key Shift+L", ends_by(AtEnd::Stop), Shows::Nothing, "", point_at(0)},
      {"motion.ping_pong", "click Motion/Playing/Ping-pong", ends_by(AtEnd::PingPong), Shows::Nothing, "", point_at(0)},
      {"motion.faster", "key +", speed_is(2), Shows::Nothing, "", point_at(0)},
      {"motion.slower", "key -", speed_is(0.5), Shows::Nothing, "", point_at(0)},
      {"motion.play_at_file_rate", "key Shift+Space", speed_is(1), Shows::Nothing, "key +", point_at(0)},
      {"motion.show_seconds", "key Shift+T", [](Stage& s, const Seen&) { return s.editor().timeline->seconds; },
       Shows::Nothing, "", point_at(0)},
      {"motion.paths", "click \"Motion/Onion skin and paths/Motion paths\"",
       [](Stage& s, const Seen&) { return s.editor().timeline->paths.on && motion_paths(s.editor()) != nullptr; },
       Shows::Nothing, "",
       [](Stage& s) {
         stand_at(20)(s);
         s.editor().timeline->paths.on = false;
         s.editor().selection->bone = 1;
         s.editor().selection->bones = {1};
       }},
      {"motion.onion_skin", "key Shift+O", [](Stage& s, const Seen&) { return s.editor().timeline->onion.on; },
       Shows::Nothing, "", stand_at(20)},
      {"motion.onion_frames",
       "click \"Motion/Onion skin and paths/Onion frames...\"\n double-click \"Ghost spacing/value\"\n type \"4\"\n "
       "key "
       "Return\n "
       "key Return",
       [](Stage& s, const Seen&) { return s.editor().timeline->onion.step == 4; }, Shows::Nothing, "", stand_at(20)},
      {"motion.zoom", "wheel lane 2", [](Stage& s, const Seen&) { return s.editor().timeline->window.count < 50; },
       Shows::Nothing, "", point_at(0)},
      {"motion.pan", "drag lane 40 0 MMB", [](Stage& s, const Seen&) { return s.editor().timeline->window.low < -3; },
       Shows::Nothing, "wheel lane -1\n key Home", point_at(0)},
      {"motion.view_all", "key Home",
       [](Stage& s, const Seen&) { return std::abs(s.editor().timeline->window.count - 64) < 1; }, Shows::Nothing,
       "wheel lane 3", point_at(0)},
      {"motion.view_selected", "key Num.",
       [](Stage& s, const Seen&) {
         return std::abs(s.editor().timeline->window.low + s.editor().timeline->window.count / 2 - 20.5) < 1e-9 &&
                s.editor().timeline->window.count < 30;
       },
       Shows::Nothing, "", with_chosen({10, 30})},
      {"motion.rename_marker", "key Ctrl+M\n wait-idle\n key Ctrl+A\n type turn\n key Return",
       [](Stage& s, const Seen&) {
         return shown_clip(s.editor().document())->markers == std::vector<Marker>{{20, "turn"}};
       },
       Shows::Nothing, "key M", point_at(20)},
      {"motion.delete_marker", "click \"Motion/Markers/Delete marker\"",
       [](Stage& s, const Seen&) { return shown_clip(s.editor().document())->markers.empty(); }, Shows::Nothing,
       "key M", point_at(20)},
      {"motion.choose_all_keys", "key A", chosen_are({10, 30}), Shows::Nothing, "", with_chosen({})},
      {"motion.choose_no_keys", "key Alt+A", chosen_are({}), Shows::Nothing, "", with_chosen({10, 30})},
      {"motion.box_keys", "drag keys 400 10 LMB Ctrl", chosen_are({30}), Shows::Nothing, "",
       [](Stage& s) {
         with_chosen({})(s);
         s.editor().timeline->window.low = 0;
         s.editor().timeline->window.count = 50;
         s.play("wait-idle");
       }},
      {"motion.move_keys", "key G\n key 5\n key Return", keys_are({10, 35}), Shows::Nothing, "", with_chosen({30})},
      {"motion.scale_keys", "key S\n key 2\n key Return", keys_are({20, 60}), Shows::Nothing, "",
       with_chosen({10, 30})},
      {"motion.duplicate_keys", "key Shift+D\n key 5\n key Return", keys_are({10, 15, 30}), Shows::Nothing, "",
       with_chosen({10})},
      {"motion.delete_keys", "key X", keys_are({30}), Shows::Nothing, "", with_chosen({10})},
      {"motion.key_menu", "key K", [](Stage& s, const Seen&) { return s.editor().menus->shown_popup == "Keys"; },
       Shows::Nothing, "", stand_at(0)},
      {"motion.preview_range", "key P", range_is(10, 30), Shows::Nothing, "", with_chosen({10, 30})},
      {"motion.clear_range", "key Alt+P", range_is(0, 60), Shows::Nothing, "key Ctrl+Home", point_at(20)},
      {"pose.blend_neighbour", "key Shift+Alt+E\n key 5\n key 0\n key Return",
       [](Stage& s, const Seen& b) {
         return edit_is("Blend to neighbour")(s, b) && std::abs(bend_of(pose_of(s.document())) - 25) < 1e-6;
       },
       Shows::InBody, "move \"3D view/view\"", with_keys(20, {10, 30})},
      {"pose.propagate", "key Alt+P",
       [](Stage& s, const Seen& b) {
         return edit_is("Propagate pose")(s, b) &&
                std::abs(glm::degrees(glm::angle(shown_clip(s.editor().document())->keys.bones.at("Fore").at(30))) -
                         20) < 1e-6;
       },
       Shows::Nothing, "move \"3D view/view\"", with_keys(20, {10, 30})},
      {"pose.apply_as_rest", "key Ctrl+A",
       [](Stage& s, const Seen& b) {
         return edit_is("Apply pose as rest")(s, b) && !s.document().pose &&
                std::abs(s.document().armature->bones[1].tail.y) > 10;
       },
       Shows::Nothing, "", stand_at(40)},
      {"view.timeline", "key Ctrl+T",
       [](Stage& s, const Seen&) {
         return !s.editor().screen->arrangement().timeline && s.editor().screen->layout.bottom.empty();
       },
       Shows::Nothing, "", stand_at(0)},
  };
}

std::vector<Proof> proofs_of_clips() {
  const auto first_frame_is = [](double degrees) {
    return [=](Stage& s, const Seen&) {
      return std::abs(bend_of(ClipOnRig(s.document().clips[0], s.document().armature).at(0)) - degrees) < 1e-6;
    };
  };
  return {
      {"motion.retarget", "click timeline/motion.retarget\n wait-idle",
       [](Stage& s, const Seen&) { return s.is("widget:Motion/motion.mirror"); }, Shows::Nothing,
       "click \"sidebar/sections/Motion/fold\"\n wait-idle", stand_at(0)},
      {"motion.map", "click sections/Motion/motion.map\n wait-idle\n click Fore/list\n click Fore/Upper",
       [](Stage& s, const Seen&) { return s.is("dialog", "yes") && maps(s, "Fore", "Upper"); }, Shows::InBody, "",
       stand_at(20)},
      {"motion.map_by_names", "click Motion/Retarget/Map...\n wait-idle\n click dialog/motion.map_by_names",
       [](Stage& s, const Seen&) {
         return shown_clip(s.editor().document())->map.sources.empty() && s.is("edit", "Match by names");
       },
       Shows::InBody, "",
       edited(20,
              [](Clip& clip) {
                clip.map.sources = {{"Fore", {"Upper", {}}}};
              })},
      {"motion.save_map", "click \"Motion/Retarget/Save map...\"\n type kept\n key Return\n wait-job",
       [](Stage& s, const Seen&) { return std::filesystem::exists(s.home / "kept.json"); }, Shows::Nothing, "",
       edited(20,
              [](Clip& clip) {
                clip.map.sources = {{"Upper", {"Fore", {}}}};
              })},
      {"motion.load_map", "click \"Motion/Retarget/Load map...\"\n type kept\n key Return\n wait-job",
       [](Stage& s, const Seen&) { return maps(s, "Upper", "Fore"); }, Shows::InBody, "", stand_at(20)},
      {"motion.travel_free", "click \"Root motion/list\"\n click \"Root motion/Free\"",
       settings_are([](const auto& r) { return r.travel == Travel::Free; }), Shows::Nothing, "", stand_at(20)},
      {"motion.travel_in_place", "click \"Root motion/list\"\n click \"Root motion/In place\"",
       settings_are([](const auto& r) { return r.travel == Travel::InPlace; }), Shows::Nothing, "", stand_at(20)},
      {"motion.travel_locked", "click \"Root motion/list\"\n click \"Root motion/Locked\"",
       settings_are([](const auto& r) { return r.travel == Travel::Locked; }), Shows::Nothing, "",
       edited(20, [](Clip& clip) { clip.retarget.travel = Travel::Free; })},
      {"motion.reference_rest", "click \"Reference pose/list\"\n click \"Reference pose/Clip's rest pose\"",
       settings_are([](const auto& r) { return r.reference == Reference::RestPose; }), Shows::Nothing, "",
       stand_at(20)},
      {"motion.reference_first", "click \"Reference pose/list\"\n click \"Reference pose/Clip's first frame\"",
       settings_are([](const auto& r) { return r.reference == Reference::FirstFrame; }), Shows::Nothing, "",
       stand_at(20)},
      {"motion.reference_found", "click \"Reference pose/list\"\n click \"Reference pose/Most upright\"",
       settings_are([](const auto& r) { return r.reference == Reference::Found; }), Shows::Nothing, "",
       edited(20, [](Clip& clip) { clip.retarget.reference = Reference::FirstFrame; })},
      {"motion.rest_t", "click \"Clip rest pose/list\"\n click \"Clip rest pose/T-pose\"",
       rest_is(&RestStances::source, RestStance::TPose), Shows::Nothing, "", stand_at(20)},
      {"motion.rest_a", "click \"Clip rest pose/list\"\n click \"Clip rest pose/A-pose\"",
       rest_is(&RestStances::source, RestStance::APose), Shows::Nothing, "", stand_at(20)},
      {"motion.rest_anatomical", "click \"Clip rest pose/list\"\n click \"Clip rest pose/Supine\"",
       rest_is(&RestStances::source, RestStance::Anatomical), Shows::Nothing, "", stand_at(20)},
      {"motion.rest_file", "click \"Clip rest pose/list\"\n click \"Clip rest pose/As stored\"",
       rest_is(&RestStances::source, RestStance::AsItLies), Shows::Nothing, "",
       edited(20,
              [](Clip& clip) {
                clip.map.stances = {RestStance::APose, RestStance::APose};
              })},
      {"motion.rig_rest_t", "click \"Rig rest pose/list\"\n click \"Rig rest pose/T-pose\"",
       rest_is(&RestStances::rig, RestStance::TPose), Shows::Nothing, "", stand_at(20)},
      {"motion.rig_rest_a", "click \"Rig rest pose/list\"\n click \"Rig rest pose/A-pose\"",
       rest_is(&RestStances::rig, RestStance::APose), Shows::Nothing, "", stand_at(20)},
      {"motion.rig_rest_anatomical", "click \"Rig rest pose/list\"\n click \"Rig rest pose/Supine\"",
       rest_is(&RestStances::rig, RestStance::Anatomical), Shows::Nothing, "", stand_at(20)},
      {"motion.rig_rest_file", "click \"Rig rest pose/list\"\n click \"Rig rest pose/As stored\"",
       rest_is(&RestStances::rig, RestStance::AsItLies), Shows::Nothing, "",
       edited(20,
              [](Clip& clip) {
                clip.map.stances = {RestStance::APose, RestStance::APose};
              })},
      {"motion.mirror", "click Motion/motion.mirror", settings_are([](const auto& r) { return r.mirror; }),
       Shows::Nothing, "", stand_at(20)},
      {"motion.rename_clip", "click \"Motion/Clip/Rename clip...\"\n wait-idle\n key Ctrl+A\n type knee\n key Return",
       [](Stage& s, const Seen&) { return s.is("clip", "knee"); }, Shows::Nothing, "", stand_at(20)},
      {"motion.trim", "click \"Motion/Clip/Trim to range\"",
       [](Stage& s, const Seen&) {
         return shown_clip(s.editor().document())->first == 10 && shown_clip(s.editor().document())->last == 30 &&
                shown_clip(s.editor().document())->start == 10;
       },
       Shows::Nothing, "", edited(0, [](Clip& clip) { clip.range_start = 10, clip.range_end = 30; })},
      {"motion.untrim", "click \"Motion/Clip/Undo trim\"", first_frame_is(0), Shows::Nothing, "",
       edited(0, [](Clip& clip) { clip.first = clip.start = 10; })},
      {"motion.resample",
       "click \"Motion/Clip/Resample clip...\"\n wait-idle\n double-click \"Frame rate/value\"\n key Ctrl+A\n type "
       "60\n key Return\n key Return",
       [](Stage& s, const Seen&) {
         return shown_clip(s.editor().document())->rate == 60 && shown_clip(s.editor().document())->range_end == 120 &&
                shown_clip(s.editor().document())->motion->frame_count == 121;
       },
       Shows::Nothing, "", stand_at(20)},
      {"motion.clean", "click \"Motion/Clip/Clean clip...\"\n wait-idle\n key Return\n wait-job\n wait-idle",
       [](Stage& s, const Seen& b) {
         return s.document().clips.size() == 2 && s.is("clip", "bending clean") && edit_is("Clean clip")(s, b);
       },
       Shows::Nothing, "", stand_at(20)},
      {"motion.hold", "click \"Motion/Clip/Hold a hand or foot...\"\n wait-idle\n key Return\n wait-job\n wait-idle",
       [](Stage& s, const Seen& b) { return s.is("clip", "bending") && edit_is("Hold limb")(s, b); }, Shows::Nothing,
       "", stand_with_names("LeftArm", "LeftForeArm")},
      {"motion.close_gap", "click \"Motion/Clip/Close gap...\"\n wait-idle\n key Return\n wait-job\n wait-idle",
       [](Stage& s, const Seen& b) {
         // A bend at constant speed continues across the closed gap.
         return edit_is("Close gap")(s, b) && shown_clip(s.editor().document())->motion &&
                std::abs(bend_of(ClipOnRig(s.document().clips[0], s.document().armature).at(22)) - 22) < 1e-3;
       },
       Shows::Nothing, "", stand_at(20)},
      {"motion.reduce_keys", "click \"Motion/Clip/Reduce to keys...\"\n wait-idle\n key Return\n wait-job\n wait-idle",
       [](Stage& s, const Seen& b) {
         const Clip* clip = shown_clip(s.editor().document());
         return edit_is("Reduce to keys")(s, b) && s.is("clip", "bending keys") && !clip->motion &&
                clip->keys.bones.at("Fore").size() == 2 &&
                std::abs(bend_of(ClipOnRig(s.document().clips[1], s.document().armature).at(33)) - 33) < 0.5;
       },
       Shows::Nothing, "", stand_at(20)},
      {"motion.mirror_clip", "click \"Motion/Clip/Whole clip/Mirror clip\"\n wait-idle",
       [](Stage& s, const Seen& b) {
         const auto& turns = shown_clip(s.editor().document())->keys.bones;
         return edit_is("Mirror clip")(s, b) && shown_clip(s.editor().document())->retarget.mirror &&
                turns.contains("Fore") && turns.at("Fore").at(20).y < -0.1;
       },
       Shows::InBody, "",
       edited(20, [](Clip& clip) { clip.keys.bones["Fore"][20] = glm::angleAxis(0.6, glm::dvec3(0, 1, 0)); })},
      {"motion.loop_clip",
       "click \"Motion/Clip/Whole clip/Loop clip...\"\n wait-idle\n key Return\n wait-job\n wait-idle",
       [](Stage& s, const Seen& b) {
         const Clip* clip = shown_clip(s.editor().document());
         return edit_is("Loop clip")(s, b) && s.is("clip", "bending loop") && clip->range_end == 240 &&
                std::abs(bend_of(ClipOnRig(s.document().clips[1], s.document().armature).at(150)) - 30) < 1e-3;
       },
       Shows::Nothing, "", stand_at(20)},
      {"motion.join_clip",
       "click \"Motion/Clip/Whole clip/Join clip...\"\n type next\n key Return\n wait-job\n wait-idle\n key Return\n "
       "wait-job\n wait-idle",
       [](Stage& s, const Seen& b) {
         const Clip* clip = shown_clip(s.editor().document());
         return edit_is("Join clip")(s, b) && s.is("clip", "bending + next") && clip->range_end == 60 + 61 - 9 &&
                std::abs(bend_of(ClipOnRig(s.document().clips[1], s.document().armature).at(112)) - 60) < 1e-3;
       },
       Shows::Nothing, "",
       [](Stage& s) {
         stand_at(20)(s);
         write_bvh(bending_motion(*s.document().armature), s.home / "next.bvh");
       }},
      {"motion.speed",
       "click \"Motion/Clip/Whole clip/Change speed...\"\n wait-idle\n double-click Speed/value\n key Ctrl+A\n type "
       "2\n key Return\n key Return\n wait-job\n wait-idle",
       [](Stage& s, const Seen& b) {
         return edit_is("Change speed")(s, b) && shown_clip(s.editor().document())->range_end == 30 &&
                std::abs(bend_of(ClipOnRig(s.document().clips[0], s.document().armature).at(15)) - 30) < 1e-3;
       },
       Shows::Nothing, "", stand_at(20)},
      {"motion.bake", "click \"Motion/Clip/Whole clip/Bake clip\"\n wait-job\n wait-idle",
       [](Stage& s, const Seen& b) {
         return edit_is("Bake clip")(s, b) && shown_clip(s.editor().document())->keys.empty() &&
                std::abs(bend_of(ClipOnRig(s.document().clips[0], s.document().armature).at(30)) - 50) < 1e-3;
       },
       Shows::Nothing, "",
       edited(
           20,
           [](Clip& clip) { clip.keys.bones["Fore"][30] = glm::angleAxis(glm::radians(50.0), glm::dvec3(1, 0, 0)); })},
      {"motion.delete_clip", "click \"Motion/Clip/Delete clip\"",
       [](Stage& s, const Seen&) { return s.document().clips.empty() && s.is("edit", "Delete clip bending"); },
       Shows::Nothing, "", stand_at(20)},
  };
}

TEST_CASE("operators: time is gone through and keyed") {
  Stage stage;
  prove(stage, proofs_of_motion());
}

TEST_CASE("operators: clips are matched, cut and kept") {
  Stage stage;
  prove(stage, proofs_of_clips());
}

}  // namespace limber::test
