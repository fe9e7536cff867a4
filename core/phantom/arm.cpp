// SPDX-License-Identifier: AGPL-3.0-or-later
// Builds the arm. The joint surfaces of bones are spheres and cylinders around the rig's joint centres and axes, and
// their sockets leave a gap, so that bones rotate without touching. Lengths in mm.
#include "core/phantom/limbs.h"

namespace limber::phantom {

namespace {
using V = glm::dvec3;
using T = glm::dvec4;  // a point and a radius

// z coordinate, mm, of the elbow in the frame of the humerus, and of the wrist in the frame of the forearm.
constexpr double kElbowZ = -300, kWristZ = -252;
constexpr V kWristCentre(0, 0, -17);  // centre of the wrist, in the head of the capitate; hand frame
constexpr double kPronation = 80;     // rotation of the forearm, degrees; at 0 the palm faces forward, at 80 the thigh
constexpr double kGap = 1.6;          // thickness of the cartilage in small joints, mm

Cone cone(const Frame& f, const V& a, double radius_a, const V& b, double radius_b) {
  return {f.point(a), f.point(b), radius_a, radius_b};
}
Cone ball_at(const Frame& f, const V& centre, double radius) {
  return cone(f, centre, radius, centre + V(0, 0, 0.01), radius);
}
Ellipsoid ellipsoid(const Frame& f, const V& centre, const V& radii) { return {f.at(centre), radii}; }

struct Finger {
  const char* name;
  V base, head;                   // ends of the metacarpal, hand frame
  double spread;                  // angle of the finger towards the thumb, degrees
  std::array<double, 3> lengths;  // lengths of the phalanges, mm
  double bone, flesh;             // radius of the metacarpal's head, and of the finger's flesh there
};
constexpr Finger kFingers[] = {
    {"Index", {13, 2, -38}, {21, 4, -94}, 9, {42, 25, 19}, 6.8, 9.6},
    {"Middle", {3, 3, -38}, {3, 6, -96}, 1, {46, 29, 20}, 6.8, 9.8},
    {"Ring", {-6, 2, -37}, {-14, 4, -90}, -7, {42, 27, 20}, 6.4, 9.3},
    {"Little", {-13, -1, -36}, {-29, -1, -82}, -16, {34, 20, 18}, 5.8, 8.3},
};
// Angles of a finger's knuckle, middle joint and end joint, degrees from straight: bend at rest, largest bend, and
// largest overextension [AAOS 1965].
constexpr double kRestBend[] = {14, 20, 10}, kMostBend[] = {90, 100, 80}, kMostBack[] = {30, 0, 0};

class Arm {
 public:
  Arm(Anatomy& anatomy, const LimbPlan& plan)
      : anatomy_(anatomy),
        plan_(plan),
        upper_(plan.root),
        fore_(upper_.at({0, 0, kElbowZ}).turned({-1, 0, 0}, plan.bend_degrees)),
        hand_(fore_.at({0, 0, kWristZ}).turned({0, 0, 1}, -kPronation)) {}

  void build() {
    add_rig();
    add_flesh();
    add_upper_arm_bones();
    add_forearm_bones();
    add_hand_bones();
    for (int i = 0; i < 4; ++i) add_finger(kFingers[i]);
    add_thumb();
    add_upper_arm_muscles();
    add_forearm_muscles();
    add_cords();
  }

 private:
  Anatomy& anatomy_;
  const LimbPlan& plan_;
  Frame upper_, fore_, hand_;
  int palm_ = 0, hand_bone_ = 0;

  double thin(double radius) const { return std::max(radius, plan_.thinnest_radius); }
  void muscle(Label label, const Frame& frame, std::initializer_list<T> tube) {
    anatomy_.muscles.push_back({Solid().add_tube(frame, std::vector<T>(tube)), label});
  }
  void muscle(Label label, const Shape& shape) { anatomy_.muscles.push_back({Solid(shape), label}); }
  void cord(Label label, std::vector<T> points) {
    for (T& p : points) p.w = thin(p.w);
    anatomy_.inner.push_back({Solid().add_tube({}, points), label});
  }
  static T in(const Frame& f, const V& p, double radius) { return T(f.point(p), radius); }

  void add_rig() {
    const double bend = plan_.bend_degrees;
    const auto& name = plan_.prefix;
    const V wrist = hand_.point(kWristCentre);
    const int upper =
        anatomy_.add_rig_bone(name + "UpperArm", plan_.rig_parent, upper_.origin, fore_.origin, ball(120, -70, 90));
    const int fore = anatomy_.add_rig_bone(name + "Forearm", upper, fore_.origin, wrist,
                                           hinge(upper_.turn_axis({-1, 0, 0}), -bend, 145 - bend));
    hand_bone_ = anatomy_.add_rig_bone(name + "Hand", fore, wrist, hand_.point({1, 2, -34}), ball(70, -10, 10));
  }

  void add_flesh() {
    Solid upper(Loft(upper_,
                     {{36, {8, 1}, {30, 33}},
                      {16, {9, 0}, {40, 44}},
                      {-12, {9, 0}, {45, 49}},
                      {-45, {8, 0}, {46, 50}},
                      {-90, {5, 0}, {42, 47}},
                      {-140, {2, 0}, {40, 47}},
                      {-180, {1, -1}, {40, 46}},
                      {-225, {0, 0}, {38, 41}},
                      {-262, {0, 1}, {39, 38}},
                      {-296, {-1, 2}, {41, 37}},
                      {-312, {-1, 2}, {40, 35}}},
                     26));
    upper
        .add(cone(upper_, {32, -2, -20}, 22, {24, 0, -100}, 14), 26)    // deltoid
        .add(cone(upper_, {2, -27, -110}, 16, {1, -31, -180}, 18), 18)  // biceps
        .add(cone(upper_, {1, -31, -180}, 18, {2, -25, -262}, 11), 22)
        .add(cone(upper_, {15, 26, -85}, 18, {17, 26, -160}, 19), 22)  // triceps
        .add(cone(upper_, {-12, 26, -110}, 18, {-13, 21, -195}, 17), 22);
    const int upper_arm = anatomy_.add_flesh(upper, plan_.flesh_parent, 30, 4.5);

    Solid fore(Loft(fore_,
                    {{16, {0, 1}, {38, 36}},
                     {-12, {0, -1}, {45, 41}},
                     {-50, {0, -2}, {45, 43}},
                     {-95, {0, -1}, {39, 41}},
                     {-145, {0, 0}, {31, 36}},
                     {-195, {0, 0}, {24, 31}},
                     {-232, {0, 0}, {21, 28.5}},
                     {-262, {0, 0}, {20, 28}}},
                    14));
    fore.add(cone(fore_, {24, -16, 6}, 16, {19, -22, -70}, 18), 22)    // brachioradialis
        .add(cone(fore_, {-24, -2, -20}, 18, {-18, -4, -90}, 19), 22)  // forearm flexors
        .add(cone(fore_, {-6, 22, 8}, 15, {-4, 25, -40}, 13), 16);     // olecranon
    const int forearm = anatomy_.add_flesh(fore, upper_arm, 22, 3.5);

    Solid palm(Loft(hand_,
                    {{22, {0, 0}, {28, 20}},
                     {-4, {0, 0}, {29, 19.5}},
                     {-30, {0, -1}, {35, 19}},
                     {-62, {-3, 0}, {42, 17}},
                     {-90, {-4, 1}, {43, 14.5}},
                     {-103, {-4, 1}, {40, 12}}},
                    11));
    palm.add(cone(hand_, {21, -12, -24}, 13, {29, -15, -58}, 13), 14)   // thenar
        .add(cone(hand_, {-20, -9, -22}, 12, {-30, -9, -64}, 11), 14);  // hypothenar
    palm_ = anatomy_.add_flesh(palm, forearm, 16, 2.2);
  }

  void add_upper_arm_bones() {
    Solid humerus;
    humerus.add(cone(upper_, {13, 0, -24}, 14.5, {7, 2, -95}, 11))
        .add(cone(upper_, {7, 2, -95}, 11, {1, 5, -210}, 9.5), 4)
        .add(cone(upper_, {1, 5, -210}, 9.5, {0, 8, -272}, 9), 4)
        .add(cone(upper_, {0, 7, -258}, 8.5, {-27, 5, -292}, 6), 12)  // medial epicondyle
        .add(cone(upper_, {0, 7, -258}, 8.5, {23, 5, -291}, 6), 12)   // lateral epicondyle
        .add(cone(upper_, {17, -3, -6}, 13, {14, 0, -26}, 13), 8);    // greater tubercle
    // Cuts the hollows in which the olecranon, the coronoid process and the radial head move.
    for (int degrees = 50; degrees <= 110; degrees += 15) {
      const double angle = glm::radians(static_cast<double>(degrees));
      humerus.cut(ball_at(upper_, V(-8, 17.5 * std::sin(angle), kElbowZ + 17.5 * std::cos(angle)), 11), 2);
    }
    for (int degrees = 15; degrees <= 135; degrees += 20) {
      const double angle = glm::radians(static_cast<double>(degrees));
      const V arc(0, -std::sin(angle), std::cos(angle));
      humerus.cut(ball_at(upper_, V(-8, 0, kElbowZ) + 18.0 * arc, 6.5), 2)
          .cut(ball_at(upper_, V(15, 0, kElbowZ) + 18.0 * arc, 6.5), 2);
    }
    humerus
        .add(cone(upper_, {-17, 0, kElbowZ}, 12, {-4, 0, kElbowZ}, 10), 3)    // trochlea
        .add(cone(upper_, {-4, 0, kElbowZ}, 9.5, {14, 0, kElbowZ}, 10.5), 3)  // capitulum
        .add(ball_at(upper_, V(0), 23), 8);                                   // head of the humerus
    anatomy_.add_long_bone(humerus, 4.2, upper_.point({12, 0, -35}), upper_.point({1, 6, -262}));
  }

  void add_forearm_bones() {
    const V radius_end(12, 0, 2), ulna_end(-13, 3, 5);  // ends of radius and ulna at the wrist, hand frame
    Solid ulna;
    ulna.add(cone(fore_, {-8, 15, 9}, 8, {-8, 14, -20}, 10))
        .add(cone(fore_, {-8, 6, -22}, 9, {-8, -12, -13}, 5), 6)  // coronoid process
        .add(cone(fore_, {-8, 12, -20}, 10.5, {-7, 14, -80}, 7.5), 6);
    const V shaft = fore_.point({-7, 14, -80});
    ulna.add(Cone{shaft, hand_.point(ulna_end + V(0, 0, 30)), 7.5, 5.5}, 5)
        .add(Cone{hand_.point(ulna_end + V(0, 0, 30)), hand_.point(ulna_end), 5.5, 7}, 4)
        .cut(cone(fore_, {-30, 0, 0}, 12 + 2.2, {-4, 0, 0}, 10 + 2.2))
        .cut(cone(fore_, {-4, 0, 0}, 12, {16, 0, 0}, 12));
    anatomy_.add_long_bone(ulna, 3, fore_.point({-8, 13, -30}), hand_.point(ulna_end + V(0, 0, 22)));

    Solid radius;
    const V tuberosity = fore_.point({11, -3, -45}), bow = fore_.point({15, -8, -125});
    radius.add(cone(fore_, {15, 0, -17}, 10, {15, 0, -19}, 10))
        .add(Cone{fore_.point({15, 0, -20}), tuberosity, 7, 7.5}, 4)
        .add(Cone{tuberosity, bow, 7.2, 6.8}, 6)
        .add(Cone{bow, hand_.point(radius_end + V(-1, 0, 38)), 6.8, 8}, 8)
        .add(Cone{hand_.point(radius_end + V(-1, 0, 38)), hand_.point(radius_end + V(0, 0, -1)), 8, 11.5}, 8)
        .add(ellipsoid(hand_, {10, 0, 2}, {15, 10.5, 12}), 5)
        .cut(ball_at(fore_, {14, 0, 0}, 10.5 + 2.2))
        .cut(ball_at(hand_, kWristCentre, 17 + 2.2))
        .cut(Cone{hand_.point(ulna_end + V(0, 0, 14)), hand_.point(ulna_end + V(0, 0, -8)), 9, 9});
    anatomy_.add_long_bone(radius, 2.8, fore_.point({13, -2, -38}), hand_.point({10, 0, 26}));
  }

  void add_hand_bones() {
    // The eight carpals are one bone part, since they move together. The row next to the forearm is round about the
    // wrist's centre.
    Solid carpus;
    carpus
        .add(ellipsoid(hand_, {11, 0, -9}, {8, 8, 9}))          // scaphoid
        .add(ellipsoid(hand_, {1, 0, -8}, {7.5, 8, 8}), 2)      // lunate
        .add(ellipsoid(hand_, {-9, 0, -12}, {7, 7, 7}), 2)      // triquetrum
        .add(ellipsoid(hand_, {-14, -8, -14}, {4.5, 5, 5}), 2)  // pisiform
        .add(ellipsoid(hand_, {17, -4, -22}, {7.5, 7, 7}), 2)   // trapezium
        .add(ellipsoid(hand_, {10, 2, -24}, {6, 7, 7}), 2)      // trapezoid
        .add(ellipsoid(hand_, {2, 1, -22}, {6.5, 8.5, 10}), 2)  // capitate
        .add(ellipsoid(hand_, {-8, 0, -24}, {7.5, 8, 8}), 2);   // hamate
    anatomy_.add_bone(carpus, 1.4);
  }

  // Adds a phalanx (finger bone) along -z of `frame`. The frame's origin is the centre of the joint about which the
  // phalanx rotates.
  //   head_before, head  radii of the head of the bone before and of the phalanx's own head, mm
  //   last               true: the phalanx at the finger's tip
  void add_phalanx(const Frame& frame, double length, double head_before, double head, bool last) {
    const double base = 0.98 * head_before, shaft = 0.62 * (last ? head : 0.5 * (head + head_before));
    Solid bone(cone(frame, {0, 0, -(0.6 * head_before + kGap)}, base, {0, 0, -0.30 * length}, shaft * 1.05));
    const V end(0, 0, last ? -length + head : -length);
    bone.add(cone(frame, {0, 0, -0.30 * length}, shaft * 1.05, {0, 0, -0.75 * length}, shaft), 3)
        .add(cone(frame, {0, 0, -0.72 * length}, shaft, end, head), 3)
        .cut(ball_at(frame, V(0), head_before + kGap));
    anatomy_.add_long_bone(bone, std::max(1.1, 0.26 * head_before), frame.point({0, 0, -0.30 * length}),
                           frame.point({0, 0, -0.82 * length}));
  }

  // Adds the flesh, the nail and the two tendons (flexor and extensor) of a finger or thumb.
  //   joints, lengths  the frame of each of its bones, with the joint as origin, and the bone's length, mm
  //   flesh, blend     radius at the first joint, and width of the blend with the palm, mm
  void add_digit_flesh(const std::vector<Frame>& joints, const std::vector<double>& lengths, double flesh,
                       double blend) {
    Solid digit;
    std::vector<T> flexor, extensor;
    double radius = flesh;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const double next = radius * (i + 1 == joints.size() ? 0.80 : 0.90);
      const bool last = i + 1 == joints.size();
      const V end(0, last ? -1.2 : -0.6, last ? -lengths[i] + 0.35 * next : -lengths[i]);
      digit.add(cone(joints[i], {0, -0.6, 0}, radius, {0, -1.6, -0.5 * lengths[i]}, 0.5 * (radius + next) * 0.97), 2)
          .add(cone(joints[i], {0, -1.6, -0.5 * lengths[i]}, 0.5 * (radius + next) * 0.97, end, next), 2);
      flexor.push_back(in(joints[i], {0, -0.70 * radius, last ? -2.0 : 0.0}, 1.6));
      if (last) flexor.push_back(in(joints[i], {0, -0.5 * radius, -0.35 * lengths[i]}, 1.4));
      extensor.push_back(in(joints[i], {0, 0.62 * radius, 0}, 1.2));
      if (last) extensor.push_back(in(joints[i], {0, 0.45 * radius, -0.3 * lengths[i]}, 1.1));
      radius = next;
    }
    anatomy_.add_flesh(digit, palm_, blend, 1.6);
    cord(kTendon, flexor);
    cord(kTendon, extensor);
    const Frame& end = joints.back();
    const double length = lengths.back();
    anatomy_.nails.push_back(
        Solid(ellipsoid(end, {0, 1.05 * radius, -0.72 * length}, {0.72 * radius, 0.75 * radius, 0.30 * length})));
  }

  void add_finger(const Finger& finger) {
    const auto& name = plan_.prefix + finger.name;
    Solid metacarpal(
        cone(hand_, finger.base, 0.92 * finger.bone, glm::mix(finger.base, finger.head, 0.3), 0.62 * finger.bone));
    metacarpal
        .add(cone(hand_, glm::mix(finger.base, finger.head, 0.3), 0.62 * finger.bone,
                  glm::mix(finger.base, finger.head, 0.75), 0.60 * finger.bone),
             3)
        .add(cone(hand_, glm::mix(finger.base, finger.head, 0.7), 0.6 * finger.bone, finger.head, finger.bone), 4);
    anatomy_.add_long_bone(metacarpal, 1.7, hand_.point(glm::mix(finger.base, finger.head, 0.2)),
                           hand_.point(glm::mix(finger.base, finger.head, 0.85)));
    const bool mobile = finger.head.x < 0;
    const V flex(-1, 0, 0);
    int parent = anatomy_.add_rig_bone(
        name + "Metacarpal", hand_bone_, hand_.point(finger.base + V(0, 0, 6)), hand_.point(finger.head),
        mobile ? hinge(hand_.turn_axis(flex), -5, 15) : hinge(hand_.turn_axis(flex), 0, 5));

    // Adds the muscle that fills the space between this metacarpal and the next one.
    muscle(kHandMuscles, cone(hand_, finger.base + V(7, -3, -8), 5, finger.head + V(8, -4, 12), 4));

    constexpr const char* kPhalanges[] = {"Proximal", "Middle", "Distal"};
    const double heads[] = {finger.bone, 0.72 * finger.bone, 0.58 * finger.bone, 0.5 * finger.bone};
    Frame joint = hand_.at(finger.head).turned({0, 1, 0}, -finger.spread);
    std::vector<Frame> joints;
    for (int i = 0; i < 3; ++i) {
      const V axis = joint.turn_axis(flex);
      joint = joint.turned(flex, kRestBend[i]);
      joints.push_back(joint);
      const double length = finger.lengths[i];
      add_phalanx(joint, length, heads[i], heads[i + 1], i == 2);
      parent = anatomy_.add_rig_bone(name + kPhalanges[i], parent, joint.origin, joint.point({0, 0, -length}),
                                     hinge(axis, -kMostBack[i] - kRestBend[i], kMostBend[i] - kRestBend[i]));
      joint = joint.at({0, 0, -length});
    }
    add_digit_flesh(joints, {finger.lengths.begin(), finger.lengths.end()}, finger.flesh, 9);
  }

  void add_thumb() {
    const auto& name = plan_.prefix;
    constexpr double kHead = 7, kLengths[] = {45, 33, 27};
    // Places the thumb: spread to the side, in front of the palm, and rolled so that its pad faces the fingers.
    Frame joint = hand_.at({21, -8, -29}).turned({0, 1, 0}, -36).turned({-1, 0, 0}, 24).turned({0, 0, 1}, -58);
    const V flex(-1, 0, 0);
    Solid metacarpal(cone(joint, {0, 0, -5}, 6.8, {0, 0, -16}, 4.8));
    metacarpal.add(cone(joint, {0, 0, -16}, 4.8, {0, 0, -34}, 4.8), 3)
        .add(cone(joint, {0, 0, -32}, 4.8, {0, 0, -45}, kHead), 4);
    anatomy_.add_long_bone(metacarpal, 1.8, joint.point({0, 0, -11}), joint.point({0, 0, -39}));
    int parent = anatomy_.add_rig_bone(name + "ThumbMetacarpal", hand_bone_, joint.origin,
                                       joint.point({0, 0, -kLengths[0]}), ball(35, -15, 15));
    std::vector<Frame> joints{joint};
    const double heads[] = {kHead, 5.6, 4.4}, rest[] = {12, 12}, most[] = {60, 80};
    for (int i = 1; i < 3; ++i) {
      joint = joint.at({0, 0, -kLengths[i - 1]});
      const V axis = joint.turn_axis(flex);
      joint = joint.turned(flex, rest[i - 1]);
      joints.push_back(joint);
      add_phalanx(joint, kLengths[i], heads[i - 1], heads[i], i == 2);
      parent = anatomy_.add_rig_bone(name + (i == 1 ? "ThumbProximal" : "ThumbDistal"), parent, joint.origin,
                                     joint.point({0, 0, -kLengths[i]}),
                                     hinge(axis, -10 - rest[i - 1], most[i - 1] - rest[i - 1]));
    }
    add_digit_flesh(joints, {kLengths[0], kLengths[1], kLengths[2]}, 13.2, 14);
    muscle(kHandMuscles, cone(hand_, {14, -12, -28}, 9, {30, -15, -58}, 9));  // thenar
    muscle(kHandMuscles, cone(hand_, {-18, -9, -24}, 8, {-30, -8, -66}, 7));  // hypothenar
    muscle(kHandMuscles, cone(hand_, {10, -9, -62}, 5, {30, -10, -62}, 7));   // adductor of the thumb
  }

  void add_upper_arm_muscles() {
    muscle(kDeltoid, upper_, {{16, -26, 20, 14}, {26, -18, -40, 16}, {16, -4, -115, 6}});
    muscle(kDeltoid, upper_, {{26, 2, 20, 14}, {36, 2, -40, 16}, {17, 2, -115, 7}});
    muscle(kDeltoid, upper_, {{16, 28, 18, 14}, {28, 20, -40, 15}, {16, 6, -110, 6}});
    muscle(kBiceps, upper_,
           {{10, -22, -30, 6}, {8, -27, -100, 12}, {7, -28, -170, 17}, {5, -25, -235, 11}, {3, -20, -262, 4}});
    muscle(kBiceps, upper_, {{-8, -20, -40, 6}, {-7, -27, -110, 12}, {-7, -28, -175, 15}, {-2, -24, -235, 9}});
    muscle(kBrachialis, upper_, {{14, -4, -130, 6}, {12, -8, -180, 12}, {0, -12, -240, 15}, {-6, -14, -285, 8}});
    muscle(kTriceps, upper_, {{0, 24, -30, 7}, {-10, 26, -110, 16}, {-12, 25, -180, 17}, {-8, 22, -250, 8}});
    muscle(kTriceps, upper_, {{20, 20, -60, 8}, {20, 24, -130, 17}, {16, 23, -190, 16}, {4, 23, -255, 8}});
    muscle(kTriceps, upper_, {{2, 16, -140, 8}, {2, 17, -220, 11}, {0, 20, -270, 7}});
    muscle(kShoulderMuscles, upper_, {{-18, -4, -20, 12}, {-10, -6, -90, 8}, {-6, -4, -140, 5}});  // coracobrachialis
    muscle(kShoulderMuscles, upper_, {{-16, 10, 10, 14}, {-14, 14, -30, 12}});
  }

  void add_forearm_muscles() {
    anatomy_.muscles.push_back({Solid(Cone{upper_.point({21, -6, -228}), fore_.point({25, -17, -10}), 8, 13})
                                    .add(Cone{fore_.point({25, -17, -10}), fore_.point({19, -25, -90}), 13, 10})
                                    .add(Cone{fore_.point({19, -25, -90}), hand_.point({20, -2, 70}), 10, 4}),
                                kBrachioradialis});
    muscle(kForearmFlexors, fore_, {{-24, -4, 4, 9}, {-22, -10, -55, 13}, {-16, -14, -120, 10}, {-10, -14, -190, 5}});
    muscle(kForearmFlexors, fore_, {{-22, 12, -20, 9}, {-22, 16, -80, 12}, {-16, 18, -150, 8}, {-12, 18, -215, 4}});
    muscle(kForearmFlexors, fore_, {{-12, 0, -60, 10}, {-12, 2, -130, 11}, {-10, 2, -200, 7}});
    muscle(kForearmFlexors, fore_, {{-10, -22, -20, 8}, {-4, -24, -70, 11}, {0, -20, -120, 6}});
    muscle(kForearmExtensors, fore_, {{24, 8, 4, 8}, {26, 4, -60, 13}, {18, 2, -140, 9}, {15, 0, -210, 5}});
    muscle(kForearmExtensors, fore_, {{16, 20, -20, 9}, {18, 24, -80, 12}, {13, 18, -160, 8}, {12, 12, -215, 4}});
    muscle(kForearmExtensors, fore_, {{8, 8, -90, 8}, {10, 4, -150, 9}, {11, -6, -210, 5}});
  }

  // Adds tendons, arteries, veins and nerves.
  void add_cords() {
    cord(kTendon, {in(upper_, {4, -24, -235}, 4.5), in(upper_, {4, -19, -272}, 3.2), in(fore_, {9, -14, -26}, 3),
                   in(fore_, {9, -8, -45}, 2.6)});
    cord(kTendon, {in(upper_, {0, 23, -205}, 3.5), in(upper_, {-4, 25, -262}, 4), in(fore_, {-8, 24, 8}, 4)});
    // Each finger has one tendon through the carpal tunnel and one over the back of the hand.
    for (int i = 0; i < 4; ++i) {
      const Finger& f = kFingers[i];
      const double side = 5 - 3.5 * i;
      cord(kTendon, {in(hand_, {side * 1.2, -11, 75}, 1.8), in(hand_, {side, -12.5, 0}, 1.9),
                     in(hand_, {side, -11, -32}, 1.9), in(hand_, f.head + V(0, -0.95 * f.bone - 1.5, 14), 1.8),
                     in(hand_, f.head + V(0, -0.70 * f.flesh, 0), 1.6)});
      cord(kTendon,
           {in(hand_, {side * 1.2, 12, 65}, 1.6), in(hand_, {side, 13, 0}, 1.6),
            in(hand_, f.head + V(0, 0.62 * f.flesh, 10), 1.3), in(hand_, f.head + V(0, 0.62 * f.flesh, 0), 1.2)});
    }
    cord(kTendon, {in(hand_, {20, 2, 70}, 2), in(hand_, {22, 4, 0}, 1.8),
                   in(hand_, {27, 0, -34}, 1.5)});                                // long abductor of the thumb
    cord(kTendon, {in(hand_, {-21, -6, 60}, 2), in(hand_, {-17, -10, -10}, 2)});  // flexor carpi ulnaris
    cord(kArtery, {in(upper_, {-20, -8, -20}, 2.6), in(upper_, {-22, -8, -120}, 2.4), in(upper_, {-16, -16, -230}, 2.3),
                   in(fore_, {0, -20, -18}, 2.2), in(fore_, {0, -12, -40}, 2)});
    cord(kArtery, {in(fore_, {0, -12, -40}, 1.7), in(fore_, {6, -22, -130}, 1.6), in(hand_, {16, -11, 20}, 1.5),
                   in(hand_, {20, -8, -12}, 1.4)});
    cord(kArtery, {in(fore_, {0, -12, -40}, 1.7), in(fore_, {-16, 8, -120}, 1.6), in(hand_, {-15, -12, 20}, 1.5),
                   in(hand_, {-8, -13, -45}, 1.4)});
    cord(kVein, {in(upper_, {18, -46, -20}, 1.8), in(upper_, {20, -43, -150}, 1.8), in(upper_, {20, -36, -255}, 1.8),
                 in(fore_, {24, -34, -60}, 1.7), in(hand_, {22, 12, 40}, 1.5), in(hand_, {12, 15, -40}, 1.3)});
    cord(kVein, {in(upper_, {-26, -2, -30}, 2.2), in(upper_, {-36, 0, -200}, 2), in(upper_, {-33, -14, -285}, 1.8),
                 in(fore_, {-34, 12, -80}, 1.7), in(hand_, {-18, 14, 40}, 1.5), in(hand_, {-14, 14, -45}, 1.3)});
    cord(kNerve, {in(upper_, {-18, -2, -20}, 1.9), in(upper_, {-20, -14, -150}, 1.9), in(upper_, {-12, -20, -260}, 1.8),
                  in(fore_, {-6, -12, -60}, 1.8), in(fore_, {-9, -6, -160}, 1.7), in(hand_, {2, -14, 30}, 1.7),
                  in(hand_, {4, -14, -20}, 1.7)});
    cord(kNerve, {in(upper_, {-22, 4, -20}, 1.7), in(upper_, {-22, 8, -150}, 1.7), in(upper_, {-25, 14, -285}, 1.7),
                  in(fore_, {-18, 8, -40}, 1.6), in(hand_, {-14, -10, 40}, 1.5), in(hand_, {-12, -14, -16}, 1.5)});
    cord(kNerve, {in(upper_, {-12, 12, -20}, 1.7), in(upper_, {14, 16, -130}, 1.7), in(upper_, {20, -6, -240}, 1.7),
                  in(fore_, {18, -14, -30}, 1.5), in(fore_, {16, -24, -130}, 1.3)});
  }
};
}  // namespace

void add_arm(Anatomy& anatomy, const LimbPlan& plan) { Arm(anatomy, plan).build(); }

}  // namespace limber::phantom
