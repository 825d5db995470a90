// The places of a spec's parts in its file. A spec that was read from a file carries its locations,
// so that errors found later, when a scene is built, contain file:line:column.
//
//   robot.locations.At("move_groups.arm.joints[7]")  // "xarm7.yaml:11:28"
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace robocell {

// Path in a spec, such as "robots[0].pos" -> "file.yaml:12:5".
using SourceMap = std::map<std::string, std::string>;

// "a.b" and "c" -> "a.b.c"; "a" and "[2]" -> "a[2]"; either may be empty.
std::string JoinPath(std::string_view path, std::string_view below);

class Locations {
 public:
  Locations() = default;  // of a spec that came from no file
  // Of the part at `base` of the spec that `sources` are about.
  explicit Locations(std::shared_ptr<const SourceMap> sources, std::string base = "")
      : sources_(std::move(sources)), base_(std::move(base)) {}

  // The location of the value at `path`; null when it was not given in the file.
  std::optional<std::string> Exactly(std::string_view path) const;
  // The location of the value at `path` or of the nearest part around it; "" for no file.
  std::string At(std::string_view path = "") const;
  // Those of the part at `path`.
  Locations Below(std::string_view path) const;

 private:
  std::shared_ptr<const SourceMap> sources_;
  std::string base_;
};

// Splits a message that begins with a place in a file:
// "r.yaml:7:73: no joint 'j8'" -> {"r.yaml:7:73", "no joint 'j8'"}; {"", message} for one without.
std::pair<std::string, std::string> SplitPlace(std::string_view message);

// The message behind `place`, unless it has a place of its own or `place` is empty.
std::string WithPlace(const std::string& place, const std::string& message);

// Lets a SourceMap distinguish maps, whose keys are the user's names, from specs, whose fields are
// declared: it stands behind the path of every map of a spec that was read, given or not: "home.*" -> "".
inline constexpr std::string_view kAnyKey = ".*";

}  // namespace robocell
