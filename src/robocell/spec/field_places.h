// Where a field belongs that was given to another part of a file, for messages.
//
//   PlaceHint("RunConfig", "renderer")  // " It is a field of `cameras`: cameras.renderer"
#pragma once

#include <string>
#include <string_view>

namespace robocell {

// "" for a name that no part of a `type` has.
std::string PlaceHint(std::string_view type, const std::string& name);

// The same of the key that names a kind: a scene source has `source`, a task `kind`. `key` is that
// of the kind, "" for other names than those two.
std::string KindKeyHint(std::string_view key, const std::string& name);

}  // namespace robocell
