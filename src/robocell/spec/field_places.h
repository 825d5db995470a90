// For messages: returns where a field belongs that was given to another part of a file.
//
//   PlaceHint("RunConfig", "renderer")  // " It is a field of `cameras`: cameras.renderer"
#pragma once

#include <string>
#include <string_view>

namespace robocell {

// Returns "" for a name that no part of a `type` has.
std::string PlaceHint(std::string_view type, const std::string& name);

// The same for the key that names a kind: a scene source has `source`, a task `kind`. `key` is the
// key of the kind; "" for names other than those two.
std::string KindKeyHint(std::string_view key, const std::string& name);

}  // namespace robocell
