// SPDX-License-Identifier: AGPL-3.0-or-later
// The measurements of the document as the views show them: where their points are on the shown body, which may be at
// rest, posed live or a result, and what they measure there.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/context/editor.h"
#include "render/scene/scene.h"

namespace limber::editor {

// What the views remember about measurements. It is not part of the document.
struct MeasureView {
  bool shown = true;
  std::string chosen;  // name of the measurement that is chosen in the list; "" for none

  // The points on the body of a result, with what they were computed from.
  struct Placed {
    std::weak_ptr<const LabelVolume> volume;
    std::vector<glm::dvec3> at_rest, posed;  // of all measurements, world, mm
  };
  std::vector<Placed> placed;  // of a few results, latest last
};

// Returns the points of each measurement of the document on the body that a scene shows, world, mm.
std::vector<std::vector<glm::dvec3>> placed_measurements(Editor& editor, const render::Scene& scene);
// Returns where points of the body at rest lie on the body that a scene shows, world, mm. Points that are not at tissue
// stay where they are.
std::vector<glm::dvec3> points_on_scene(Editor& editor, const render::Scene& scene,
                                        const std::vector<glm::dvec3>& at_rest);
// Returns whether a point of the body at rest lies in tissue or at most two voxels beside it.
bool is_at_tissue(const LabelVolume& volume, const glm::dvec3& at_rest);
// Returns the point of the body at rest that a scene shows at a world point. Nothing where it shows no tissue.
std::optional<glm::dvec3> point_at_rest(const render::Scene& scene, const glm::dvec3& world);

// Adds a measurement to the document, with a name such as "Distance 2", and chooses it.
void add_measurement(Editor& editor, MeasureKind kind, std::vector<glm::dvec3> points);
// Returns the chosen measurement; nothing when none is chosen.
std::optional<std::size_t> chosen_measurement(const Editor& editor);

// Returns all measurements as a table of tab-separated columns: name, kind, value at rest, value as shown, unit.
std::string table_of_measurements(Editor& editor);

}  // namespace limber::editor
