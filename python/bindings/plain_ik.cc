// Inverse kinematics of one pose as loops ask for it: ik(pose, q), ik(pose, seed=q, tolerance=t),
// of a Pose and an array of float64.
//
// Python's lock is kept: with these options an answer takes microseconds, tenths of a millisecond
// where there is none, and letting go of the lock and taking it again takes longer than the
// arguments.
#include <algorithm>
#include <optional>
#include <span>

#include "arrays.h"
#include "kinematics.h"
#include "plain_calls.h"
#include "robocell/kinematics/ik.h"

namespace robocell::python {
namespace {

const double kTolerance = IkOptions{}.tolerance;

struct PlainQuestion {
  const Pose* target = nullptr;
  std::span<const double> seed{};
  double tolerance = kTolerance;
};

// The same each time but for what was asked: to make them takes longer than a step of the search.
// With Python's lock.
const IkOptions& OptionsOf(const PlainQuestion& question) {
  static auto& options = *new IkOptions;
  options.tolerance = question.tolerance;
  if (static_cast<size_t>(options.seed.size()) != question.seed.size())
    options.seed = JointVector(question.seed);
  std::copy(question.seed.begin(), question.seed.end(), options.seed.begin());
  return options;
}

// Classes are there for good; each is looked for once.
template <class T>
nb::handle ClassOf() {
  static PyObject* const type = nb::type<T>().ptr();
  return type;
}

// The object, if it is of this very class; no subclass.
template <class T>
const T* Exactly(nb::handle value) {
  const bool exact = value.type().is(ClassOf<T>());
  return exact && nb::inst_ready(value) ? nb::inst_ptr<T>(value) : nullptr;
}

bool ReadSeed(nb::handle value, PlainQuestion* question) {
  const auto row = RowOf(value);
  if (!row || row->empty()) return false;
  question->seed = *row;
  return true;
}

bool ReadKeyword(nb::handle name, nb::handle value, PlainQuestion* question) {
  static PyObject* const seed = PyUnicode_InternFromString("seed");
  static PyObject* const tolerance = PyUnicode_InternFromString("tolerance");
  if (name.ptr() == seed) return question->seed.empty() && ReadSeed(value, question);
  if (name.ptr() != tolerance || !PyFloat_CheckExact(value.ptr())) return false;
  question->tolerance = PyFloat_AS_DOUBLE(value.ptr());
  return true;
}

std::optional<PlainQuestion> ReadQuestion(PyObject* const* args, size_t count, PyObject* keywords) {
  if (count < 2 || count > 3) return std::nullopt;
  PlainQuestion question{.target = Exactly<Pose>(args[1])};
  if (!question.target || (count == 3 && !ReadSeed(args[2], &question))) return std::nullopt;
  for (Py_ssize_t i = 0; keywords && i < PyTuple_GET_SIZE(keywords); ++i) {
    if (!ReadKeyword(PyTuple_GET_ITEM(keywords, i), args[count + static_cast<size_t>(i)],
                     &question))
      return std::nullopt;
  }
  if (question.seed.empty()) return std::nullopt;
  return question;
}

const Chain* ChainNow(const Chain& chain) { return &chain; }
// Null where its scene is in use by another thread; throws where it is closed.
const Chain* ChainNow(const Robot& robot) {
  return robot.use().by_another_thread() ? nullptr : &robot.chain();
}
const Chain* ChainNow(const Kinematics& k) { return ChainNow(k.robot); }

template <class Self>
PyObject* AnswerPlainly(PyObject* const* args, size_t count, PyObject* keywords) {
  try {
    const auto question = ReadQuestion(args, count, keywords);
    const Self* self = question ? Exactly<Self>(args[0]) : nullptr;
    if (!self) return nullptr;
    const Chain* chain = ChainNow(*self);
    if (!chain) return nullptr;
    // Where it will be: nb::cast would look for it among all objects, and copy it.
    nb::object answer = nb::inst_alloc(ClassOf<IkResult>());
    new (nb::inst_ptr<IkResult>(answer))
        IkResult(Ik(*chain, *question->target, OptionsOf(*question)));
    nb::inst_mark_ready(answer);
    return answer.release().ptr();
  } catch (const std::exception&) {
    return nullptr;  // which nanobind's own call throws again, and tells
  }
}

}  // namespace

void SetPlainRobotIk(nb::handle robot) { SetPlainCall(robot.attr("ik"), &AnswerPlainly<Robot>); }
void SetPlainIk(nb::handle kinematics, nb::handle chain) {
  SetPlainCall(kinematics.attr("ik"), &AnswerPlainly<Kinematics>);
  SetPlainCall(chain.attr("ik"), &AnswerPlainly<Chain>);
}

}  // namespace robocell::python
