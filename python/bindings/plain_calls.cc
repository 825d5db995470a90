#include "plain_calls.h"

#include <array>

#include "robocell/base/error.h"

namespace robocell::python {
namespace {

struct PlainFunction {
  PyObject* function = nullptr;
  PlainCall call = nullptr;
};

// Few, in one or two lines of memory: found sooner than in a map.
std::array<PlainFunction, 4> plain_functions = {};

}  // namespace

void SetPlainCall(nb::handle function, PlainCall call) {
  for (PlainFunction& plain : plain_functions) {
    if (plain.function) continue;
    plain = {function.ptr(), call};
    return;
  }
  throw Error("there are more plain calls than places for them");
}

PlainCall PlainCallOf(nb::handle function) {
  for (const PlainFunction& plain : plain_functions) {
    if (plain.function == function.ptr()) return plain.call;
  }
  return nullptr;
}

}  // namespace robocell::python
