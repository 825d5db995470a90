// RequireSound of scene_annotations.h: checks every number of foreign annotations.
#include <fmt/format.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/scenes/scene_annotations.h"

namespace robocell {
namespace {

// Checks numbers of one entry, such as "supports[0]". Poses are always finite.
class EntryCheck {
 public:
  EntryCheck(const std::string& place, const char* list, size_t index)
      : place_(place), entry_(fmt::format("{}[{}]", list, index)) {}

  void Finite(const char* field, double value) const {
    if (!std::isfinite(value)) Fail(field, value, "finite");
  }
  void Finite(const char* field, const Eigen::Vector3d& values) const {
    for (const double value : values) Finite(field, value);
  }
  void Size(const char* field, double value) const {
    Finite(field, value);
    if (value < 0) Fail(field, value, "at least 0");
  }
  void Number(const char* field, double value) const {
    if (std::isnan(value)) Fail(field, value, "a number; it is infinite without limits");
  }

 private:
  [[noreturn]] void Fail(const char* field, double value, const char* wanted) const {
    throw ArgumentError(
        fmt::format("{}: {}.{} is {}; it must be {}", place_, entry_, field, value, wanted));
  }
  const std::string& place_;
  std::string entry_;
};

template <class T, class F>
void CheckEach(const std::string& place, const char* list, const std::vector<T>& entries, F&& f) {
  for (size_t i = 0; i < entries.size(); ++i) f(EntryCheck(place, list, i), entries[i]);
}

}  // namespace

void RequireSound(const SceneAnnotations& annotations, const std::string& place) {
  CheckEach(place, "supports", annotations.supports, [](const EntryCheck& check, const auto& s) {
    check.Size("face.half_x", s.face.half_x);
    check.Size("face.half_y", s.face.half_y);
    check.Size("face.thickness", s.face.thickness);
    check.Size("free_area", s.free_area);
  });
  CheckEach(place, "containers", annotations.containers,
            [](const EntryCheck& check, const auto& c) {
              for (const double half : c.half_extents) check.Size("half_extents", half);
              check.Finite("opening", c.opening);
            });
  CheckEach(place, "articulations", annotations.articulations,
            [](const EntryCheck& check, const auto& a) {
              for (const double limit : a.range) check.Number("range", limit);
              check.Finite("start", a.start);
              check.Finite("axis", a.axis);
              check.Finite("anchor", a.anchor);
            });
  CheckEach(place, "rooms", annotations.rooms, [](const EntryCheck& check, const auto& r) {
    for (const Vec2& corner : r.outline) {
      check.Finite("outline", corner[0]);
      check.Finite("outline", corner[1]);
    }
    check.Finite("floor_height", r.floor_height);
  });
  CheckEach(place, "free_floor", annotations.free_floor,
            [](const EntryCheck& check, const auto& f) {
              check.Size("half_x", f.half_x);
              check.Size("half_y", f.half_y);
            });
  CheckEach(place, "lights", annotations.lights, [](const EntryCheck& check, const auto& l) {
    check.Finite("position", l.position);
    check.Finite("direction", l.direction);
  });
}

}  // namespace robocell
