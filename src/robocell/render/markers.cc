#include "robocell/render/markers.h"

#include <algorithm>
#include <numbers>

namespace robocell {
namespace {

std::array<char, 64> Text(std::string_view text) {
  std::array<char, 64> out = {};
  std::copy_n(text.data(), std::min(text.size(), out.size() - 1), out.data());
  return out;
}

Marker Axis(const Pose& frame, const Eigen::Vector3d& turn, double length,
            const std::array<float, 4>& rgba) {
  Marker arrow;
  arrow.shape = Marker::kArrow;
  arrow.pose = frame * Pose::FromRotvec(Eigen::Vector3d::Zero(), turn);
  arrow.size = {0.03 * length, length, 0};
  arrow.rgba = rgba;
  return arrow;
}

}  // namespace

void AddFrame(std::vector<Marker>& markers, const Pose& frame, double length,
              std::string_view text) {
  const double quarter = 0.5 * std::numbers::pi;
  markers.push_back(Axis(frame, {0, quarter, 0}, length, {0.9f, 0.1f, 0.1f, 1}));
  markers.push_back(Axis(frame, {-quarter, 0, 0}, length, {0.1f, 0.7f, 0.1f, 1}));
  markers.push_back(Axis(frame, {0, 0, 0}, length, {0.1f, 0.2f, 0.9f, 1}));
  if (!text.empty()) AddText(markers, frame.translation(), text);
}

void AddPoint(std::vector<Marker>& markers, const Eigen::Vector3d& point, double radius,
              const std::array<float, 4>& rgba) {
  Marker sphere;
  sphere.pose = Pose(point);
  sphere.size = {radius, 0, 0};
  sphere.rgba = rgba;
  markers.push_back(sphere);
}

void AddText(std::vector<Marker>& markers, const Eigen::Vector3d& point, std::string_view text) {
  Marker label;
  label.shape = Marker::kText;
  label.pose = Pose(point);
  label.rgba = {1, 1, 1, 1};
  label.text = Text(text);
  markers.push_back(label);
}

}  // namespace robocell
