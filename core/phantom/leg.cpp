// SPDX-License-Identifier: AGPL-3.0-or-later
// Builds the leg. The joint surfaces of bones are round about the rig's joint centres, and sockets are cut around them
// with a gap, so that bones rotate without touching. Lengths in mm.
#include "core/phantom/limbs.h"

namespace limber::phantom {

namespace {
using V = glm::dvec3;
using T = glm::dvec4;  // a point and a radius

// z coordinates, mm: of the knee in the thigh's frame, of the ankle in the shank's frame, and of the sole in the foot's
// frame.
constexpr double kKneeZ = -435, kAnkleZ = -395, kSole = -83;
constexpr double kToeOut = 8;  // outward rotation of the foot, degrees
constexpr double kGap = 1.6;   // thickness of the cartilage in small joints, mm

Cone cone(const Frame& f, const V& a, double radius_a, const V& b, double radius_b) {
  return {f.point(a), f.point(b), radius_a, radius_b};
}
Cone ball_at(const Frame& f, const V& centre, double radius) {
  return cone(f, centre, radius, centre + V(0, 0, 0.01), radius);
}
Ellipsoid ellipsoid(const Frame& f, const V& centre, const V& radii) { return {f.at(centre), radii}; }

struct Toe {
  V base, head, tip;  // both ends of the metatarsal, and the tip of the toe; foot frame
  double bone, flesh;
};
constexpr Toe kToes[] = {
    {{-16, -76, -44}, {-28, -134, -68}, {-36, -192, -72}, 9.0, 11.2},
    {{-5, -78, -41}, {-11, -138, -70}, {-13, -196, -75}, 6.0, 7.2},
    {{4, -74, -43}, {4, -132, -71}, {4, -188, -75.5}, 5.6, 6.9},
    {{13, -68, -49}, {18, -124, -71}, {21, -176, -76}, 5.6, 6.7},
    {{23, -60, -55}, {32, -114, -71}, {38, -160, -76}, 6.0, 6.7},
};

class Leg {
 public:
  Leg(Anatomy& anatomy, const LimbPlan& plan, const Frame& upright)
      : anatomy_(anatomy),
        plan_(plan),
        thigh_(plan.root),
        shank_(thigh_.at({0, 0, kKneeZ}).turned({1, 0, 0}, plan.bend_degrees)),
        foot_(Frame{shank_.point({0, 0, kAnkleZ}), upright.axes}.turned({0, 0, 1}, kToeOut)) {}

  void build() {
    add_rig();
    add_flesh();
    add_bones();
    add_foot_bones();
    add_muscles();
    add_cords();
  }

 private:
  Anatomy& anatomy_;
  const LimbPlan& plan_;
  Frame thigh_, shank_, foot_;

  double thin(double radius) const { return std::max(radius, plan_.thinnest_radius); }
  void muscle(Label label, const Frame& frame, std::initializer_list<T> tube) {
    anatomy_.muscles.push_back({Solid().add_tube(frame, std::vector<T>(tube)), label});
  }
  void cord(Label label, std::vector<T> points) {
    for (T& p : points) p.w = thin(p.w);
    anatomy_.inner.push_back({Solid().add_tube({}, points), label});
  }
  static T in(const Frame& f, const V& p, double radius) { return T(f.point(p), radius); }

  void add_rig() {
    const auto& name = plan_.prefix;
    const double bend = plan_.bend_degrees;
    const V ball_of_foot = foot_.point({3, -128, -70});
    const int thigh =
        anatomy_.add_rig_bone(name + "Thigh", plan_.rig_parent, thigh_.origin, shank_.origin, ball(110, -45, 45));
    const int shank = anatomy_.add_rig_bone(name + "Shank", thigh, shank_.origin, foot_.origin,
                                            hinge(thigh_.turn_axis({1, 0, 0}), -bend, 135 - bend));
    const int foot = anatomy_.add_rig_bone(name + "Foot", shank, foot_.origin, ball_of_foot,
                                           hinge(foot_.turn_axis({-1, 0, 0}), -50, 20));
    anatomy_.add_rig_bone(name + "Toes", foot, ball_of_foot, foot_.point({3, -185, -74}),
                          hinge(foot_.turn_axis({-1, 0, 0}), -35, 70));
  }

  void add_flesh() {
    Solid thigh(Loft(thigh_,
                     {{60, {6, 6}, {44, 54}},
                      {10, {10, 4}, {74, 82}},
                      {-60, {8, 1}, {80, 85}},
                      {-130, {5, -2}, {75, 81}},
                      {-210, {3, -3}, {68, 74}},
                      {-300, {1, -2}, {58, 63}},
                      {-380, {0, -2}, {51, 55}},
                      {-425, {0, -3}, {51, 55}},
                      {-465, {0, -1}, {48, 51}}},
                     30));
    thigh
        .add(cone(thigh_, {-22, -34, -330}, 24, {-24, -34, -390}, 19), 20)  // vastus medialis
        .add(cone(thigh_, {26, -28, -270}, 28, {24, -30, -380}, 20), 24)    // vastus lateralis
        .add(ball_at(thigh_, {0, -36, -428}, 24), 14);                      // knee cap
    const int upper = anatomy_.add_flesh(thigh, plan_.flesh_parent, 34, 9);
    Solid shank(Loft(shank_,
                     {{20, {0, 1}, {46, 48}},
                      {-30, {0, 3}, {47, 50}},
                      {-75, {0, 8}, {51, 55}},
                      {-125, {0, 10}, {52, 57}},
                      {-180, {0, 6}, {45, 50}},
                      {-250, {0, 2}, {34, 39}},
                      {-320, {0, 3}, {29, 34}},
                      {-375, {0, 3}, {32, 37}},
                      {-402, {0, 3}, {33, 37}}},
                     16));
    shank.add(cone(shank_, {-20, 34, -70}, 24, {-18, 32, -150}, 20), 24)
        .add(cone(shank_, {20, 33, -65}, 22, {18, 31, -135}, 19), 24)
        .add(ball_at(shank_, {-24, 0, -394}, 13), 10)
        .add(ball_at(shank_, {25, 6, -398}, 13), 10);
    const int lower = anatomy_.add_flesh(shank, upper, 24, 5);
    Solid foot(cone(foot_, {0, 34, -52}, 29, {0, 20, -8}, 30));
    foot.add(cone(foot_, {-2, 4, -26}, 35, {-5, -66, -46}, 29), 22)
        .add(cone(foot_, {-5, -62, -48}, 30, {-12, -124, -66}, 20), 20)
        .add(cone(foot_, {10, -20, -56}, 26, {24, -106, -68}, 16), 20)
        .add(cone(foot_, {-26, -130, -68}, 16, {30, -108, -70}, 13.5), 14)
        .cut(Plate{foot_.point({0, 900, kSole - 60}), foot_.point({800, -600, kSole - 60}),
                   foot_.point({-800, -600, kSole - 60}), 60},
             8);
    const int sole = anatomy_.add_flesh(foot, lower, 20, 4);
    for (const Toe& toe : kToes) {
      Solid solid(
          cone(foot_, toe.head + V(0, 6, 0), toe.flesh * 1.12, glm::mix(toe.head, toe.tip, 0.6), toe.flesh * 0.94));
      solid.add(cone(foot_, glm::mix(toe.head, toe.tip, 0.6), toe.flesh * 0.94, toe.tip + V(0, 0.9 * toe.flesh, 0),
                     toe.flesh),
                2);
      anatomy_.add_flesh(solid, sole, 8, 2);
      anatomy_.nails.push_back(
          Solid(ellipsoid(foot_, toe.tip + V(0, 0.75 * toe.flesh, toe.flesh), V(0.72, 0.85, 0.7) * toe.flesh)));
    }
  }

  void add_bones() {
    Solid femur(cone(thigh_, {44, 4, -42}, 17, {27, -3, -190}, 14));
    femur.add(cone(thigh_, {27, -3, -190}, 14, {6, -1, -375}, 16), 5)
        .add(cone(thigh_, {6, -1, -375}, 16, {0, -4, -414}, 25), 12)
        .add(cone(thigh_, {-19, 0, kKneeZ}, 21, {19, 0, kKneeZ}, 21), 10)  // condyles
        .add(cone(thigh_, {0, -6, -422}, 21, {0, -7, -425}, 21), 10)
        .add(cone(thigh_, {46, 6, -34}, 16, {50, 8, -8}, 14), 10)  // greater trochanter
        .add(cone(thigh_, {0, 0, 0}, 14, {42, 4, -34}, 15), 10)    // femoral neck
        .add(ball_at(thigh_, V(0), 23.5), 5);
    anatomy_.add_long_bone(femur, 6, thigh_.point({43, 4, -55}), thigh_.point({4, -1, -385}));
    anatomy_.add_bone(Solid(ellipsoid(thigh_, {0, -40, -424}, {21, 9, 22})), 2.5);  // knee cap

    Solid tibia(cone(shank_, {-22, 1, -40}, 15, {22, 1, -40}, 15));
    tibia.add(cone(shank_, {0, 0, -48}, 20, {-1, -9, -120}, 13), 10)
        .add(cone(shank_, {-1, -9, -120}, 13, {-5, -2, -310}, 11), 5)
        .add(cone(shank_, {-5, -2, -310}, 11, {-3, 0, -372}, 17), 8)
        .add(cone(shank_, {-18, 0, -372}, 8, {-24, 0, -396}, 7), 6)  // inner malleolus
        .add(ball_at(shank_, {0, -20, -62}, 8), 8)                   // tuberosity
        .cut(cone(shank_, {-60, 0, 0}, 24.5, {60, 0, 0}, 24.5))
        .cut(cone(foot_, {-15, 0, 0}, 20, {40, 0, 0}, 20));
    anatomy_.add_long_bone(tibia, 4.5, shank_.point({0, -4, -70}), shank_.point({-4, -1, -355}));
    Solid fibula(cone(shank_, {32, 14, -44}, 9, {29, 13, -80}, 6));
    fibula.add(cone(shank_, {29, 13, -80}, 6, {22, 10, -330}, 6.5), 4)
        .add(cone(shank_, {22, 10, -330}, 6.5, {25, 6, -400}, 8), 4);
    anatomy_.add_long_bone(fibula, 2.4, shank_.point({29, 13, -70}), shank_.point({23, 9, -370}));
  }

  void add_foot_bones() {
    Solid tarsus(cone(foot_, {-11, 0, 0}, 17, {9, 0, 0}, 17));  // the talus: a cylinder whose axis is the ankle's axis
    tarsus.add(ellipsoid(foot_, {-4, -18, -14}, {16, 24, 14}), 8)
        .add(cone(foot_, {2, 36, -46}, 19, {6, -4, -38}, 15), 8)  // heel
        .add(ellipsoid(foot_, {-10, -44, -24}, {15, 11, 14}), 4)
        .add(ellipsoid(foot_, {-7, -60, -34}, {18, 13, 13}), 4)
        .add(ellipsoid(foot_, {16, -38, -46}, {13, 19, 13}), 4)
        .cut(cone(shank_, {27, 6, -380}, 10, {27, 6, -405}, 10));
    anatomy_.add_bone(tarsus, 2);
    for (const Toe& toe : kToes) {
      Solid metatarsal(cone(foot_, toe.base, toe.bone, glm::mix(toe.base, toe.head, 0.3), 0.66 * toe.bone));
      metatarsal
          .add(cone(foot_, glm::mix(toe.base, toe.head, 0.3), 0.66 * toe.bone, glm::mix(toe.base, toe.head, 0.8),
                    0.6 * toe.bone),
               3)
          .add(cone(foot_, glm::mix(toe.base, toe.head, 0.75), 0.6 * toe.bone, toe.head, 0.92 * toe.bone), 4);
      anatomy_.add_long_bone(metatarsal, 1.8, foot_.point(glm::mix(toe.base, toe.head, 0.15)),
                             foot_.point(glm::mix(toe.base, toe.head, 0.85)));
      // Each toe gets two phalanges (toe bones) instead of three, since the outer two have often grown together in
      // small toes.
      const V along = toe.tip - toe.head;
      const double length = glm::length(along), head = 0.92 * toe.bone, middle = 0.62 * toe.bone;
      const V unit = along / length, joint = toe.head + 0.54 * along;
      Solid proximal(
          cone(foot_, toe.head + (0.6 * head + kGap) * unit, 0.9 * head, toe.head + 0.25 * along, 0.5 * toe.bone));
      proximal.add(cone(foot_, toe.head + 0.25 * along, 0.5 * toe.bone, joint, middle), 3)
          .cut(ball_at(foot_, toe.head, head + kGap));
      anatomy_.add_bone(proximal, 1.3);
      Solid distal(cone(foot_, joint + (0.6 * middle + kGap) * unit, 0.9 * middle, toe.tip - (toe.flesh - 1) * unit,
                        0.42 * toe.bone));
      distal.cut(ball_at(foot_, joint, middle + kGap));
      anatomy_.add_bone(distal, 1.2);
    }
  }

  void add_muscles() {
    muscle(kQuadriceps, thigh_, {{20, -42, -10, 10}, {16, -44, -120, 22}, {8, -42, -250, 20}, {0, -36, -370, 9}});
    muscle(kQuadriceps, thigh_, {{52, -6, -60, 14}, {46, -16, -170, 26}, {32, -22, -290, 24}, {18, -28, -380, 10}});
    muscle(kQuadriceps, thigh_, {{18, -18, -120, 12}, {-8, -26, -240, 20}, {-26, -24, -350, 19}, {-22, -24, -400, 9}});
    muscle(kHamstrings, thigh_, {{-6, 46, -50, 14}, {12, 44, -180, 24}, {24, 32, -310, 18}, {30, 28, -420, 8}});
    muscle(kHamstrings, thigh_, {{-12, 46, -50, 12}, {-20, 42, -180, 22}, {-26, 32, -310, 17}, {-28, 26, -420, 8}});
    muscle(kAdductors, thigh_, {{-52, 4, -30, 18}, {-40, 8, -130, 26}, {-20, 10, -250, 16}, {-14, 10, -340, 8}});
    muscle(kAdductors, thigh_, {{-48, -14, -20, 12}, {-50, -16, -120, 12}, {-42, -6, -260, 9}, {-34, 10, -400, 7}});
    muscle(kCalf, shank_, {{-18, 30, 0, 9}, {-20, 34, -80, 21}, {-14, 34, -160, 15}, {-4, 34, -210, 6}});
    muscle(kCalf, shank_, {{18, 30, 0, 9}, {20, 32, -75, 19}, {14, 33, -150, 14}, {2, 34, -205, 6}});
    muscle(kCalf, shank_, {{6, 22, -60, 14}, {4, 22, -160, 20}, {2, 24, -250, 12}, {0, 26, -310, 6}});
    muscle(kCalf, shank_, {{-6, 12, -100, 10}, {-8, 12, -220, 10}, {-12, 12, -330, 6}});
    muscle(kShinMuscles, shank_, {{14, -16, -50, 9}, {14, -20, -120, 13}, {6, -22, -230, 9}, {0, -22, -320, 4}});
    muscle(kShinMuscles, shank_, {{32, -2, -60, 8}, {32, -2, -150, 11}, {28, 4, -260, 8}, {27, 10, -340, 5}});
    muscle(kFootMuscles, foot_, {{0, 24, -70, 8}, {-8, -40, -66, 12}, {-14, -100, -72, 8}});
    muscle(kFootMuscles, foot_, {{10, 20, -70, 8}, {20, -40, -70, 9}, {24, -95, -74, 6}});
    for (int i = 0; i < 4; ++i) {
      const V a = 0.5 * (kToes[i].base + kToes[i + 1].base), b = 0.5 * (kToes[i].head + kToes[i + 1].head);
      muscle(kFootMuscles, foot_, {T(a, 4), T(glm::mix(a, b, 0.8), 4)});
    }
  }

  void add_cords() {
    cord(kTendon, {in(thigh_, {0, -38, -370}, 5), in(thigh_, {0, -46, -410}, 6), in(thigh_, {0, -46, -440}, 5),
                   in(shank_, {0, -29, -60}, 4)});
    cord(kTendon, {in(shank_, {0, 35, -215}, 6), in(shank_, {0, 35, -330}, 4.5), in(foot_, {2, 50, -20}, 4.5),
                   in(foot_, {2, 54, -42}, 5)});
    cord(kTendon, {in(shank_, {0, -23, -300}, 3), in(shank_, {-6, -26, -375}, 2.8), in(foot_, {-18, -50, -18}, 2.6),
                   in(foot_, {-18, -72, -38}, 2.4)});
    cord(kArtery, {in(thigh_, {2, -40, 30}, 4.5), in(thigh_, {-6, -36, -60}, 4), in(thigh_, {-22, -8, -230}, 3.5),
                   in(thigh_, {-4, 26, -390}, 3.2), in(shank_, {-2, 24, -60}, 3), in(shank_, {-10, 18, -200}, 2.2),
                   in(shank_, {-20, 20, -370}, 1.9), in(foot_, {-18, -10, -52}, 1.6)});
    cord(kVein, {in(thigh_, {-8, -42, 30}, 5), in(thigh_, {-16, -36, -60}, 4.4), in(thigh_, {-28, 0, -230}, 4),
                 in(thigh_, {4, 30, -390}, 3.6), in(shank_, {4, 28, -60}, 3)});
    cord(kVein, {in(thigh_, {-16, -58, -20}, 2.4), in(thigh_, {-60, -20, -200}, 2.3), in(thigh_, {-44, 14, -420}, 2.2),
                 in(shank_, {-42, 4, -150}, 2), in(shank_, {-28, -12, -380}, 1.8)});
    cord(kNerve, {in(thigh_, {0, 46, 20}, 5), in(thigh_, {4, 30, -120}, 4.6), in(thigh_, {4, 34, -380}, 3.6),
                  in(shank_, {0, 30, -60}, 2.6), in(shank_, {-8, 22, -250}, 2.2), in(shank_, {-20, 24, -375}, 1.8)});
    for (int side : {-1, 1})  // the collateral ligaments on both sides of the knee
      cord(kLigament, {in(thigh_, {side * 41.0, 2, kKneeZ + 4}, 2.4), in(shank_, {side * 38.0, 4, -52}, 2.4)});
  }
};
}  // namespace

void add_leg(Anatomy& anatomy, const LimbPlan& plan, const Frame& upright) { Leg(anatomy, plan, upright).build(); }

}  // namespace limber::phantom
