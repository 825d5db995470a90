// Converts keyframes as users write them: a number, a name, or {robot or object: number or name}.
// True and False are no numbers here.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include <type_traits>
#include <variant>

#include "robocell/scene/scene.h"

namespace robocell::python {

// Returns false for anything else. Errors of a user's mapping are thrown.
bool ToKeyframe(nanobind::handle value, KeyframeChoice& out);

}  // namespace robocell::python

namespace nanobind::detail {

template <>
struct type_caster<robocell::KeyframeChoice> {
  NB_TYPE_CASTER(robocell::KeyframeChoice,
                 const_name("int | str | collections.abc.Mapping[str, int | str]"))

  bool from_python(handle src, uint8_t /*flags*/, cleanup_list* /*cleanup*/) noexcept {
    try {
      return robocell::python::ToKeyframe(src, value);
    } catch (...) {
      PyErr_Clear();
      return false;
    }
  }

  static handle from_cpp(const robocell::KeyframeChoice& choice, rv_policy policy,
                         cleanup_list* cleanup) noexcept {
    return std::visit(
        [&](const auto& kept) {
          return make_caster<std::decay_t<decltype(kept)>>::from_cpp(kept, policy, cleanup);
        },
        choice);
  }
};

}  // namespace nanobind::detail
