// SPDX-License-Identifier: AGPL-3.0-or-later
// Names the editor's icons by their meaning. Each constant is a character of the font Font Awesome 4.7, in UTF-8.
#pragma once

namespace limber::editor::icon {

// Icons of workspaces and of data
inline constexpr char kRig[] = "\uf0e8", kSkin[] = "\uf1fc", kPose[] = "\uf1ae", kResample[] = "\uf1b3";
inline constexpr char kVolume[] = "\uf1b2", kTissues[] = "\uf00a", kMotion[] = "\uf008";

// Icons of file commands
inline constexpr char kNew[] = "\uf15b", kOpen[] = "\uf07c", kFolder[] = "\uf07b", kSave[] = "\uf0c7",
                      kImport[] = "\uf019", kExport[] = "\uf08b", kHistory[] = "\uf1da", kMissing[] = "\uf127",
                      kTrash[] = "\uf014";

// Icons of editing commands
inline constexpr char kUndo[] = "\uf0e2", kRedo[] = "\uf064", kSearch[] = "\uf002", kFilter[] = "\uf0b0",
                      kDuplicate[] = "\uf0c5", kCopy[] = "\uf0ea", kAdd[] = "\uf067", kRemove[] = "\uf068",
                      kRename[] = "\uf040", kPreferences[] = "\uf013";

// Icons of view commands
inline constexpr char kVisible[] = "\uf06e", kHidden[] = "\uf070", kOneView[] = "\uf0c8", kSplitViews[] = "\uf0db",
                      kFourViews[] = "\uf009", kClip[] = "\uf125", kMeasure[] = "\uf07e", kCamera[] = "\uf030",
                      kFullScreen[] = "\uf065", kCrossHair[] = "\uf05b", kSpace[] = "\uf0ac";

// Icons of tools
inline constexpr char kSelect[] = "\uf245", kMove[] = "\uf047", kRotate[] = "\uf01e", kScale[] = "\uf0b2",
                      kPick[] = "\uf1fb", kCut[] = "\uf0c4", kReach[] = "\uf1e0", kExtrude[] = "\uf08e",
                      kSnap[] = "\uf076", kBreakdown[] = "\uf1de", kMirror[] = "\uf0ec", kLinkViews[] = "\uf0c1",
                      kLock[] = "\uf023", kUnlocked[] = "\uf13e";

// Icons of brushes
inline constexpr char kBrushAdd[] = "\uf067", kBrushSubtract[] = "\uf068", kBrushSet[] = "\uf192",
                      kBrushMultiply[] = "\uf069", kBrushSmooth[] = "\uf043", kBrushSharpen[] = "\uf0e7",
                      kBrushAverage[] = "\uf24e", kBrushSmear[] = "\uf25a", kBrushCapsule[] = "\uf1cd",
                      kGradient[] = "\uf1fe", kRegion[] = "\uf096", kSeam[] = "\uf126", kLabelBrush[] = "\uf02b";

// Icons for comparing results
inline constexpr char kWipe[] = "\uf07e", kDifference[] = "\uf248", kOverlap[] = "\uf247", kReport[] = "\uf080";

// Icons for weight layers
inline constexpr char kUp[] = "\uf062", kDown[] = "\uf063", kMergeDown[] = "\uf103", kMask[] = "\uf12d";

// Icons of the timeline
inline constexpr char kFirst[] = "\uf049", kBack[] = "\uf048", kPlay[] = "\uf04b", kPause[] = "\uf04c",
                      kForward[] = "\uf051", kLast[] = "\uf050", kLoop[] = "\uf079", kKey[] = "\uf084",
                      kMarker[] = "\uf02e", kOnionSkin[] = "\uf24d";

// Icons of states, such as success, failure and waiting
inline constexpr char kOk[] = "\uf058", kFail[] = "\uf057", kWarning[] = "\uf071", kError[] = "\uf06a",
                      kInfo[] = "\uf05a", kRunning[] = "\uf110", kWaiting[] = "\uf017", kTick[] = "\uf00c",
                      kClose[] = "\uf00d", kOpened[] = "\uf0d7", kClosed[] = "\uf0da", kLeft[] = "\uf0d9",
                      kMore[] = "\uf141", kDot[] = "\uf111", kNext[] = "\uf138";

// Other icons
inline constexpr char kTable[] = "\uf0ce", kJobs[] = "\uf0ae", kKeyboard[] = "\uf11c", kTheme[] = "\uf042",
                      kConsole[] = "\uf120", kHelp[] = "\uf059", kTour[] = "\uf005", kExpand[] = "\uf065";

}  // namespace limber::editor::icon
