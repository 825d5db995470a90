#include "robocell/motion/cover_cache.h"

#include <map>
#include <mutex>
#include <string>

namespace robocell::internal {
namespace {

constexpr size_t kMostCovers = 1000;

// The numbers of a shape, as bytes.
std::string KeyOf(const ConvexShape& shape) {
  std::string key;
  const auto add = [&](double number) {
    key.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  add(static_cast<double>(shape.kind));
  add(shape.radius);
  add(shape.half_length);
  for (const HalfSpace& plane : shape.planes) {
    for (const double x : plane.normal) add(x);
    add(plane.offset);
  }
  return key;
}

}  // namespace

std::shared_ptr<const SphereCover> CachedCover(const ConvexShape& shape) {
  static std::mutex mutex;
  static std::map<std::string, std::shared_ptr<const SphereCover>> covers;
  const std::string key = KeyOf(shape);
  {
    const std::lock_guard lock(mutex);
    if (const auto known = covers.find(key); known != covers.end()) return known->second;
  }
  auto cover = std::make_shared<const SphereCover>(CoverWithSpheres(shape, InflationFor(shape)));
  const std::lock_guard lock(mutex);
  if (covers.size() >= kMostCovers) covers.clear();
  return covers.emplace(key, std::move(cover)).first->second;
}

}  // namespace robocell::internal
