// For tests only: expects an exception of a type whose message contains a text.
//
//   ExpectThrow<NotFoundError>([&] { scene.robot("lft"); }, "Did you mean 'left'?");
#pragma once

#include <exception>
#include <memory>
#include <string>
#include <type_traits>
#include <typeinfo>

namespace robocell {

// ExpectThrow with the types hidden: tests have hundreds, so the common part is compiled once.
// `call` calls what `function` points to.
std::string ExpectThrown(void (*call)(void* function), void* function,
                         const std::type_info& expected,
                         bool (*is_expected)(const std::exception& thrown),
                         const std::string& text);

// Returns the message for further checks; "" if nothing of that type was thrown.
template <typename Exception, typename Function>
std::string ExpectThrow(Function&& function, const std::string& text) {
  static_assert(std::is_base_of_v<std::exception, Exception>);
  using Called = std::remove_reference_t<Function>;
  return ExpectThrown([](void* f) { (*static_cast<Called*>(f))(); },
                      const_cast<std::remove_const_t<Called>*>(std::addressof(function)),
                      typeid(Exception),
                      [](const std::exception& thrown) {
                        return dynamic_cast<const Exception*>(&thrown) != nullptr;
                      },
                      text);
}

}  // namespace robocell
