// Shapes drawn into colour images only, for pictures that explain: frames, points, directions. They
// do not belong to the simulation and never appear in depth or segmentation.
//
//   std::vector<Marker> markers;
//   AddFrame(markers, tcp_in_world, 0.1);
//   AddText(markers, cube_in_world, "cube");
//   renderer->Render(data, {.camera = view, .width = 640, .height = 480, .markers = markers},
//                    {.rgb = rgb});
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "robocell/math/pose.h"

namespace robocell {

struct Marker {
  enum Shape { kSphere, kBox, kCylinder, kArrow, kText };

  Shape shape = kSphere;
  Pose pose;  // pose in the world; an arrow starts here and points along z
  std::array<double, 3> size = {0.01, 0, 0};  // sphere: radius; box: half sizes; cylinder: radius,
                                              // half length; arrow: radius, length
  std::array<float, 4> rgba = {1, 0, 0, 1};
  std::array<char, 64> text = {};  // drawn at the pose, truncated to fit; every shape can have one
};

// Adds three arrows: x red, y green, z blue; `length` in metres.
void AddFrame(std::vector<Marker>& markers, const Pose& frame_in_world, double length,
              std::string_view text = {});
void AddPoint(std::vector<Marker>& markers, const Eigen::Vector3d& point_in_world, double radius,
              const std::array<float, 4>& rgba);
void AddText(std::vector<Marker>& markers, const Eigen::Vector3d& point_in_world,
             std::string_view text);

}  // namespace robocell
