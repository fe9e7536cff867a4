// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/solved_parts.h"

#include <algorithm>

namespace limber {

namespace {

// Stiffness of the springs at bones' nodes per volume around the node, for an adult's size (1), kPa/mm2. With this
// stiffness a bone yields by 0.01 mm where flesh pulls with 50 kPa.
constexpr double kPinStiffness = 1000;
// Spring stiffness in kPa/mm2 at nodes of tets between two bones. With stiffer springs the ends of bones often cannot
// slide past each other.
constexpr double kJointPinStiffness = 0.1;
// Material of tets whose nodes are all held by one bone but that share nodes with flesh; shear modulus in kPa.
constexpr TetMaterial kBoneTet{100, 0.3};

// A group of waiting nodes that is smaller than this share of the free nodes becomes free together with the group
// before it.
constexpr double kWorth = 0.125;

bool held_by_one(const std::vector<int>& held_by, const Eigen::RowVector4i& tet) {
  const int bone = held_by[tet[0]];
  return bone >= 0 && std::all_of(tet.begin(), tet.end(), [&](int v) { return held_by[v] == bone; });
}

}  // namespace

SolvedParts::SolvedParts(const FemModel& model, const std::vector<int>& held_by, double size) {
  const auto& T = model.mesh.T;
  std::vector<char> in_flesh(model.mesh.V.rows(), 0), in_elastic(model.mesh.V.rows(), 0);
  for (Eigen::Index t = 0; t < T.rows(); ++t)
    if (!held_by_one(held_by, T.row(t)))
      for (const int v : T.row(t)) in_flesh[v] = 1;
  // The force between an object and a fixed node would grow without limit. So nodes of bone at the surface are not
  // fixed: they count as nodes in flesh, and springs hold them.
  if (!model.objects.empty()) {
    const Eigen::MatrixX3i surface = boundary_of(model.mesh);
    for (const int v : surface.reshaped()) in_flesh[v] = 1;
  }

  in_joint.assign(model.mesh.V.rows(), 0);
  for (Eigen::Index t = 0; t < T.rows(); ++t) {
    int first = -1;
    bool joint = false;
    for (const int v : T.row(t))
      if (const int bone = held_by[v]; bone >= 0) joint = joint || (first >= 0 && bone != first), first = bone;
    if (joint)
      for (const int v : T.row(t)) in_joint[v] = 1;
  }

  std::vector<Eigen::Index> rigid_tet;
  std::vector<double> volume(model.mesh.V.rows(), 0);
  const NodePositions rest = model.mesh.V;
  for (Eigen::Index t = 0; t < T.rows(); ++t) {
    const bool one = held_by_one(held_by, T.row(t));
    if (one && std::none_of(T.row(t).begin(), T.row(t).end(), [&](int v) { return in_flesh[v]; })) {
      rigid_tet.push_back(t);
      continue;
    }
    elastic_tet.push_back(t);
    is_flesh.push_back(!one);
    material.push_back(one ? kBoneTet : model.material[t]);
    for (const int v : T.row(t)) {
      in_elastic[v] = 1;
      volume[v] += determinant(rest, T(t, 0), T(t, 1), T(t, 2), T(t, 3)) / 24;
    }
  }
  elastic = T(elastic_tet, Eigen::all);
  rigid = T(rigid_tet, Eigen::all);
  for (int v = 0; v < int(model.mesh.V.rows()); ++v) {
    if (held_by[v] < 0) continue;
    (in_elastic[v] ? pinned : carried).push_back(v);
    const double spring = (in_joint[v] ? kJointPinStiffness : kPinStiffness) / (size * size);
    if (in_elastic[v]) pin_stiffness.push_back(spring * volume[v]);
  }
}

void check(const FemModel& model, const Eigen::MatrixX3d* start) {
  const auto wrong = [](const char* what) {
    throw Error("a list of the finite element model does not fit its mesh", what, "give one valid entry for each");
  };
  if (std::ssize(model.material) != model.mesh.T.rows()) wrong("material of each tet");
  if (std::ssize(model.held_by) != model.mesh.V.rows()) wrong("bone that holds each node");
  if (std::any_of(model.waiting.begin(), model.waiting.end(), [&](const FemModel::Waiting& each) {
        return each.node < 0 || each.node >= std::ssize(model.held_by) || each.bone < 0 ||
               model.held_by[each.node] >= 0;
      }))
    wrong("nodes that wait for a bone");
  if (std::ssize(model.influences) != model.mesh.V.rows()) wrong("influences of each node");
  for (const FemModel::Sliding& each : model.sliding)
    if (each.node < 0 || each.node >= std::ssize(model.held_by) || model.held_by[each.node] >= 0 || each.bone < 0 ||
        each.bone >= std::ssize(model.bone_surface) || !model.bone_surface[each.bone])
      wrong("bone surface of each sliding node");
  for (const KeptVolume& volume : model.kept)
    for (const KeptVolume::Part& part : volume.parts)
      if (part.tet < 0 || part.tet >= model.mesh.T.rows()) wrong("tets of each kept volume");
  if (start && start->rows() != model.mesh.V.rows()) wrong("start position of each node");
  if (count_inverted(model.mesh.T, model.mesh.V))
    throw Error("a tet mesh has inverted tets", "at rest", "mesh the volume again");
  if (start && count_inverted(model.mesh.T, *start))
    throw Error("a tet mesh has inverted tets", "at the start of the solve", "start from rest");
}

std::vector<FemModel::Waiting> worth_waiting(const FemModel& model) {
  std::vector<FemModel::Waiting> waiting = model.waiting;
  std::stable_sort(waiting.begin(), waiting.end(), [](const auto& a, const auto& b) { return a.until < b.until; });
  double solved_for = double(std::count(model.held_by.begin(), model.held_by.end(), -1)) - double(waiting.size()),
         more = 0, since = 0;
  for (auto begin = waiting.begin(); begin != waiting.end() && begin->until < 1;) {
    const auto end = std::find_if(begin, waiting.end(), [&](const auto& each) { return each.until > begin->until; });
    more += double(end - begin);
    if (more < kWorth * solved_for) {
      for (auto each = begin; each != end; ++each) each->until = since;
    } else {
      since = begin->until;
      solved_for += std::exchange(more, 0);
    }
    begin = end;
  }
  return waiting;
}

SlideForm slide_form_of(const FemModel& model, const SolveSettings& settings) {
  SlideForm form;
  form.surface = model.bone_surface;
  form.posed_from_rest.resize(form.surface.size());
  for (const FemModel::Sliding& each : model.sliding) {
    const Eigen::RowVector3d rest = model.mesh.V.row(each.node);
    form.nodes.push_back({.node = each.node,
                          .bone = each.bone,
                          .normal = settings.slide_kpa_per_mm / settings.size * each.mm2,
                          .fascia = settings.fascia_kpa / (settings.fascia_mm * settings.size) * each.mm2,
                          .rest = rest,
                          .rest_mm = form.surface[each.bone]->at(rest).mm});
  }
  return form;
}

}  // namespace limber
