// References from a spec to an element of a model, with or without a name.
#pragma once

#include <optional>
#include <string>

#include "robocell/spec/fields.h"

namespace robocell {

enum class ElementKind {
  kBody,
  kSite,
  kGeom,
  kJoint,
  kCamera,
  kActuator,
  kSensor,
  kLight,
  kTendon,
  kEquality,
  kKey
};

template <>
struct EnumNames<ElementKind> {
  static constexpr std::array kNames = {
      std::pair{ElementKind::kBody, "body"},     std::pair{ElementKind::kSite, "site"},
      std::pair{ElementKind::kGeom, "geom"},     std::pair{ElementKind::kJoint, "joint"},
      std::pair{ElementKind::kCamera, "camera"}, std::pair{ElementKind::kActuator, "actuator"},
      std::pair{ElementKind::kSensor, "sensor"}, std::pair{ElementKind::kLight, "light"},
      std::pair{ElementKind::kTendon, "tendon"}, std::pair{ElementKind::kEquality, "equality"},
      std::pair{ElementKind::kKey, "key"},
  };
};

// A named element, or the index-th element of its kind directly under a body; {body: {body: hand,
// index: 1}} is hand's second child. In YAML `link_tcp` (any kind that the field allows), `{site:
// link_tcp}` or `{geom: {body: left_finger, index: 3}}`.
struct ElementRef {
  std::optional<ElementKind> kind = {};
  std::string name = {};
  std::string body = {};  // parent body of an unnamed element ...
  int index = 0;          // ... and the index among its elements of this kind, from 0

  bool empty() const { return name.empty() && body.empty(); }
  bool operator==(const ElementRef&) const = default;
};

// Describes it for messages: "site 'link_tcp'" or "geom 3 of body 'left_finger'".
std::string Describe(const ElementRef& ref);

}  // namespace robocell
