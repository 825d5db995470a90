// Tasks, samplers and experts that are subclassed in Python. Each class here is between a C++
// class, abstract or not, and its Python subclasses: it calls a method that Python defines, with
// the GIL, else the C++ class's own, if it has one.
//
// For a class that is not abstract, Python's binding calls that class's own method, so that
// super().reward(scene) in a subclass works as expected.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/trampoline.h>

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "bindings.h"
#include "returned.h"
#include "rng.h"
#include "values.h"
#include "robocell/expert/expert.h"
#include "robocell/scene/scene.h"
#include "robocell/task/task.h"
#include "robocell/task/task_sampler.h"

namespace robocell::python {

// Converts the result of Task.places; raises TypeError that names an invalid place.
Map<ObjectPlace> ToPlaces(nanobind::handle made);

// Calls the Python method if there is one, else `own`. Raises TypeError without either, and for
// results that returned.h cannot convert. `own` is a generic lambda: for abstract classes it is not
// compiled.
template <class R, class Base, class Own, class... Args>
R CallMethod(const nb::detail::trampoline& trampoline, const char* name, Base* self, Own own,
             const Args&... args) {
  const nb::detail::ticket call(trampoline, name, nb::detail::str_hash(name), false);
  if (!call.key.is_valid()) {
    if constexpr (std::is_abstract_v<Base>) {
      ThrowMissing(trampoline.base(), name);
    } else {
      return own(self);
    }
  }
  const nb::handle self_object = trampoline.base();
  return Returned<R>(self_object, name, CallPython(self_object, name, [&] {
                       return nb::object(self_object.attr(call.key)(args...));
                     }));
}

// The same with a random stream as the last argument, lent to Python for the call.
template <class R, class Base, class Own, class... Args>
R CallWithRng(const nb::detail::trampoline& trampoline, const char* name, Base* self, Own own,
              Rng& rng, const Args&... args) {
  const RngLoan loan(rng);
  return CallMethod<R>(trampoline, name, self, own, args..., loan.rng());
}

// Returns true if Python defines a method.
inline bool Defines(const nb::detail::trampoline& trampoline, const char* name) {
  return nb::detail::ticket(trampoline, name, nb::detail::str_hash(name), false).key.is_valid();
}

// Returns "MyTask.signals()", for messages.
inline std::string MethodText(nb::handle self, const char* method) {
  return ClassName(self) + "." + method + "()";
}

// Converts the results of a task's methods; errors name class and method.
TaskVerdict ToVerdict(nb::handle self, nb::handle made);
std::vector<Feature> ToSignals(nb::handle self, nb::handle made);
void PutSignals(nb::handle self, nb::handle made, const std::vector<Feature>& signals,
                std::span<double> out);
std::vector<double> ToMemory(nb::handle self, nb::handle made);
BodyPoses ToStarts(nb::handle self, nb::handle made);
nb::object MemoryArray(std::span<const double> memory);

// The memory of a task that does not define memory(): its attributes (robocell/_task_memory.py).
// The last two take the GIL.
void RememberBound(nb::handle self);
void AddMemoryOfAttributes(nb::handle self, std::vector<double>& memory);
void RecallAttributes(nb::handle self, std::span<const double> memory);
bool HasAttributes(std::span<const double> memory);

template <class Base>
class PyTaskOf : public Base {
 public:
  NB_TRAMPOLINE(Base);
  std::string PlaceOfHook(const char* method) const override {
    const bool judges = Defines(nb_trampoline, "judge");
    return PlaceOfMethod(self(),
                         std::string_view(method) == "judge" && !judges ? "reward" : method);
  }
  void Prepare(SceneSpec& spec, Rng& rng) override {
    if (!Defines(nb_trampoline, "prepare")) return Base::Prepare(spec, rng);
    const nb::gil_scoped_acquire acquire;
    const RngLoan loan(rng);
    const nb::object own = nb::cast(SceneSpec(spec));
    Call("prepare", own, loan.rng());
    spec = nb::cast<SceneSpec&>(own);
  }
  void Bind(const Scene& scene, const TaskSetting& setting) override {
    if (!Defines(nb_trampoline, "bind")) Base::Bind(scene, setting);
    const nb::gil_scoped_acquire acquire;
    if (Defines(nb_trampoline, "bind")) Call("bind", Scene(scene), setting);
    RememberBound(self());
  }
  BodyPoses Starts(Rng& rng) override {
    if (!Defines(nb_trampoline, "starts")) return Base::Starts(rng);
    const nb::gil_scoped_acquire acquire;
    const RngLoan loan(rng);
    return ToStarts(self(), Call("starts", loan.rng()));
  }
  std::optional<Refusal> Arrange(Scene& scene, Rng& rng) override {
    if (!Defines(nb_trampoline, "arrange")) return Base::Arrange(scene, rng);
    const nb::gil_scoped_acquire acquire;
    const RngLoan loan(rng);
    return Returned<std::optional<Refusal>>(self(), "arrange",
                                            Call("arrange", Scene(scene), loan.rng()));
  }
  std::optional<Refusal> CheckStart(const Scene& scene) override {
    if (!Defines(nb_trampoline, "check_start")) return Base::CheckStart(scene);
    const nb::gil_scoped_acquire acquire;
    return Returned<std::optional<Refusal>>(self(), "check_start",
                                            Call("check_start", Scene(scene)));
  }
  void Begin(const Scene& scene) override {
    has_begun_ = true;
    if (!Defines(nb_trampoline, "begin")) return Base::Begin(scene);
    const nb::gil_scoped_acquire acquire;
    Call("begin", Scene(scene));
  }
  TaskVerdict Judge(const Scene& scene) override {
    if (Defines(nb_trampoline, "judge")) {
      const nb::gil_scoped_acquire acquire;
      return ToVerdict(self(), Call("judge", Scene(scene)));
    }
    return JudgeByParts(scene);
  }
  // Judges by reward() and success(): what judge() of the base class does.
  TaskVerdict JudgeByParts(const Scene& scene) {
    TaskVerdict verdict;
    const bool rewards = Defines(nb_trampoline, "reward");
    const bool succeeds = Defines(nb_trampoline, "success");
    if constexpr (std::is_abstract_v<Base>) {
      if (!succeeds) ThrowMissing(self(), rewards ? "success" : "judge");
      if (!rewards) ThrowMissing(self(), "reward");
    } else {
      if (!rewards || !succeeds) verdict = Base::Judge(scene);
    }
    const nb::gil_scoped_acquire acquire;
    if (rewards) verdict.reward = Returned<double>(self(), "reward", Call("reward", Scene(scene)));
    if (succeeds)
      verdict.success = Returned<bool>(self(), "success", Call("success", Scene(scene)));
    return verdict;
  }
  std::string instruction() const override {
    return CallMethod<std::string>(nb_trampoline, "instruction", static_cast<const Base*>(this),
                                   [](auto* self) { return self->Base::instruction(); });
  }
  std::vector<std::string> objects() const override {
    if (!Defines(nb_trampoline, "objects")) return Base::objects();
    const nb::gil_scoped_acquire acquire;
    return Names("objects");
  }
  std::string object_of(const std::string& name) const override {
    if (!Defines(nb_trampoline, "object_of")) return Base::object_of(name);
    const nb::gil_scoped_acquire acquire;
    return Returned<std::string>(self(), "object_of", Call("object_of", name));
  }
  std::string kind_of(const std::string& object) const override {
    if (!Defines(nb_trampoline, "kind_of")) return Base::kind_of(object);
    const nb::gil_scoped_acquire acquire;
    return Returned<std::string>(self(), "kind_of", Call("kind_of", object));
  }
  std::vector<std::string> resting_objects() const override {
    if (!Defines(nb_trampoline, "resting_objects")) return Base::resting_objects();
    const nb::gil_scoped_acquire acquire;
    return Names("resting_objects");
  }
  std::vector<std::string> subtasks() const override {
    if (!Defines(nb_trampoline, "subtasks")) return Base::subtasks();
    const nb::gil_scoped_acquire acquire;
    return Names("subtasks");
  }
  std::string why_not_done() const override {
    if (!Defines(nb_trampoline, "why_not_done")) return Base::why_not_done();
    const nb::gil_scoped_acquire acquire;
    return Returned<std::string>(self(), "why_not_done", Call("why_not_done"));
  }
  BaseRange base_range() const override {
    if (!Defines(nb_trampoline, "base_range")) return Base::base_range();
    const nb::gil_scoped_acquire acquire;
    const nb::object made = Call("base_range");
    if (!nb::isinstance<BaseRange>(made)) ThrowReturned(self(), "base_range", "a BaseRange", made);
    return nb::cast<BaseRange>(made);
  }
  Map<ObjectPlace> places() const override {
    if (!Defines(nb_trampoline, "places")) return Base::places();
    const nb::gil_scoped_acquire acquire;
    return ConvertReturned(self(), "places", [&] { return ToPlaces(Call("places")); });
  }
  std::vector<Feature> signals() const override {
    if (!Defines(nb_trampoline, "signals")) return Base::signals();
    const nb::gil_scoped_acquire acquire;
    return signals_ = ToSignals(self(), Call("signals"));
  }
  void Observe(const Scene& scene, std::span<double> out) const override {
    if (!Defines(nb_trampoline, "observe")) {
      if (!signals_.empty()) ThrowMissing(self(), "observe");
      return Base::Observe(scene, out);
    }
    const nb::gil_scoped_acquire acquire;
    PutSignals(self(), Call("observe", Scene(scene)), signals_, out);
  }
  std::vector<double> memory() const override {
    const nb::gil_scoped_acquire acquire;
    if (has_memory()) return ToMemory(self(), Call("memory"));
    std::vector<double> memory = Base::memory();
    AddMemoryOfAttributes(self(), memory);
    return memory;
  }
  void Recall(std::span<const double> memory) override {
    if (!has_memory()) {
      const size_t own = Base::memory().size();
      Base::Recall(memory.first(own));
      return RecallAttributes(self(), memory.subspan(own));
    }
    const nb::gil_scoped_acquire acquire;
    Call("recall", MemoryArray(memory));
  }
  bool CanRecall(std::span<const double> memory) const override {
    // Its own memory() may need what begin() sets.
    if (has_memory()) return !has_begun_ || Base::CanRecall(memory);
    return memory.size() >= Base::memory().size();
  }
  std::string WhyNotRecalled(std::span<const double> memory) const override {
    return has_memory() ? "" : Base::WhyNotRecalled(memory.first(Base::memory().size()));
  }
  bool HoldsElsewhere(std::span<const double> memory) const override {
    return has_memory() || !HasAttributes(memory.subspan(Base::memory().size()));
  }

 private:
  nb::handle self() const { return nb_trampoline.base(); }
  template <class... Args>
  nb::object Call(const char* name, const Args&... args) const {
    return CallPython(self(), name, [&] { return nb::object(self().attr(name)(args...)); });
  }
  std::vector<std::string> Names(const char* name) const {
    return Returned<std::vector<std::string>>(self(), name, Call(name));
  }

  // Returns true if Python defines memory() and recall(). Raises TypeError for one without the
  // other.
  bool has_memory() const {
    const bool remembers = Defines(nb_trampoline, "memory");
    if (remembers == Defines(nb_trampoline, "recall")) return remembers;
    ThrowMissing(self(), remembers ? "recall" : "memory");
  }

  mutable std::vector<Feature> signals_;
  bool has_begun_ = false;
};

// Returns the recorded values of a state: {name: array}, images by the names of their streams;
// copies.
nb::dict RowArrays(const CellRow& row);

// A row for Python, which may keep it. Its numbers are one array, of which Python makes views by name
// when they are read. Its images are copied when one of them is first read, so that nothing is drawn
// for code that reads numbers alone. An image that was not read until the
// loan ends is an error that says so.
class RowLoan {
 public:
  RowLoan() = default;
  ~RowLoan() { End(); }
  RowLoan(const RowLoan&) = delete;
  RowLoan& operator=(const RowLoan&) = delete;

  // Lends a row, and ends the loan of the last one. With the GIL.
  nb::object Lend(const CellRow& row);
  // Waits for threads that read images.
  void End();

 private:
  struct Lent;
  struct NamedShape {
    std::string name;
    std::vector<int64_t> shape;
  };

  bool IsLaidOut(const FeatureSchema& schema) const;
  void LayOut(const FeatureSchema& schema);

  std::shared_ptr<Lent> lent_;
  std::vector<NamedShape> laid_out_;
  nb::object layout_;  // where each number of these features is
  nb::object make_;    // Row.of: importing it in every row takes long
};

template <class Base>
class PyExpertOf : public Base {
 public:
  NB_TRAMPOLINE(Base);
  std::string PlaceOfHook(const char* method) const override {
    return PlaceOfMethod(nb_trampoline.base(), method);
  }
  void Begin(const Scene& scene, Rng& rng) override {
    CallWithRng<void>(
        nb_trampoline, "begin", static_cast<Base*>(this),
        [&](auto* self) { self->Base::Begin(scene, rng); }, rng, scene);
  }
  Action Act(const Scene& scene, Rng& rng) override {
    const struct AtEnd {
      ~AtEnd() { row.End(); }
      RowLoan& row;
    } at_end{row_};
    return CallWithRng<Action>(
        nb_trampoline, "act", static_cast<Base*>(this),
        [&](auto* self) { return self->Base::Act(scene, rng); }, rng, scene);
  }
  void See(const CellRow& row) override {
    if (!Defines(nb_trampoline, "see")) return Base::See(row);
    row_.End();
    const nb::gil_scoped_acquire acquire;
    const nb::handle self = nb_trampoline.base();
    CallPython(self, "see", [&] { self.attr("see")(row_.Lend(row)); });
  }
  bool done() const override {
    return Ask<bool>("done", [](auto* self) { return self->Base::done(); });
  }
  std::string failure() const override {
    return Ask<std::string>("failure", [](auto* self) { return self->Base::failure(); });
  }
  bool ends_at_success() const override {
    if (!Defines(nb_trampoline, "ends_at_success")) return Base::ends_at_success();
    return Ask<bool>("ends_at_success", [](auto* self) { return self->Base::ends_at_success(); });
  }
  int phase() const override {
    return Ask<int>("phase", [](auto* self) { return self->Base::phase(); });
  }
  std::vector<std::string> phase_names() const override {
    return Ask<std::vector<std::string>>("phase_names",
                                         [](auto* self) { return self->Base::phase_names(); });
  }
  std::string results_json() const override {
    if (!Defines(nb_trampoline, "results_json")) return Base::results_json();
    return Ask<std::string>("results_json", [](auto* self) { return self->Base::results_json(); });
  }

 private:
  RowLoan row_;  // the one that see() got last

  template <class R, class Own>
  R Ask(const char* name, Own own) const {
    return CallMethod<R>(nb_trampoline, name, static_cast<const Base*>(this), own);
  }
};

// Converts the result of sample() of `self`; raises TypeError for anything but an EpisodeStart or a
// Refusal.
SampleResult ToSampleResult(nb::handle self, nb::handle made);
// Samples without the GIL; Ctrl-C ends it. Returns an EpisodeStart or a Refusal.
nb::object SampleForPython(const SampleRequest& request, PythonRng& rng,
                           const std::function<SampleResult(const SampleRequest&, Rng&)>& sample);

// A request for Python, which may keep it: its stop function is lent during a call, and a kept copy
// returns false later.
class RequestLoan {
 public:
  explicit RequestLoan(const SampleRequest& request)
      : lent_(std::make_shared<const StopRequest*>(&request.stop)),
        request_{request.scene, request.episode, request.attempt,
                 [lent = lent_] { return *lent && ShouldStop(**lent); }} {}
  ~RequestLoan() { *lent_ = nullptr; }
  RequestLoan(const RequestLoan&) = delete;
  RequestLoan& operator=(const RequestLoan&) = delete;

  const SampleRequest& request() const { return request_; }

 private:
  std::shared_ptr<const StopRequest*> lent_;
  SampleRequest request_;
};

template <class Base>
class PySamplerOf : public Base {
 public:
  NB_TRAMPOLINE(Base);
  std::string PlaceOfHook(const char* method) const override {
    return PlaceOfMethod(nb_trampoline.base(), method);
  }
  SampleResult Sample(const SampleRequest& request, Rng& rng) override {
    const nb::detail::ticket call(nb_trampoline, "sample", nb::detail::str_hash("sample"), false);
    if (!call.key.is_valid()) {
      if constexpr (std::is_abstract_v<Base>) {
        ThrowMissing(nb_trampoline.base(), "sample");
      } else {
        return Base::Sample(request, rng);
      }
    }
    const RngLoan loan(rng);
    const RequestLoan lent_request(request);
    const nb::handle self = nb_trampoline.base();
    return ToSampleResult(
        self, CallPython(self, "sample", [&] {
          return nb::object(self.attr(call.key)(lent_request.request(), loan.rng()));
        }));
  }
};

}  // namespace robocell::python
