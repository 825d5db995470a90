// Wraps every call: claims the scenes that it uses, rejects calls of closed handles (handles.h),
// and explains arguments that do not fit.
//
// nanobind has no hook for either. Its functions are called through a pointer in each function
// object (CPython's vectorcall protocol). The pointer is replaced by that of a function that calls
// the original and examines its error. A successful call costs one more jump, and that of a handle
// a look-up.
#include "argument_errors.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "handles.h"
#include "returned.h"
#include "robocell/base/error.h"

namespace robocell::python {
namespace {

constexpr std::string_view kMismatch = "(): incompatible function arguments.";

// Returns true if nanobind raised the error for this very call. An error from inside the call has
// passed through Python, or belongs to a function of another name (pybind11 uses the same words).
bool IsOfThisCall(nb::handle function, const nb::python_error& error) {
  if (error.traceback().is_valid()) return false;
  const auto text = nb::cast<std::string>(nb::str(error.value()));
  return text.starts_with(nb::cast<std::string>(function.attr("__name__")) +
                          std::string(kMismatch));
}

struct Named {
  std::string name;  // "Scene.step_n", "Pose"
  bool is_constructor = false, is_setter = false;
  SelfCheck self = {};  // object whose function it is
  bool takes_handles = false;
};

// Names of functions; they live as long as the module.
auto& Names() {
  static auto* names = new std::unordered_map<PyObject*, Named>;
  return *names;
}

// nanobind rejects a subclass without super().__init__() as an argument of its own class; this
// exception explains it.
void RequireInitialised(const nb::tuple& args, const nb::dict& kwargs, bool but_the_first) {
  for (size_t i = but_the_first ? 1 : 0; i < args.size(); ++i)
    python::RequireInitialised(nb::object(args[i]));
  for (const auto& [key, value] : kwargs) python::RequireInitialised(value);
}

void Explain(PyObject* function, PyObject* const* given, size_t count, PyObject* keywords) {
  if (!PyErr_ExceptionMatches(PyExc_TypeError)) return;
  nb::python_error mismatch;
  try {
    const auto named = Names().find(function);
    if (named == Names().end() || !IsOfThisCall(function, mismatch)) return mismatch.restore();
    nb::list positional;
    for (size_t i = 0; i < count; ++i) positional.append(nb::handle(given[i]));
    nb::dict kwargs;
    for (Py_ssize_t i = 0; keywords && i < PyTuple_GET_SIZE(keywords); ++i)
      kwargs[nb::handle(PyTuple_GET_ITEM(keywords, i))] = nb::handle(given[count + size_t(i)]);
    const auto args = nb::steal<nb::tuple>(PyList_AsTuple(positional.ptr()));
    const Named& call = named->second;
    RequireInitialised(args, kwargs, call.is_constructor);
    const nb::object message =
        nb::module_::import_("robocell._arguments")
            .attr("explain")(call.name, call.is_setter, nb::handle(function), args, kwargs);
    PyErr_SetObject(PyExc_TypeError, message.ptr());
  } catch (nb::python_error& error) {
    (error.matches(PyExc_Exception) ? mismatch : error).restore();  // Ctrl-C does not explain it
  } catch (const nb::builtin_exception& error) {                    // raised by RequireInitialised
    PyErr_SetString(PyExc_TypeError, error.what());
  } catch (const std::exception&) {
    mismatch.restore();
  }
}

// The high bits of the count are flags of CPython and nanobind.
constexpr size_t kArgumentCount = (size_t{1} << 32) - 1;
constexpr size_t kMostOriginals = 16;  // nanobind has one for each of a few forms of signatures
std::array<vectorcallfunc, kMostOriginals> originals = {};

// Claims the scenes of the arguments and checks the object. Returns true if the function may be
// called; otherwise the error is set.
bool MayCall(const Named& call, PyObject* const* args, size_t count, PyObject* keywords,
             SceneClaims& claims) {
  try {
    if (call.self.guard && count > 0)
      (*call.self.guard)(nb::handle(args[0]), claims, call.self.must_be_open);
    if (!call.takes_handles) return true;
    if (keywords) count += static_cast<size_t>(PyTuple_GET_SIZE(keywords));
    for (size_t i = 0; i < count; ++i) UseArgument(nb::handle(args[i]), claims);
    return true;
  } catch (const std::exception&) {
    SetCaughtError();
  }
  return false;
}

template <size_t i>
PyObject* CallOriginal(PyObject* function, PyObject* const* args, size_t count,
                       PyObject* keywords) {
  PyObject* result = originals[i](function, args, count, keywords);
  if (!result) Explain(function, args, count & kArgumentCount, keywords);
  return result;
}

enum class Calls { kFree, kGuarded };

template <size_t i, Calls calls>
PyObject* Call(PyObject* function, PyObject* const* args, size_t count, PyObject* keywords) {
  if constexpr (calls == Calls::kGuarded) {
    const Named& call = Names().find(function)->second;
    SceneClaims claims(call.name.c_str());
    if (!MayCall(call, args, count & kArgumentCount, keywords, claims)) return nullptr;
    return CallOriginal<i>(function, args, count, keywords);
  } else {
    return CallOriginal<i>(function, args, count, keywords);
  }
}

template <Calls calls, size_t... i>
constexpr std::array<vectorcallfunc, kMostOriginals> AllCalls(std::index_sequence<i...>) {
  return {&Call<i, calls>...};
}

// Returns the call that replaces an original one.
vectorcallfunc InPlaceOf(vectorcallfunc original, Calls calls) {
  static constexpr auto kIndices = std::make_index_sequence<kMostOriginals>();
  static constexpr auto kFree = AllCalls<Calls::kFree>(kIndices),
                        kGuarded = AllCalls<Calls::kGuarded>(kIndices);
  for (size_t i = 0; i < kMostOriginals; ++i) {
    if (!originals[i]) originals[i] = original;
    if (originals[i] != original) continue;
    return (calls == Calls::kFree ? kFree : kGuarded)[i];
  }
  throw Error("nanobind calls its functions in more ways than the module can wrap");
}

void Wrap(nb::handle function, Named named) {
  const Py_ssize_t offset = Py_TYPE(function.ptr())->tp_vectorcall_offset;
  if (offset <= 0 || !nb::hasattr(function, "__nb_signature__")) return;
  for (const auto& overload : function.attr("__nb_signature__"))
    named.takes_handles |= !named.self.never && TakesHandles(nb::cast<std::string>(overload[0]));
  const Calls calls = named.self.guard || named.takes_handles ? Calls::kGuarded : Calls::kFree;
  if (!Names().emplace(function.ptr(), std::move(named)).second) return;  // under two names
  auto& call = *reinterpret_cast<vectorcallfunc*>(reinterpret_cast<char*>(function.ptr()) + offset);
  call = InPlaceOf(call, calls);
}

// Rejects setting an unknown attribute, with the known names. Reading is not wrapped, because
// Python itself suggests the nearest name and each call would cost more.
int SetAttribute(PyObject* self, PyObject* name, PyObject* value) {
  const int result = PyObject_GenericSetAttr(self, name, value);
  if (result == 0 || !PyErr_ExceptionMatches(PyExc_AttributeError)) return result;
  nb::python_error error;
  try {
    if (nb::hasattr(nb::handle(self).type(), nb::handle(name))) return error.restore(), result;
    const nb::object message = nb::module_::import_("robocell._arguments")
                                   .attr("no_attribute")(nb::handle(self).type(), nb::handle(name));
    PyErr_SetObject(PyExc_AttributeError, message.ptr());
  } catch (nb::python_error& other) {
    (other.matches(PyExc_Exception) ? error : other).restore();
  }
  return result;
}

// Does not apply to subclasses made in Python, which take any name.
void WrapSetAttribute(nb::handle type) {
  auto* slots = reinterpret_cast<PyTypeObject*>(type.ptr());
  if (slots->tp_setattro != &PyObject_GenericSetAttr) return;
  slots->tp_setattro = &SetAttribute;
  PyType_Modified(slots);
}

// Returns the members of a module or class, by name.
nb::dict MembersOf(nb::handle owner) {
  nb::dict members;  // a class has only a view of a dict
  members.attr("update")(owner.attr("__dict__"));
  return members;
}

void WrapClass(const std::string& name, nb::handle type) {
  for (const auto& [key, member] : MembersOf(type)) {
    const auto member_name = nb::cast<std::string>(key);
    const bool is_constructor = member_name == "__init__";
    const std::string full = fmt::format("{}.{}", name, member_name);
    const SelfCheck self_of = CheckOfSelf(type, member_name);
    Wrap(member, {is_constructor ? name : full, is_constructor, false, self_of});
    if (Py_TYPE(member.ptr()) != &PyProperty_Type) continue;
    Wrap(member.attr("fget"), {.name = full, .self = self_of});
    Wrap(member.attr("fset"), {.name = full, .is_setter = true, .self = self_of});
  }
}

}  // namespace

void ExplainArgumentErrors(nb::module_& m) {
  for (const auto& [key, member] : MembersOf(m)) {
    const auto name = nb::cast<std::string>(key);
    if (PyType_Check(member.ptr())) {
      WrapClass(name, member);
      WrapSetAttribute(member);
    } else {
      Wrap(member, {.name = name});
    }
  }
}

}  // namespace robocell::python
