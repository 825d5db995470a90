// The locations of a spec's parts in its file. A spec that was read from a file carries its
// locations, so that later errors, found when a scene is built, contain file:line:column.
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

// Joins "a.b" and "c" to "a.b.c", "a" and "[2]" to "a[2]"; either may be empty.
std::string JoinPath(std::string_view path, std::string_view below);

class Locations {
 public:
  Locations() = default;  // no file
  // The locations of the part at `base` of the spec that `sources` describe.
  explicit Locations(std::shared_ptr<const SourceMap> sources, std::string base = "")
      : sources_(std::move(sources)), base_(std::move(base)) {}

  // Returns the location of the value at `path`; unset if the file does not give it.
  std::optional<std::string> Exactly(std::string_view path) const;
  // Returns the location of the value at `path` or of the nearest part around it; "" for no file.
  std::string At(std::string_view path = "") const;
  // Returns the locations of the part at `path`.
  Locations Below(std::string_view path) const;

 private:
  std::shared_ptr<const SourceMap> sources_;
  std::string base_;
};

// Splits the place in a file off the beginning of a message: "r.yaml:7:73: no joint 'j8'" ->
// {"r.yaml:7:73", "no joint 'j8'"}; {"", message} without a place.
std::pair<std::string, std::string> SplitPlace(std::string_view message);

// Puts `place` before the message, unless the message has its own place or `place` is empty.
std::string WithPlace(const std::string& place, const std::string& message);

// Lets a SourceMap distinguish maps, whose keys are the user's names, from specs, whose fields are
// declared: the map contains this suffix after the path of every map of a spec that was read, given
// or not: "home.*" -> "".
inline constexpr std::string_view kAnyKey = ".*";

// Suffix for parts in a separate file: the map contains it after the part's path, with the
// beginning of that file, which is the location of fields that the file lacks. The part itself has
// the location that names the file.
inline constexpr std::string_view kOwnFile = ".<file>";

}  // namespace robocell
