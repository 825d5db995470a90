#include "robocell/spec/object_info.h"

#include <fmt/format.h>

#include <string_view>

namespace robocell {

// A category stands in lists beside kinds, which are names of folders.
void ObjectInfo::Validate(Problems& problems) const {
  constexpr std::string_view kForbidden = "/\\:.,[]{} \t\n";
  if (category.find_first_of(kForbidden) == std::string::npos) return;
  problems.AddAt(
      "category",
      fmt::format("'{}' is no single word; write it like `fruit` or `power_tools`", category));
}

}  // namespace robocell
