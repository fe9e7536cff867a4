// SPDX-License-Identifier: AGPL-3.0-or-later
// The measurements of the document as the views show them: the positions of their points on the shown body, and the
// values measured there. The shown body may be at rest, in a previewed pose, or a result.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/measure/measurement.h"
#include "render/scene/scene.h"

namespace limber::editor {

struct Context;

// The state of the measurements' display. It is not part of the document.
struct MeasureView {
  bool shown = true;
  std::string chosen;  // name of the measurement that is selected in the list; "" for none

  // Cached positions of the measurements' points on the body of a result, with the inputs of the computation.
  struct Placed {
    std::weak_ptr<const LabelVolume> volume;
    // Points of all measurements: in the rest pose, and in the result; world, mm.
    std::vector<glm::dvec3> at_rest, posed;
  };
  std::vector<Placed> placed;  // cached positions for the last few results, the newest last
};

// Returns, for each measurement of the document, its points on the body that a scene shows, world, mm.
std::vector<std::vector<glm::dvec3>> placed_measurements(Context& context, const render::Scene& scene);
// Converts points of the rest body to their positions on the body that a scene shows, world, mm. A point that is not
// in or near tissue does not move.
std::vector<glm::dvec3> points_on_scene(Context& context, const render::Scene& scene,
                                        const std::vector<glm::dvec3>& at_rest);
// Returns true if a point of the rest body lies in tissue or at most two voxels from it.
bool is_at_tissue(const LabelVolume& volume, const glm::dvec3& at_rest);
// Converts a world point on the body that a scene shows to the point of the rest body. Returns nothing if there is no
// tissue at the point.
std::optional<glm::dvec3> point_at_rest(const render::Scene& scene, const glm::dvec3& world);

// Adds a measurement to the document, with a name such as "Distance 2", and selects it.
void add_measurement(Context& context, MeasureKind kind, std::vector<glm::dvec3> points);
// Returns the index of the selected measurement; nothing when none is selected.
std::optional<std::size_t> chosen_measurement(const Context& context);

// Returns all measurements as a table of tab-separated columns: name, kind, value at rest, value as shown, unit.
std::string table_of_measurements(Context& context);

}  // namespace limber::editor
