// The log: its level, and a sink written in Python.
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "bindings.h"
#include "python_owner.h"
#include "returned.h"
#include "robocell/base/log.h"

namespace robocell::python {
namespace {

nb::object Text(std::string_view text) {
  // Messages may quote a file whose bytes are not UTF-8.
  const auto size = static_cast<Py_ssize_t>(text.size());
  nb::object decoded = nb::steal(PyUnicode_DecodeUTF8(text.data(), size, "replace"));
  if (!decoded.is_valid()) throw nb::python_error();
  return decoded;
}

// A sink: a function (level, message) that any thread may call.
class PythonSink {
 public:
  explicit PythonSink(nb::object function) : function_(std::move(function)) {}

  PyObject* target() const { return function_.target(); }

  // Its exceptions go to sys.unraisablehook. The next check for signals sees a Ctrl-C.
  void operator()(LogLevel level, std::string_view message) const {
    const nb::gil_scoped_acquire gil;
    const nb::error_scope other;  // the message may be about an error that is set
    const std::shared_ptr<PyObject> function = function_.share();  // it may replace itself
    if (!function) return;
    try {
      nb::handle(function.get())(Text(LogLevelName(level)), Text(message));
    } catch (nb::python_error& error) {
      if (error.matches(PyExc_KeyboardInterrupt)) return PyErr_SetInterrupt();
      error.discard_as_unraisable(nb::handle(function.get()));
    }
  }

 private:
  Held function_;
};

// The function of a sink; None for stderr.
nb::object FunctionOf(const LogSink& sink) {
  const auto* python = sink.target<PythonSink>();
  PyObject* function = python ? python->target() : nullptr;
  return function ? nb::borrow(function) : nb::none();
}

nb::object SetSink(nb::object function) {
  if (!function.is_none() && !PyCallable_Check(function.ptr())) {
    const std::string got = ShortRepr(function);
    throw nb::type_error(
        ("set_log_sink(): `sink` must be a function (level, message) or None, got " + got).c_str());
  }
  LogSink sink;
  if (!function.is_none()) sink = PythonSink(std::move(function));
  return FunctionOf(SetLogSink(std::move(sink)));
}

}  // namespace

void BindLog(nb::module_& m) {
  m.def(
      "set_log_level", [](const std::string& level) { SetLogLevel(LogLevelFromName(level)); },
      nb::arg("level"),
      "Shows messages of this level and everything more severe: 'debug', 'info', 'warn', 'error'. "
      "'none' shows nothing.");
  m.def(
      "log_level", [] { return std::string(LogLevelName(GetLogLevel())); },
      "Returns the present level: 'debug', 'info', 'warn', 'error' or 'none'.");
  m.def("set_log_sink", &SetSink, nb::arg("sink").none(),
        nb::sig("def set_log_sink(sink: collections.abc.Callable[[str, str], typing.Any] | None) "
                "-> collections.abc.Callable[[str, str], typing.Any] | None"),
        "Passes each message of the level to sink(level, message) instead of stderr, in this "
        "process; None restores stderr, as does the end of Python. Returns the previous sink, None "
        "for stderr.\n\n`level` is 'debug', 'info', 'warn' or 'error'. The sink is called in the "
        "thread that logs, possibly by several threads at once, in the middle of the call that "
        "logs: it should not use the scene of that call. Its exceptions go to sys.unraisablehook, "
        "and the call continues. Raises TypeError for a sink that cannot be called.");
  // Other threads may log when Python is no longer available.
  nb::module_::import_("atexit").attr("register")(nb::cpp_function([] { SetLogSink({}); }));
}

}  // namespace robocell::python
