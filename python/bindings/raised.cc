#include "raised.h"

#include <fmt/format.h>

#include <utility>

#include "bindings.h"

namespace robocell::python {
namespace {

// Needs the GIL.
[[noreturn]] void ThrowRaised(const nb::python_error& error, const std::string& place_of_code) {
  const nb::object parts =
      nb::module_::import_("robocell._raised").attr("message_and_place")(error.value());
  const auto [message, place] = nb::cast<std::pair<std::string, std::string>>(parts);
  throw PythonHookError(message, place.empty() ? place_of_code : place, error);
}

// Returns true for what is no failure of the code: Ctrl-C, the end of a generator, and a policy that
// is not there.
bool IsNoFailure(const nb::python_error& error) {
  return error.matches(PyExc_KeyboardInterrupt) || error.matches(PyExc_GeneratorExit) ||
         error.matches(nb::module_::import_("robocell._raised").attr("NO_POLICY"));
}

}  // namespace

std::string PlaceOfCode(nb::handle function) {
  try {
    const nb::object written = nb::module_::import_("inspect").attr("unwrap")(function);
    const nb::object own = nb::getattr(written, "__func__", written);
    const nb::object code = nb::getattr(own, "__code__", nb::none());
    if (code.is_none()) return "";
    return fmt::format("{}:{}, in {}", nb::cast<std::string>(code.attr("co_filename")),
                       nb::cast<int>(code.attr("co_firstlineno")),
                       nb::cast<std::string>(code.attr("co_name")));
  } catch (const std::exception&) {
    return "";  // a message without a place is better than an error about the place
  }
}

std::string PlaceOfMethod(nb::handle self, const char* method) {
  const nb::gil_scoped_acquire gil;
  const nb::object own = nb::borrow(self);
  const nb::object written =
      nb::getattr(own, "_code_of", own);  // own code of functions that call another one's
  const nb::object function = nb::getattr(written, method, nb::none());
  return PlaceOfCode(function);
}

PythonHookError::PythonHookError(const std::string& message, const std::string& place,
                                 const nb::python_error& error)
    : HookError(message, place, Kind::kFailed),
      error_(std::make_shared<const nb::python_error>(error)) {}

std::string PythonHookError::trace() const {
  const nb::gil_scoped_acquire gil;
  return nb::cast<std::string>(
      nb::module_::import_("robocell._raised").attr("trace_of")(error_->value()));
}

void PythonHookError::Restore() const { nb::python_error(*error_).restore(); }

void PythonHookError::BecomeCause() const {
  nb::python_error raised;  // fetches it
  PyException_SetCause(raised.value().ptr(), nb::borrow(error_->value()).release().ptr());
  raised.restore();
}

void RethrowRaised(const std::string& place_of_code) {
  try {
    throw;
  } catch (const nb::python_error& error) {
    const nb::gil_scoped_acquire gil;
    if (IsNoFailure(error)) throw;
    ThrowRaised(error, place_of_code);
  }
}

void RethrowRaisedByMaker(nb::handle maker) {
  try {
    throw;
  } catch (const nb::python_error& error) {
    const nb::gil_scoped_acquire gil;
    if (error.matches(nb::module_::import_("robocell._core").attr("SpecError"))) throw;
    RethrowRaised(PlaceOfCode(maker));
  }
}

void RethrowAsHookError(const std::string& place) {
  try {
    throw;
  } catch (const HookError&) {
    throw;
  } catch (const nb::builtin_exception& error) {
    const bool is_type = error.type() == nb::exception_type::type_error;
    throw HookError(error.what(), place,
                    is_type ? HookError::Kind::kType : HookError::Kind::kValue);
  } catch (const Error& error) {
    throw HookError(error.what(), place);
  }
}

}  // namespace robocell::python
