// Converts the results of methods and functions written in Python, or throws a HookError (a
// TypeError in Python) with class and method, the expected and the returned value, and the place of
// the method. Needs the GIL.
#pragma once

#include <nanobind/nanobind.h>

#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "bindings.h"
#include "raised.h"
#include "robocell/robot/action.h"

namespace robocell::python {

// Returns "MyExpert".
std::string ClassName(nb::handle self);
// Returns repr(), truncated if it is long.
std::string ShortRepr(nb::handle value);

// Returns the conversion by `convert` of the value that `method` of `self` returned; errors name
// the method.
template <class Convert>
std::invoke_result_t<Convert> ConvertReturned(nb::handle self, const char* method,
                                              Convert&& convert) {
  try {
    return convert();
  } catch (nb::python_error&) {  // of a value's own methods
    RethrowRaised(PlaceOfMethod(self, method));
  } catch (...) {
    RethrowAsHookError(PlaceOfMethod(self, method));
  }
}

// Throws "MyExpert.act() must return <expected>, got None". `place`: that of the function.
[[noreturn]] void ThrowReturned(const std::string& what, const std::string& expected,
                                nb::handle got, const std::string& place);
// The same for a method of `self`.
[[noreturn]] void ThrowReturned(nb::handle self, const char* method, const std::string& expected,
                                nb::handle got);
// Throws "MyExpert must define begin()". Takes the GIL.
[[noreturn]] void ThrowMissing(nb::handle self, const char* method);
// Raises TypeError that names the class unless its __init__ called super().__init__().
void RequireInitialised(nb::handle object);
// Raises TypeError unless it is None or can be called; `expected` as in "a function (run) ->
// TaskSampler".
void RequireCallable(nb::handle value, const char* argument, const char* expected);

// Describes the expected result of a method, for messages.
template <class R>
struct Expected {
  static std::string Text() {
    if constexpr (std::is_same_v<R, bool>) return "True or False";
    if constexpr (std::is_same_v<R, int>) return "a whole number";
    if constexpr (std::is_same_v<R, double>) return "a number";
    if constexpr (std::is_same_v<R, std::string>) return "a str";
    if constexpr (std::is_same_v<R, std::vector<std::string>>) return "a list of str";
    if constexpr (nb::detail::is_base_caster_v<nb::detail::make_caster<R>>) {
      return "a " + nb::cast<std::string>(nb::type<R>().attr("__name__"));
    }
  }
};
template <class T>
struct Expected<std::optional<T>> {
  static std::string Text() { return Expected<T>::Text() + " or None"; }
};

Action ReturnedAction(nb::handle self, const char* method, nb::handle value);

// Converts `value`, which method `method` of `self` returned. NumPy's numbers are accepted:
// comparing them gives a numpy bool.
template <class R>
R Returned(nb::handle self, const char* method, nb::handle value) {
  if constexpr (std::is_void_v<R>) {
    return;
  } else if constexpr (std::is_same_v<R, Action>) {
    return ReturnedAction(self, method, value);
  } else {
    R result{};
    if (nb::try_cast(value, result)) return result;
    if (nb::hasattr(value, "item") && nb::hasattr(value, "shape") &&
        nb::len(nb::object(value.attr("shape"))) == 0 &&
        nb::try_cast(nb::object(value.attr("item")()), result))
      return result;
    ThrowReturned(self, method, Expected<R>::Text(), value);
  }
}

}  // namespace robocell::python
