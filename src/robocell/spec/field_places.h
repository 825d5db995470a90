// Returns the right part of a file for a misplaced field, for messages.
//
//   PlaceHint("RunConfig", "renderer")  // " It is a field of `cameras`: cameras.renderer"
#pragma once

#include <string>
#include <string_view>

namespace robocell {

// Returns "" for a name that no part of a `type` has.
std::string PlaceHint(std::string_view type, const std::string& name);

// Returns the hint for the key that names a kind: a scene source has `source`, a task `kind`. `key`
// is the key of the kind; "" for names other than those two.
std::string KindKeyHint(std::string_view key, const std::string& name);

}  // namespace robocell
