// Errors that also derive from Python's own classes, so that `except ValueError` and the like work.
#include <nanobind/nanobind.h>

#include <cstring>
#include <exception>
#include <filesystem>

#include "bindings.h"
#include "handles.h"
#include "python_owner.h"
#include "raised.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hook_error.h"
#include "robocell/base/plugin.h"
#include "robocell/base/version.h"

namespace nb = nanobind;

namespace robocell::python {
namespace {

// The classes live as long as the interpreter.
struct ErrorClasses {
  PyObject *error, *spec, *not_found, *argument, *closed, *diverged, *engine, *io;
};
ErrorClasses classes;

PyObject* NewClass(nb::module_& m, const char* name, const char* doc, PyObject* base,
                   PyObject* also = nullptr) {
  nb::object bases = also ? nb::make_tuple(nb::handle(base), nb::handle(also)) : nb::borrow(base);
  PyObject* type = PyErr_NewExceptionWithDoc((std::string("robocell.") + name).c_str(), doc,
                                             bases.ptr(), nullptr);
  if (!type) throw nb::python_error();
  m.attr(name) = nb::handle(type);
  return type;
}

// Messages may quote a file whose bytes are not UTF-8.
void Raise(PyObject* type, const char* what) {
  const nb::object text =
      nb::steal(PyUnicode_DecodeUTF8(what, Py_ssize_t(strlen(what)), "replace"));
  if (text.is_valid()) PyErr_SetObject(type, text.ptr());
}

PyObject* ClassOf(HookError::Kind kind) {
  switch (kind) {
    case HookError::Kind::kType:
      return PyExc_TypeError;
    case HookError::Kind::kValue:
      return classes.argument;
    case HookError::Kind::kFailed:
      break;
  }
  return classes.error;
}

// Gives the exception that is raised the one of Python code, around which `error` may be nested, as
// its cause.
void ChainCause(const Error& error) {
  try {
    std::rethrow_if_nested(error);
  } catch (const PythonHookError& cause) {
    cause.BecomeCause();
  } catch (const std::exception&) {
    return;  // the text says it
  }
}

void Translate(const std::exception_ptr& p, void*) {
  try {
    std::rethrow_exception(p);
  } catch (const SpecError& e) {
    Raise(classes.spec, e.what());
  } catch (const NotFoundError& e) {
    Raise(classes.not_found, e.what());
  } catch (const PythonHookError& e) {
    e.Restore();
  } catch (const HookError& e) {
    Raise(ClassOf(e.kind()), e.what());
  } catch (const ArgumentError& e) {
    Raise(classes.argument, e.what());
  } catch (const ClosedError& e) {
    Raise(classes.closed, e.what());
  } catch (const DivergedError& e) {
    Raise(classes.diverged, e.what());
  } catch (const EngineError& e) {
    Raise(classes.engine, e.what());
  } catch (const IoError& e) {
    Raise(classes.io, e.what());
  } catch (const Error& e) {
    Raise(classes.error, e.what());
    ChainCause(e);
  }
}

}  // namespace

void SetCaughtError() {
  try {
    Translate(std::current_exception(), nullptr);
  } catch (nb::python_error& error) {  // raised by a user's own group
    error.restore();
  } catch (const std::exception& error) {
    PyErr_SetString(PyExc_RuntimeError, error.what());
  }
}

void BindBase(nb::module_& m) {
  classes.error = NewClass(
      m, "Error",
      "Base of everything robocell raises."
      "\n\nExamples:\n"
      "    >>> try:\n"
      "    ...     scene.site_pose(\"tpc\")\n"
      "    ... except rc.Error as error:\n"
      "    ...     print(error)\n"
      "    scene 'cell': no site 'tpc'. Its sites: attachment_site, tcp. Did you mean 'tcp'?",
      PyExc_RuntimeError);
  classes.spec =
      NewClass(m, "SpecError",
               "A spec or file is wrong; lists every problem found."
               "\n\nExamples:\n"
               "    >>> try:\n"
               "    ...     rc.SceneSpec(timestep=0, add_floor=True, add_skybox=True).validate()\n"
               "    ... except rc.SpecError as error:\n"
               "    ...     print(error)\n"
               "    SceneSpec is not valid: timestep: 0 must be greater than 0",
               classes.error, PyExc_ValueError);
  classes.not_found =
      NewClass(m, "NotFoundError",
               "The requested name does not exist."
               "\n\nExamples:\n"
               "    >>> try:\n"
               "    ...     scene.robot(\"art\")\n"
               "    ... except rc.NotFoundError as error:\n"
               "    ...     print(error)\n"
               "    scene 'cell': no robot 'art'. Its robots: arm. Did you mean 'arm'?",
               classes.error, PyExc_LookupError);
  classes.argument =
      NewClass(m, "ArgumentError",
               "An argument has the wrong shape, range or kind."
               "\n\nExamples:\n"
               "    >>> try:\n"
               "    ...     robot.fk_frame([0, 0.3])\n"
               "    ... except rc.ArgumentError as error:\n"
               "    ...     print(error)\n"
               "    chain 'base_link' -> site 'tcp': q: expected 7 joint values, got 2",
               classes.error, PyExc_ValueError);
  classes.closed =
      NewClass(m, "ClosedError", "The object was closed or removed from its scene.", classes.error);
  classes.diverged = NewClass(m, "DivergedError", "The simulation diverged.", classes.error);
  classes.engine = NewClass(m, "EngineError", "MuJoCo reported an error.", classes.error);
  classes.io = NewClass(m, "IoError",
                        "A file, folder or child process failed."
                        "\n\nExamples:\n"
                        "    >>> try:\n"
                        "    ...     rc.Dataset(\"nowhere\")\n"
                        "    ... except rc.IoError as error:\n"
                        "    ...     print(str(error).split(\". \")[0])\n"
                        "    no dataset 'nowhere': there is no such folder",
                        classes.error, PyExc_OSError);
  nb::register_exception_translator(Translate);
  nb::module_::import_("atexit").attr("register")(nb::cpp_function(&ReleaseHeld));
  m.attr("__version__") = std::string(Version());
  m.def(
      "atomic_write",
      [](const std::filesystem::path& path, const nb::bytes& content) {
        AtomicWrite(path, {content.c_str(), content.size()});
      },
      nb::arg("path"), nb::arg("content"),
      "Replaces a file in one step: the old content or the new, never half, and on the disk. "
      "Raises IoError with path and reason.");
  m.def(
      "load_plugin", [](const std::filesystem::path& path) { return LoadPlugin(path.string()); },
      nb::arg("path"),
      "Loads a shared library that registers kinds of tasks, experts, scene sources or samplers "
      "(ROBOCELL_PLUGIN in C++), once in a process. Returns its full path. Raises IoError if it "
      "cannot be loaded, and ArgumentError if it is not a plugin, is for another version, or "
      "failed to register before in this process.");
  m.def(
      "temporary_path",
      [](const std::filesystem::path& parent, const std::string& name) {
        return TemporaryPath(parent, name);
      },
      nb::arg("parent"), nb::arg("name"),
      "Returns a hidden name for unfinished files, a new one with each call. If another process "
      "has taken it, call again. Remains are found by the name and removed.");
}

}  // namespace robocell::python
