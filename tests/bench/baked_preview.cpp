// SPDX-License-Identifier: AGPL-3.0-or-later
// baked_preview
// Measures the live preview on the procedural arm at 2 mm while the elbow is dragged: what a frame costs with a baked
// elbow, and what it costs by dual quaternions alone. Also measures posing a whole volume both ways. Prints medians of
// the process's CPU seconds as JSON.
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <vector>

#include "core/bake/bake_joint.h"
#include "core/deform/preview_map.h"
#include "core/phantom/phantom.h"
#include "core/resample/resample.h"

namespace {

using namespace limber;

constexpr int kFrames = 40, kVolumes = 5;
constexpr int kStep = 4;  // edge of a cell of the preview, voxels, as in the preview of a limb

double cpu_seconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

double median_of(int count, const std::function<void(int)>& run) {
  std::vector<double> seconds;
  for (int i = 0; i < count; ++i) {
    const double begin = cpu_seconds();
    run(i);
    seconds.push_back(cpu_seconds() - begin);
  }
  std::nth_element(seconds.begin(), seconds.begin() + count / 2, seconds.end());
  return seconds[count / 2];
}

}  // namespace

int main() {
  try {
    Phantom arm = make_arm_phantom(2);
    VolumeFile file{std::move(arm.volume), arm.tissues, {"NRRD", "uint8", false}, {}};
    const Body body = make_body(std::move(file), &arm.tissues, arm.armature, {}, {}, "arm");
    const BoundBody bound = bind_body(body, Binding::Heat, {}, no_progress());
    const int bone = require_bone(body.rig, "Forearm");
    const BakeSettings settings{.low = 0, .high = 80, .angles = 7, .quality = FemQuality::Draft, .glide = "off"};
    const auto joint = std::make_shared<const BakedJoint>(bake_joint(body, bound, bone, settings, no_progress()).joint);
    const auto bent = [&](int i) {
      Pose pose = rest_pose(body.rig);
      flex(pose, body.rig, bone, 20 + i);
      return pose;
    };
    LivePreview preview(std::make_shared<const LabelVolume>(body.file.volume), body.tissues, bound.tissue,
                        bound.weights, kStep);
    double frame[2], volume[2];
    for (const bool is_baked : {false, true}) {
      const BakedJoints baked = is_baked ? BakedJoints{joint} : BakedJoints{};
      const auto update = [&](int i) {
        const Pose pose = bent(i);
        preview.update(posed_from_rest(body.rig, pose), Blend::DualQuaternion, {},
                       joints_in_pose(baked, body.rig, pose));
      };
      // The first update is not measured, because it also samples the baked joint.
      update(-1);
      frame[is_baked] = median_of(kFrames, update);
      volume[is_baked] = median_of(kVolumes, [&](int i) {
        ResampleSettings resampling;
        resampling.baked = baked;
        resample(body.file.volume, body.tissues, body.rig, bound.weights, bent(10 * i), Blend::DualQuaternion,
                 resampling);
      });
    }
    std::printf(
        "{\"subject\": \"arm 2 mm\", \"nodes\": %zu, \"frame_dq_cpu_ms\": %.3f, \"frame_baked_cpu_ms\": %.3f, "
        "\"frame_ratio\": %.3f, \"volume_dq_cpu_ms\": %.1f, \"volume_baked_cpu_ms\": %.1f, \"volume_ratio\": %.3f}\n",
        joint->nodes.size(), 1e3 * frame[0], 1e3 * frame[1], frame[1] / frame[0], 1e3 * volume[0], 1e3 * volume[1],
        volume[1] / volume[0]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "baked_preview: %s\n", error.what());
    return 1;
  }
}
