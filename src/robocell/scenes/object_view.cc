#include "robocell/scenes/object_view.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scenes/visibility.h"

namespace robocell {
namespace {

constexpr int kMostPoints = 10'000;
constexpr int kErosions = 2;  // pixels between a point and the edge of what it is on

// Returns the mask without the pixels at its edge; the border of the image is an edge too.
std::vector<uint8_t> Eroded(std::span<const uint8_t> mask, int width, int height) {
  std::vector<uint8_t> inner(mask.size());
  for (int v = 1; v + 1 < height; ++v) {
    for (int u = 1; u + 1 < width; ++u) {
      const size_t i = static_cast<size_t>(v) * width + u;
      inner[i] = mask[i] && mask[i - 1] && mask[i + 1] && mask[i - width] && mask[i + width];
    }
  }
  return inner;
}

std::vector<Pixel> PixelsOf(std::span<const uint8_t> mask, int width) {
  std::vector<Pixel> pixels;
  for (size_t i = 0; i < mask.size(); ++i) {
    if (mask[i]) pixels.push_back({static_cast<int>(i) % width, static_cast<int>(i) / width});
  }
  return pixels;
}

double SquaredDistance(const Pixel& a, double u, double v) {
  return (a[0] - u) * (a[0] - u) + (a[1] - v) * (a[1] - v);
}

}  // namespace

std::vector<bool> BodiesOf(const Scene& scene, const std::string& name, const std::string& place) {
  const mjModel* m = scene.model();
  std::vector<std::string> known;
  for (const ObjectRecord& object : scene.compiled()->objects()) {
    if (object.name == name)
      return internal::SubtreeMask(m, RequireId(m, mjOBJ_BODY, object.root_body, place));
    known.push_back(object.name);
  }
  int body = FindId(m, mjOBJ_BODY, name);
  for (const RobotRecord& robot : scene.compiled()->robots()) {
    if (robot.name == name)
      return internal::SubtreeMask(m, RequireId(m, mjOBJ_BODY, robot.base_body, place));
    if (body < 0) body = FindId(m, mjOBJ_BODY, robot.prefix + name);
    known.push_back(robot.name);
  }
  if (body >= 0) return internal::SubtreeMask(m, body);
  for (std::string& each : scene.body_names()) known.push_back(std::move(each));
  throw NotFoundError(NoSuchName(place, "object, robot or body", name, known));
}

std::span<const int32_t> BodyImages::Draw(const Scene& scene, const CameraView& view, int width,
                                          int height) {
  RequireImageSize(width, height);
  if (!renderer_) renderer_ = MakeRenderer({.backend = "soft"});
  if (generation_ != scene.generation()) {
    generation_ = 0;
    renderer_->SetModel(scene.model());
    generation_ = scene.generation();
  }
  ids_.resize(static_cast<size_t>(width) * static_cast<size_t>(height));
  renderer_->Render(scene.data(), {.camera = view, .width = width, .height = height},
                    {.segmentation = ids_});
  return ids_;
}

std::optional<WorldBox> BoxOf(const Scene& scene, const std::vector<bool>& bodies) {
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  WorldBox box{.low = Eigen::Vector3d::Constant(kInfinite),
               .high = Eigen::Vector3d::Constant(-kInfinite)};
  for (int g = 0; g < m->ngeom; ++g) {
    if (!bodies[m->geom_bodyid[g]] || m->geom_type[g] == mjGEOM_PLANE) continue;
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> turn(d->geom_xmat + 9 * g);
    const Eigen::Vector3d middle(m->geom_aabb + 6 * g), half(m->geom_aabb + 6 * g + 3);
    const Eigen::Vector3d at = Eigen::Vector3d(d->geom_xpos + 3 * g) + turn * middle;
    const Eigen::Vector3d reach = turn.cwiseAbs() * half;
    box.low = box.low.cwiseMin(at - reach);
    box.high = box.high.cwiseMax(at + reach);
  }
  if (!(box.low.x() <= box.high.x())) return std::nullopt;
  return box;
}

std::vector<Pixel> PointsInMask(std::span<const uint8_t> mask, int width, int height, int most) {
  if (width < 0 || height < 0 ||
      mask.size() != static_cast<size_t>(width) * static_cast<size_t>(height)) {
    throw ArgumentError(
        fmt::format("a mask of {}x{} pixels has {} values", width, height, mask.size()));
  }
  if (most > kMostPoints) {
    throw ArgumentError(
        fmt::format("{} points of a mask are more than the {} that are computed at most: each is "
                    "compared with all pixels; ask for fewer, or take the pixels of the mask",
                    most, kMostPoints));
  }
  std::vector<uint8_t> inner(mask.begin(), mask.end());
  for (int i = 0; i < kErosions; ++i) {
    std::vector<uint8_t> next = Eroded(inner, width, height);
    if (std::ranges::find_if(next, [](uint8_t set) { return set != 0; }) == next.end()) break;
    inner = std::move(next);
  }
  const std::vector<Pixel> pixels = PixelsOf(inner, width);
  std::vector<Pixel> points;
  if (pixels.empty() || most <= 0) return points;
  double u = 0, v = 0;
  for (const Pixel& pixel : pixels) {
    u += pixel[0];
    v += pixel[1];
  }
  const auto count = static_cast<double>(pixels.size());
  points.push_back(*std::ranges::min_element(pixels, {}, [&](const Pixel& pixel) {
    return SquaredDistance(pixel, u / count, v / count);
  }));
  std::vector<double> nearest(pixels.size(), std::numeric_limits<double>::infinity());
  while (static_cast<int>(points.size()) < most) {
    for (size_t i = 0; i < pixels.size(); ++i) {
      nearest[i] =
          std::min(nearest[i], SquaredDistance(pixels[i], points.back()[0], points.back()[1]));
    }
    const auto farthest = std::ranges::max_element(nearest);
    if (*farthest == 0) break;  // all of them are taken
    points.push_back(pixels[static_cast<size_t>(farthest - nearest.begin())]);
  }
  return points;
}

ObjectView ViewOfObject(const Scene& scene, const std::vector<bool>& bodies, const CameraView& view,
                        int width, int height, int most_points, BodyImages& images) {
  scene.SyncPoses();
  ObjectView seen;
  const std::span<const int32_t> ids = images.Draw(scene, view, width, height);
  std::vector<uint8_t> mask(ids.size());
  seen.low = {width, height};
  for (size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] < 0 || !bodies[static_cast<size_t>(ids[i])]) continue;
    mask[i] = 1;
    ++seen.pixels;
    const Pixel at = {static_cast<int>(i) % width, static_cast<int>(i) / width};
    for (int k = 0; k < 2; ++k) {
      seen.low[k] = std::min(seen.low[k], at[k]);
      seen.high[k] = std::max(seen.high[k], at[k]);
    }
  }
  if (seen.pixels == 0) seen.low = {0, 0};
  seen.share = internal::SightOf(scene, bodies,
                                 ComputeCamera(scene.model(), scene.data(), view, width, height))
                   .share;
  seen.points = PointsInMask(mask, width, height, most_points);
  return seen;
}

}  // namespace robocell
