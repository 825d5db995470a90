// Arms for the tests of this folder, as Denavit-Hartenberg tables: base body "base", tip site
// "tip".
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "robocell/base/units.h"

namespace robocell {

inline constexpr double kQuarterTurn = std::numbers::pi / 2;

// The joint moves about or along z, then follows the link.
struct TableRow {
  double a, alpha, d;  // m, rad, m
  double lower, upper;
  bool slide = false;
};

inline std::string ArmXml(const std::vector<TableRow>& rows) {
  std::string xml =
      "<mujoco><compiler angle='radian'/><worldbody><body name='base'><geom size='.1'/>";
  std::string place = "pos='0 0 0'";
  for (const TableRow& row : rows) {
    xml += fmt::format("<body {}><joint type='{}' axis='0 0 1' range='{} {}'/><geom size='.05'/>",
                       place, row.slide ? "slide" : "hinge", row.lower, row.upper);
    place = fmt::format("pos='{} 0 {}' quat='{} {} 0 0'", row.a, row.d, std::cos(row.alpha / 2),
                        std::sin(row.alpha / 2));
  }
  xml += fmt::format("<site name='tip' {}/>", place);
  for (std::size_t k = 0; k <= rows.size(); ++k) xml += "</body>";
  return xml + "</worldbody></mujoco>";
}

// The Puma 560, after P. I. Corke and B. Armstrong-Helouvry, "A Search for Consensus Among Model
// Parameters Reported for the PUMA 560 Robot", 1994.
inline std::vector<TableRow> Puma560() {
  return {{0, kQuarterTurn, 0, internal::Radians(-160), internal::Radians(160)},
          {0.4318, 0, 0, internal::Radians(-45), internal::Radians(225)},
          {0.0203, -kQuarterTurn, 0.15005, internal::Radians(-225), internal::Radians(45)},
          {0, kQuarterTurn, 0.4318, internal::Radians(-110), internal::Radians(170)},
          {0, -kQuarterTurn, 0, internal::Radians(-100), internal::Radians(100)},
          {0, 0, 0.0563, internal::Radians(-266), internal::Radians(266)}};
}

// Seven joints with offsets at all of them and narrow limits, like those of one arm of ABB's YuMi.
inline std::vector<TableRow> OffsetSevenJoints() {
  return {{0.03, -kQuarterTurn, 0.166, -2.94, 2.94},
          {0.03, kQuarterTurn, 0, -2.5, 0.76},
          {0.0405, -kQuarterTurn, 0.2515, -2.94, 2.94},
          {0.0405, kQuarterTurn, 0, -2.155, 1.396},
          {0.027, -kQuarterTurn, 0.265, -5.06, 5.06},
          {0.027, -kQuarterTurn, 0, -1.536, 2.4},
          {0, 0, 0.136, -3.99, 3.99}};
}

}  // namespace robocell
