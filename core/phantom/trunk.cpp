// SPDX-License-Identifier: AGPL-3.0-or-later
// Builds pelvis, spine, rib cage, organs, shoulder girdle, neck and head in world coordinates, mm. The soles are at z =
// 0, the plane between left and right is x = 0, and the belly points towards -y. The thoracic vertebrae, ribs and
// breastbone are one bone part, since they move together.
#include <cmath>
#include <numbers>

#include "core/phantom/limbs.h"

namespace limber::phantom {

namespace {
using V = glm::dvec3;
using T = glm::dvec4;  // a point and a radius

constexpr V kHip(88, 0, 915), kShoulder(180, 16, 1430);
constexpr double kSpine[][2] = {{985, 52},  {1020, 44}, {1080, 34}, {1150, 40}, {1250, 60},
                                {1350, 64}, {1430, 50}, {1500, 34}, {1560, 26}, {1600, 20}};
// Elliptic cross sections of the rib cage, mm: height z, half the width, half the depth, and y of the centre.
constexpr double kCage[][4] = {{1120, 118, 84, 2}, {1170, 128, 92, 2}, {1240, 136, 97, 2}, {1300, 134, 95, 4},
                               {1360, 122, 86, 8}, {1410, 96, 70, 14}, {1445, 62, 50, 20}, {1465, 44, 38, 22}};

template <std::size_t N, std::size_t M>
double along(const double (&table)[N][M], double z, int column) {
  for (std::size_t i = 0; i + 1 < N; ++i)
    if (z <= table[i + 1][0]) {
      const double t = std::max(0.0, (z - table[i][0]) / (table[i + 1][0] - table[i][0]));
      return table[i][column] + t * (table[i + 1][column] - table[i][column]);
    }
  return table[N - 1][column];
}
double spine_y(double z) { return along(kSpine, z, 1); }

Cone cone(const V& a, double radius_a, const V& b, double radius_b) { return {a, b, radius_a, radius_b}; }
Cone ball_at(const V& centre, double radius) { return {centre, centre + V(0, 0, 0.01), radius, radius}; }
Ellipsoid ellipsoid(const V& centre, const V& radii) { return {Frame{centre, glm::dmat3(1)}, radii}; }
Solid tube(const std::vector<T>& points, double blend = 0) { return Solid().add_tube({}, points, blend); }
V mirrored(const V& p, double side) { return {side * p.x, p.y, p.z}; }
std::vector<T> mirrored(std::vector<T> points, double side) {
  for (T& p : points) p.x *= side;
  return points;
}

class Trunk {
 public:
  Trunk(Anatomy& anatomy, double thinnest) : anatomy_(anatomy), thinnest_(thinnest) {}

  TrunkJoints build() {
    add_rig();
    add_flesh();
    add_pelvis();
    add_spine();
    add_rib_cage();
    add_skull();
    for (double side : {-1.0, 1.0}) add_shoulder_girdle(side);
    add_head_organs();
    add_vessels();
    add_abdomen();
    add_chest();
    for (double side : {-1.0, 1.0}) add_muscles(side);
    return {torso_, hips_, kHip, kShoulder};
  }

 private:
  Anatomy& anatomy_;
  double thinnest_;
  int torso_ = 0, hips_ = 0, chest_ = 0;

  void inner(Label label, Solid solid) { anatomy_.inner.push_back({std::move(solid), label}); }
  void cord(Label label, std::vector<T> points) {
    for (T& p : points) p.w = std::max(p.w, thinnest_);
    inner(label, tube(points));
  }
  void muscle(Label label, Solid solid) { anatomy_.muscles.push_back({std::move(solid), label}); }

  void add_rig() {
    const V lumbar(0, spine_y(1005), 1005), thorax(0, spine_y(1165), 1165), neck(0, spine_y(1470), 1470),
        head(0, 20, 1588);
    hips_ = anatomy_.add_rig_bone("Hips", -1, {0, 12, 925}, lumbar);
    const int spine = anatomy_.add_rig_bone("Spine", hips_, lumbar, thorax, ball(45, -25, 25));
    chest_ = anatomy_.add_rig_bone("Chest", spine, thorax, neck, ball(35, -35, 35));
    const int neck_bone = anatomy_.add_rig_bone("Neck", chest_, neck, head, ball(45, -45, 45));
    const int head_bone = anatomy_.add_rig_bone("Head", neck_bone, head, {0, 0, 1748}, ball(35, -35, 35));
    anatomy_.add_rig_bone("Jaw", head_bone, {0, -6, 1604}, {0, -78, 1548}, hinge({1, 0, 0}, 0, 30));
  }

  void add_flesh() {
    Solid torso(Loft({},
                     {{838, {0, 8}, {112, 82}, 2.2},
                      {880, {0, 10}, {152, 100}, 2.3},
                      {930, {0, 12}, {168, 108}, 2.4},
                      {985, {0, 10}, {165, 108}, 2.4},
                      {1045, {0, 4}, {150, 100}, 2.3},
                      {1105, {0, 0}, {141, 98}, 2.3},
                      {1170, {0, 0}, {148, 106}, 2.4},
                      {1250, {0, 0}, {160, 114}, 2.4},
                      {1330, {0, 4}, {166, 114}, 2.4},
                      {1390, {0, 10}, {158, 102}, 2.3},
                      {1430, {0, 16}, {132, 86}, 2.2},
                      {1465, {0, 20}, {92, 68}, 2},
                      {1490, {0, 22}, {66, 58}, 2}},
                     30));
    for (double side : {-1.0, 1.0})
      torso
          .add(cone(mirrored({46, 32, 1488}, side), 34, mirrored({158, 20, 1428}, side), 42), 44)    // shoulder
          .add(ellipsoid(mirrored({70, -74, 1362}, side), {84, 36, 66}), 44)                         // breast
          .add(ellipsoid(mirrored({74, 78, 918}, side), {78, 62, 78}), 34)                           // buttock
          .add(cone(mirrored({128, 52, 1370}, side), 34, mirrored({118, 48, 1240}, side), 26), 30);  // latissimus
    torso.cut(cone({0, 175, 1130}, 66, {0, 172, 1330}, 52), 40);  // furrow of the back
    torso_ = anatomy_.add_flesh(torso, -1, 40, 12);
    Solid neck(Loft({},
                    {{1440, {0, 22}, {66, 62}},
                     {1490, {0, 20}, {60, 59}},
                     {1530, {0, 14}, {57, 58}},
                     {1575, {0, 10}, {57, 62}},
                     {1610, {0, 8}, {56, 64}}},
                    12));
    const int neck_flesh = anatomy_.add_flesh(neck, torso_, 44, 5);
    Solid head(ellipsoid({0, 4, 1657}, {76, 97, 93}));
    head.add(ellipsoid({0, -34, 1606}, {60, 62, 72}), 24)
        .add(cone({-12, -70, 1548}, 22, {12, -70, 1548}, 22), 20)  // chin
        .add(cone({-20, -84, 1652}, 14, {20, -84, 1652}, 14), 18)  // brow
        .cut(ellipsoid({-32, -108, 1632}, {19, 18, 13}), 14)
        .cut(ellipsoid({32, -108, 1632}, {19, 18, 13}), 14)
        .add(cone({0, -96, 1636}, 7, {0, -113, 1600}, 9), 9)  // nose
        .add(cone({-9, -101, 1597}, 7, {9, -101, 1597}, 7), 6)
        .add(cone({-15, -91, 1574}, 8, {15, -91, 1574}, 8), 6)  // lips
        .add(cone({-13, -90, 1565}, 8, {13, -90, 1565}, 8), 5);
    for (double side : {-1.0, 1.0})
      head.add(cone(mirrored({42, -16, 1562}, side), 21, mirrored({14, -62, 1550}, side), 20), 18)
          .add(ball_at(mirrored({31, -78, 1630}, side), 15), 6)
          .add(cone(mirrored({46, -62, 1608}, side), 16, mirrored({58, -24, 1612}, side), 14), 18)  // cheek
          .add(ellipsoid(mirrored({77, 12, 1622}, side), {7, 17, 30}), 6);                          // ear
    anatomy_.add_flesh(head, neck_flesh, 22, 3);
  }

  void add_pelvis() {
    Solid pelvis;
    for (double side : {-1.0, 1.0}) {
      const auto at = [&](double x, double y, double z) { return V(side * x, y, z); };
      pelvis.add(Plate{at(122, -40, 1002), at(118, 22, 1044), at(78, 14, 938), 6}, 6)
          .add(Plate{at(118, 22, 1044), at(58, 74, 1014), at(78, 14, 938), 6}, 8)
          .add(Plate{at(58, 74, 1014), at(52, 68, 970), at(78, 14, 938), 7}, 8)
          .add(cone(at(122, -40, 1002), 8, at(118, 22, 1044), 8), 4)
          .add(cone(at(118, 22, 1044), 8, at(58, 74, 1014), 8), 4)
          .add(ball_at(at(80, 6, 922), 34), 10)
          .add(cone(at(76, -22, 908), 11, at(12, -52, 884), 11), 8)  // pubis
          .add(cone(at(80, 24, 900), 14, at(60, 34, 850), 15), 8)    // ischium
          .add(cone(at(58, 28, 846), 9, at(16, -42, 868), 8), 6)
          .add(cone(at(38, 70, 1004), 13, at(56, 70, 992), 13), 6);  // joint to the sacrum
    }
    pelvis.add(cone({-22, 66, 996}, 22, {22, 66, 996}, 22), 8)
        .add(cone({0, 68, 992}, 24, {0, 96, 935}, 14), 10)
        .add(cone({0, 96, 935}, 13, {0, 88, 895}, 6), 6);
    for (double side : {-1.0, 1.0})
      pelvis.cut(ball_at(mirrored(kHip, side), 26.5))
          .cut(cone(mirrored(kHip, side), 26.5, mirrored({150, 6, 885}, side), 30));
    anatomy_.add_bone(pelvis, 3);
  }

  // Adds the body, arch and processes of a vertebra. Between body and arch the spinal canal stays free.
  static void add_vertebra(Solid& bone, double z, double height, double width, double depth, double spine_length) {
    const double y = spine_y(z), back = y + depth;
    bone.add(Loft(Frame{V(0, y, z), glm::dmat3(1)},
                  {{-0.5 * height, {0, 0}, {width, depth}},
                   {0, {0, 0}, {0.92 * width, 0.92 * depth}},
                   {0.5 * height, {0, 0}, {width, depth}}},
                  3));
    const double ring = 14;
    for (double side : {-1.0, 1.0})
      bone.add(cone({side * 11, back - 3, z + 2}, 4.5, {side * ring, back + 10, z}, 5), 2)
          .add(cone({side * ring, back + 10, z}, 5, {0, back + 22, z - 2}, 5), 2)
          .add(cone({side * ring, back + 9, z}, 4.5, {side * (width + 14), back + 11, z + 1}, 3.5), 3);
    bone.add(cone({0, back + 22, z - 2}, 5, {0, back + 22 + spine_length, z - 0.5 * spine_length}, 3.5), 3);
  }

  void add_spine() {
    std::vector<T> discs;
    for (double z = 996; z <= 1596; z += 12) {
      const double t = (z - 996) / 600;
      discs.push_back(T(0, spine_y(z), z, 19 - 9 * t));
    }
    for (int i = 0; i < 5; ++i) {
      Solid lumbar;
      add_vertebra(lumbar, 1025 + 32 * i, 24, 24 - 0.6 * i, 17, 24);
      anatomy_.add_bone(lumbar, 1.8);
    }
    for (int i = 0; i < 7; ++i) {
      Solid cervical;
      add_vertebra(cervical, 1482 + 16.5 * i, 11.5, 12.5, 9, i == 0 ? 24 : 13);
      anatomy_.add_bone(cervical, 1.4);
    }
    std::vector<T> cord_points;
    for (double z = 1080; z <= 1610; z += 25) cord_points.push_back(T(0, spine_y(z) + 19 - 6 * (z - 1080) / 530, z, 5));
    cord(kSpinalCord, cord_points);
    inner(kDisc, tube(discs));
  }

  // Returns a point of a rib, which runs around the rib cage from t = 0 at the back to t = 1 at the front.
  //   z, drop  height of the rib at the back, and how much lower the rib is at the front, mm
  static V rib_point(double z, double drop, double t, double side) {
    const double height = z - drop * (1 - std::cos(std::numbers::pi * t)) / 2,
                 angle = std::numbers::pi * (0.10 + 0.78 * t);
    return {side * along(kCage, height, 1) * std::sin(angle),
            along(kCage, height, 3) + along(kCage, height, 2) * std::cos(angle) * 0.98, height};
  }

  void add_rib_cage() {
    Solid cage;
    for (int i = 0; i < 12; ++i) add_vertebra(cage, 1187 + 25 * i, 19, 21 - 0.45 * i, 14 - 0.2 * i, 20);
    // Adds rods between the arches of the thoracic vertebrae, which make them one connected bone part.
    for (double side : {-1.0, 1.0})
      for (int i = 0; i < 11; ++i) {
        const double z = 1187 + 25 * i;
        cage.add(cone({side * 13, spine_y(z) + 24, z}, 4.5, {side * 13, spine_y(z + 25) + 23.5, z + 25}, 4.5), 2);
      }
    for (double side : {-1.0, 1.0})
      for (int rib = 0; rib < 12; ++rib) {
        const double z = 1462 - 25 * rib, drop = 34 + 6.5 * std::min(rib, 9),
                     length = rib < 10 ? 0.86 : 0.95 - 0.2 * (rib - 8);
        std::vector<T> points{T(side * 12, spine_y(z) + 16, z, 5), T(side * 30, spine_y(z) + 25, z + 2, 5)};
        for (double t = 0.08; t < length; t += 0.07) points.push_back(T(rib_point(z, drop, t, side), 5.2));
        cage.add_tube({}, points, 2);
        if (rib >= 10) continue;
        // Adds the cartilage between ribs and breastbone. The eighth to tenth ribs end at the same point, the
        // breastbone's lower end.
        const V end = points.back();
        const double goal = rib < 7 ? 1420 - 23 * rib : 1272;
        const V at_sternum(side * 17, -70 - 36 * (1425 - goal) / 160, goal);
        cord(kCartilage, {T(end, 5.5), T(glm::mix(end, at_sternum, 0.5) + V(0, -6, -4), 5.5), T(at_sternum, 5)});
      }
    cage.add(Plate{{-18, -70, 1425}, {18, -70, 1425}, {0, -84, 1362}, 7}, 5)
        .add(Plate{{-12, -86, 1365}, {12, -86, 1365}, {0, -106, 1256}, 6.5}, 5);
    anatomy_.add_bone(cage, 1.6);
  }

  void add_shoulder_girdle(double side) {
    const auto at = [&](double x, double y, double z) { return V(side * x, y, z); };
    const std::string prefix = side > 0 ? "Left" : "Right";
    anatomy_.add_rig_bone(prefix + "Clavicle", chest_, at(22, -66, 1434), mirrored(kShoulder, side), ball(30, -20, 20));
    anatomy_.add_bone(
        tube(mirrored({{25, -68, 1436, 9}, {62, -64, 1444, 7}, {115, -24, 1455, 6.5}, {166, 6, 1462, 7}}, side), 6),
        1.8);
    Solid scapula(Plate{at(142, 36, 1420), at(78, 76, 1432), at(98, 92, 1300), 4.5});
    scapula.add(cone(at(84, 82, 1418), 5, at(152, 66, 1450), 6.5), 5)
        .add(cone(at(152, 66, 1450), 6.5, at(190, 30, 1467), 6.5), 5)  // acromion
        .add(cone(at(142, 34, 1422), 9, at(150, 26, 1424), 17), 6)     // socket
        .add(cone(at(142, 26, 1436), 7, at(146, -14, 1432), 6), 5)     // coracoid process
        .cut(ball_at(mirrored(kShoulder, side), 26));
    anatomy_.add_bone(scapula, 1.5);
  }

  void add_skull() {
    Solid skull(ellipsoid({0, 5, 1660}, {69, 89, 84}));
    skull.add(ellipsoid({0, -52, 1602}, {36, 32, 38}), 10).add(cone({0, 8, 1594}, 26, {0, 40, 1600}, 26), 14);
    for (double side : {-1.0, 1.0}) {
      const auto at = [&](double x, double y, double z) { return V(side * x, y, z); };
      skull.add(cone(at(30, -70, 1606), 9, at(54, -54, 1610), 8), 5)
          .add(cone(at(54, -54, 1610), 6, at(63, -8, 1616), 5), 4)   // cheek bone
          .add(cone(at(22, -80, 1650), 7, at(50, -60, 1640), 6), 6)  // brow
          .add(cone(at(58, 26, 1606), 11, at(54, 20, 1590), 7), 6);  // mastoid
    }
    skull.cut(ellipsoid({0, 7, 1664}, {62, 81, 76})).cut(cone({0, 24, 1540}, 13, {0, 20, 1610}, 13));
    for (double side : {-1.0, 1.0}) skull.cut(ball_at({side * 31, -76, 1630}, 17), 3);
    skull.cut(ellipsoid({0, -78, 1606}, {10, 26, 17}), 3);
    anatomy_.add_bone(skull, 2.2);
    Solid jaw;
    for (double side : {-1.0, 1.0})
      jaw.add_tube({}, mirrored({{47, -4, 1602, 6}, {44, -14, 1566, 7}, {30, -52, 1550, 7.5}, {0, -76, 1548, 9}}, side),
                   4);
    anatomy_.add_bone(jaw, 1.8);
  }

  void add_head_organs() {
    inner(kBrain, Solid(ellipsoid({0, 7, 1664}, {60, 79, 74})).add(ellipsoid({0, 42, 1616}, {44, 30, 22}), 8));
    for (double side : {-1.0, 1.0}) inner(kEye, Solid(ball_at({side * 31, -78, 1630}, 12)));
    inner(kTongue, Solid(ellipsoid({0, -46, 1568}, {20, 28, 15})));
    inner(kTrachea, Solid(ellipsoid({0, -72, 1606}, {9, 24, 15})));
    cord(kTrachea, {{0, -36, 1596, 8}, {0, -6, 1576, 9}, {0, -12, 1510, 8.5}, {0, 6, 1440, 8.5}, {0, 14, 1372, 8.5}});
    for (double side : {-1.0, 1.0}) cord(kTrachea, {{0, 14, 1374, 7.5}, {side * 46, 18, 1338, 6}});
    cord(kOesophagus, {{0, 6, 1560, 6}, {0, 12, 1490, 6}, {2, 28, 1400, 6.5}, {6, 34, 1280, 7}, {22, 8, 1222, 7}});
    for (double side : {-1.0, 1.0}) {
      cord(kArtery, {{side * 10.0, -14, 1424, 3.5},
                     {side * 22.0, -8, 1490, 3.2},
                     {side * 28.0, -2, 1570, 3},
                     {side * 26.0, 2, 1600, 2.6}});
      cord(kVein, {{side * 18.0, -26, 1430, 4.5}, {side * 32.0, -12, 1500, 4.5}, {side * 36.0, 4, 1580, 4}});
    }
  }

  void add_vessels() {
    inner(kHeart, Solid(Ellipsoid{Frame{V(14, -36, 1296), glm::dmat3(1)}.turned({0, 1, 0}, -38).turned({1, 0, 0}, -20),
                                  {42, 38, 58}})
                      .add(ellipsoid({-12, -22, 1318}, {30, 28, 34}), 12));
    cord(kArtery, {{6, -30, 1330, 13},
                   {-4, -24, 1392, 12},
                   {10, 6, 1406, 11.5},
                   {16, 28, 1370, 11},
                   {14, 26, 1250, 10.5},
                   {8, 14, 1130, 9.5},
                   {4, 14, 1052, 8.5}});
    cord(kVein, {{-26, -24, 1420, 8}, {-26, -16, 1350, 9}});
    cord(kVein, {{-22, -6, 1300, 10}, {-20, 8, 1230, 10}, {-14, 14, 1120, 9.5}, {-10, 16, 1048, 9}});
    for (double side : {-1.0, 1.0}) {
      cord(kArtery,
           {{4, 14, 1052, 6.5}, {side * 40, 8, 990, 5.5}, {side * 84.0, -38, 940, 5}, {side * 89.0, -40, 918, 4.6}});
      cord(kVein,
           {{-10, 16, 1048, 7}, {side * 36, 16, 992, 6.5}, {side * 76.0, -36, 938, 5.5}, {side * 80.0, -42, 916, 5}});
      cord(kArtery, {{side * 10.0, -8, 1420, 4.6},
                     {side * 60.0, -6, 1448, 4.4},
                     {side * 118.0, 2, 1432, 4},
                     {side * 156.0, 6, 1408, 3.4}});
      cord(kVein, {{side * 24.0, -26, 1426, 5},
                   {side * 66.0, -22, 1438, 4.8},
                   {side * 118.0, -10, 1422, 4.2},
                   {side * 154.0, -6, 1400, 3.6}});
      cord(kNerve, {{side * 16.0, 30, 1500, 2.6},
                    {side * 70.0, 14, 1452, 3.2},
                    {side * 125.0, 10, 1430, 3.2},
                    {side * 160.0, 10, 1404, 2.6}});
    }
  }

  void add_abdomen() {
    for (double side : {-1.0, 1.0})
      inner(kKidney,
            Solid(Ellipsoid{Frame{V(side * 62, 52, 1118 + 5 * side), glm::dmat3(1)}.turned({0, 1, 0}, 12 * side),
                            {26, 21, 54}}));
    inner(kBladder, Solid(ellipsoid({0, -26, 906}, {34, 28, 28})));
    inner(kSpleen, Solid(ellipsoid({100, 38, 1182}, {20, 32, 42})));
    inner(kStomach,
          tube({{24, 4, 1218, 12}, {62, -8, 1206, 32}, {66, -24, 1166, 34}, {40, -40, 1132, 24}, {2, -34, 1126, 14}},
               14));
    inner(kLiver, Solid(ellipsoid({-58, -8, 1192}, {70, 72, 56})).add(ellipsoid({4, -34, 1204}, {60, 38, 30}), 20));
    // The colon surrounds the small intestine, which lies in loops.
    inner(kColon, tube({{-96, -8, 970, 22},
                        {-104, 4, 1060, 21},
                        {-98, 4, 1108, 20},
                        {-40, -56, 1084, 19},
                        {30, -60, 1082, 18},
                        {98, 8, 1116, 18},
                        {106, 12, 1040, 17},
                        {100, 2, 975, 17},
                        {60, 4, 944, 16},
                        {14, 40, 956, 16},
                        {0, 66, 930, 17},
                        {0, 62, 880, 14}},
                       3));
    std::vector<T> loops;
    for (int layer = 0; layer < 2; ++layer)
      for (int row = 0; row < 5; ++row)
        for (int step = 0; step <= 4; ++step) {
          const double x = (row % 2 == layer % 2 ? -1 : 1) * (-66 + 33.0 * step);
          loops.push_back(T(x, -52 + 36 * layer + 6 * std::sin(1.7 * step + row),
                            (layer == 0 ? 952 + 27 * row : 1060 - 27 * row) + 5 * std::sin(2.3 * step), 12.5));
        }
    inner(kIntestine, tube(loops, 2));
    // Adds the visceral fat, which fills the belly around the organs, and the dome of the diaphragm above the belly.
    Solid cavity(Loft({},
                      {{862, {0, 10}, {62, 52}},
                       {920, {0, 4}, {92, 66}, 2.2},
                       {975, {0, -4}, {122, 72}, 2.3},
                       {1040, {0, -6}, {126, 74}, 2.3},
                       {1110, {0, -4}, {122, 76}, 2.3},
                       {1150, {0, -2}, {118, 78}, 2.2}},
                      20));
    cavity.add(ellipsoid({-36, 0, 1168}, {84, 80, 88}), 12).add(ellipsoid({46, 0, 1160}, {74, 78, 80}), 12);
    inner(kVisceralFat, cavity);
    Solid dome(ellipsoid({-36, 0, 1168}, {90, 86, 94}));
    dome.add(ellipsoid({46, 0, 1160}, {80, 84, 86}), 12).cut(cone({-200, 0, 900}, 245, {200, 0, 900}, 245));
    inner(kDiaphragm, dome);
  }

  void add_chest() {
    for (double side : {-1.0, 1.0}) {
      // The lungs may overlap the heart. The heart then wins, since it comes earlier in the list of organs.
      Solid lung(Loft(Frame{V(side * 68, 0, 0), glm::dmat3(1)},
                      {{1165, {0, 14}, {50, 62}},
                       {1215, {0, 10}, {53, 74}},
                       {1290, {0, 6}, {54, 78}},
                       {1350, {-4 * side, 8}, {48, 70}},
                       {1400, {-10 * side, 14}, {38, 54}},
                       {1440, {-18 * side, 20}, {24, 36}},
                       {1462, {-22 * side, 22}, {12, 18}}},
                      10));
      inner(kLung, lung);
    }
    inner(kVisceralFat, Solid(ellipsoid({0, -6, 1340}, {44, 58, 118})));
  }

  void add_muscles(double side) {
    const auto at = [&](double x, double y, double z) { return V(side * x, y, z); };
    const auto along_side = [&](std::vector<T> points) { return tube(mirrored(std::move(points), side)); };
    muscle(kBackMuscles, along_side({{34, 92, 950, 20},
                                     {32, 80, 1040, 26},
                                     {32, 80, 1130, 26},
                                     {32, 100, 1250, 20},
                                     {28, 100, 1370, 17},
                                     {22, 78, 1460, 14},
                                     {18, 56, 1540, 14},
                                     {20, 44, 1590, 10}}));
    muscle(
        kIliopsoas,
        along_side({{38, 40, 1150, 12}, {48, 32, 1060, 20}, {70, 4, 980, 22}, {88, -36, 925, 16}, {80, -20, 880, 10}}));
    muscle(kIliopsoas, Solid(Plate{at(104, -22, 1000), at(92, 20, 1020), at(80, -8, 950), 10}));
    muscle(kGluteals,
           Solid(ellipsoid(at(76, 86, 920), {56, 34, 62})).add(cone(at(60, 86, 985), 22, at(126, 44, 880), 24), 20));
    muscle(kGluteals, Solid(cone(at(122, 16, 1005), 20, at(140, 8, 915), 18))
                          .add(cone(at(108, 50, 985), 22, at(136, 20, 915), 16), 10));
    muscle(kGluteals, along_side({{30, 80, 950, 12}, {100, 40, 912, 12}, {132, 14, 905, 8}}));
    muscle(
        kAbdominalMuscles,
        along_side(
            {{30, -88, 905, 10}, {36, -98, 1000, 12}, {38, -92, 1100, 12}, {42, -102, 1190, 10}, {44, -104, 1250, 8}}));
    muscle(kAbdominalMuscles, Solid(Loft({},
                                         {{890, {0, 4}, {110, 84}, 2.2},
                                          {970, {0, 4}, {150, 92}, 2.3},
                                          {1045, {0, 2}, {138, 88}, 2.3},
                                          {1105, {0, 0}, {130, 87}, 2.3},
                                          {1180, {0, 0}, {134, 96}, 2.4}},
                                         10))
                                  .cut(Loft({},
                                            {{860, {0, 4}, {92, 68}, 2.2},
                                             {970, {0, 4}, {134, 78}, 2.3},
                                             {1045, {0, 2}, {122, 74}, 2.3},
                                             {1105, {0, 0}, {114, 73}, 2.3},
                                             {1200, {0, 0}, {120, 82}, 2.4}},
                                            10)));
    muscle(
        kPectoralis,
        Solid(ellipsoid(at(72, -92, 1358), {72, 15, 46})).add(cone(at(120, -66, 1378), 16, at(172, -6, 1398), 9), 16));
    muscle(kPectoralis, Solid(Plate{at(30, -84, 1420), at(28, -100, 1300), at(140, -44, 1392), 9}));
    muscle(kLatissimus, Solid(Plate{at(20, 104, 1200), at(30, 104, 1010), at(134, 50, 1300), 8})
                            .add(Plate{at(20, 112, 1260), at(134, 50, 1300), at(130, 56, 1366), 9}, 8));
    muscle(kLatissimus, along_side({{130, 50, 1290, 16}, {136, 44, 1350, 16}, {158, 24, 1388, 9}}));
    muscle(kTrapezius, Solid(Plate{at(8, 108, 1430), at(8, 126, 1240), at(120, 88, 1440), 6})
                           .add(Plate{at(10, 74, 1520), at(8, 110, 1420), at(168, 36, 1474), 9}, 8)
                           .add(cone(at(26, 52, 1580), 10, at(70, 46, 1484), 16), 10));
    muscle(kShoulderMuscles, Solid(Plate{at(148, 34, 1424), at(84, 90, 1410), at(104, 102, 1310), 11}));
    muscle(kShoulderMuscles, Solid(Plate{at(140, 26, 1420), at(84, 66, 1424), at(98, 76, 1310), 9}));
    muscle(kShoulderMuscles, along_side({{90, 68, 1450, 10}, {150, 40, 1456, 9}, {184, 14, 1458, 5}}));
    muscle(kShoulderMuscles, Solid(Plate{at(126, 20, 1380), at(110, 70, 1340), at(136, -20, 1280), 6}));  // serratus
    muscle(kIntercostals, Solid(Loft({},
                                     {{1120, {0, 2}, {122, 88}, 2.1},
                                      {1240, {0, 2}, {140, 101}, 2.1},
                                      {1300, {0, 4}, {138, 99}, 2.1},
                                      {1360, {0, 8}, {126, 90}, 2.1},
                                      {1410, {0, 14}, {100, 74}, 2},
                                      {1455, {0, 21}, {58, 48}, 2}},
                                     6))
                              .cut(Loft({},
                                        {{1100, {0, 2}, {112, 78}, 2.1},
                                         {1240, {0, 2}, {131, 92}, 2.1},
                                         {1300, {0, 4}, {129, 90}, 2.1},
                                         {1360, {0, 8}, {117, 81}, 2.1},
                                         {1410, {0, 14}, {91, 65}, 2},
                                         {1462, {0, 21}, {46, 38}, 2}},
                                        6)));
    muscle(kNeckMuscles, along_side({{22, -64, 1446, 7}, {40, -22, 1500, 11}, {52, 14, 1560, 11}, {58, 28, 1592, 8}}));
    muscle(kNeckMuscles, along_side({{40, 28, 1480, 13}, {34, 30, 1540, 14}, {34, 34, 1590, 10}}));
    muscle(kNeckMuscles, along_side({{14, -34, 1450, 6}, {14, -30, 1510, 9}, {14, -36, 1545, 8}}));
    muscle(kFaceMuscles, Solid(ellipsoid(at(66, -18, 1646), {8, 34, 34})));       // temporalis
    muscle(kFaceMuscles, along_side({{56, -26, 1608, 8}, {52, -24, 1574, 10}}));  // masseter
    muscle(kFaceMuscles, along_side({{22, -84, 1582, 6}, {36, -66, 1584, 7}}));
    muscle(kFaceMuscles, along_side({{14, -84, 1560, 5}, {36, -56, 1556, 6}}));
    muscle(kDeltoid, along_side({{140, -14, 1452, 12}, {168, -6, 1440, 12}, {190, 2, 1420, 12}}));
    muscle(kDeltoid, along_side({{140, 66, 1436, 12}, {180, 46, 1440, 14}, {200, 28, 1420, 12}}));
  }
};
}  // namespace

TrunkJoints add_trunk(Anatomy& anatomy, double thinnest_radius) { return Trunk(anatomy, thinnest_radius).build(); }

}  // namespace limber::phantom
