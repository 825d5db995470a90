// ObjectInfo: what a kind of the catalogue is called and how hands take it: the file object.yaml
// beside its model.
//
//   category: fruit
//   colour: red
//   synonyms: [red apple]
//   grasps: [top]
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/types.h"

namespace robocell {

// Where two fingers fit around an object that stands upright: from above, from a side, over its rim,
// or at its handle. A description for users who choose objects: tasks find grasps from the geometry.
enum class ObjectGrasp { kTop, kSide, kRim, kHandle };
template <>
struct EnumNames<ObjectGrasp> {
  static constexpr std::array kNames = {
      std::pair{ObjectGrasp::kTop, "top"}, std::pair{ObjectGrasp::kSide, "side"},
      std::pair{ObjectGrasp::kRim, "rim"}, std::pair{ObjectGrasp::kHandle, "handle"}};
};

struct ObjectInfo {
  std::string category = {};
  std::string colour = {};
  std::string material = {};
  NameList synonyms = {};
  std::optional<Vec3> size = {};
  std::vector<ObjectGrasp> grasps = {};
  bool drawn_by_default = false;

  static constexpr const char* kTypeName = "ObjectInfo";
  template <class V>
  static void Fields(V&& v) {
    v("category", &ObjectInfo::category,
      "The group of kinds it belongs to, in the plural: `fruit`, `tools`. Tasks draw from a "
      "category by this name.");
    v("colour", &ObjectInfo::colour, "Main colour, a word.");
    v("material", &ObjectInfo::material, "Main material, a word.");
    v("synonyms", &ObjectInfo::synonyms,
      "Other names of the object, for scene annotations. Instructions name the kind.");
    v("size", &ObjectInfo::size, "Size of the bounding box, metres.", Bound::kPositive);
    v("grasps", &ObjectInfo::grasps,
      "Where two fingers that open 75 mm fit around it as it stands: top, side, rim, handle. Tasks "
      "find grasps from the geometry instead.");
    v("drawn_by_default", &ObjectInfo::drawn_by_default,
      "Whether tasks that name no kinds draw it.");
  }
  void Validate(Problems& problems) const;
};

}  // namespace robocell
