// A place in a file at the beginning of a message, as locations.h has it.
#pragma once

#include <string>
#include <string_view>
#include <utility>

namespace robocell {

// "r.yaml:7:73: no joint 'j8'" -> {"r.yaml:7:73", "no joint 'j8'"}; {"", message} for one without.
std::pair<std::string, std::string> SplitPlace(std::string_view message);

// The message behind `place`, unless it has a place of its own or `place` is empty.
std::string WithPlace(const std::string& place, const std::string& message);

}  // namespace robocell
