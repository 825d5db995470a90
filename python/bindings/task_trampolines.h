// Tasks, samplers and experts that are subclassed in Python. Each class here stands between a C++
// class, abstract or not, and its Python subclasses: a method that Python defines is called, with
// the GIL; else the C++ class's own, if it has one.
//
// What is bound for Python of a class that is not abstract calls that class's own method, so that
// super().reward(scene) in a subclass means what it says.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/trampoline.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "bindings.h"
#include "returned.h"
#include "rng.h"
#include "robocell/task/task.h"

namespace robocell::python {

// Calls the Python method when there is one, else `own`. TypeError without either, and
// for what returned.h cannot convert. `own` is a generic lambda: for abstract classes it is not
// compiled.
template <class R, class Base, class Own, class... Args>
R CallMethod(const nb::detail::trampoline& trampoline, const char* name, Base* self, Own own,
             const Args&... args) {
  const nb::detail::ticket call(trampoline, name, nb::detail::str_hash(name), false);
  if constexpr (std::is_abstract_v<Base>) {
    if (!call.key.is_valid()) ThrowMissing(trampoline.base(), name);
    return Returned<R>(trampoline.base(), name, trampoline.base().attr(call.key)(args...));
  } else {
    if (!call.key.is_valid()) return own(self);
    return Returned<R>(trampoline.base(), name, trampoline.base().attr(call.key)(args...));
  }
}

// The same with a random stream as the last argument, lent to Python for the call.
template <class R, class Base, class Own, class... Args>
R CallWithRng(const nb::detail::trampoline& trampoline, const char* name, Base* self, Own own,
              Rng& rng, const Args&... args) {
  const RngLoan loan(rng);
  return CallMethod<R>(trampoline, name, self, own, args..., loan.rng());
}

template <class Base>
class PyTaskOf : public Base {
 public:
  NB_TRAMPOLINE(Base);
  void Begin(const Scene& scene) override {
    Call<void>(
        "begin", [&](auto* self) { self->Base::Begin(scene); }, scene);
  }
  double Reward(const Scene& scene) override {
    return Call<double>(
        "reward", [&](auto* self) { return self->Base::Reward(scene); }, scene);
  }
  bool Success(const Scene& scene) override {
    return Call<bool>(
        "success", [&](auto* self) { return self->Base::Success(scene); }, scene);
  }
  std::string instruction() const override {
    return CallMethod<std::string>(nb_trampoline, "instruction", static_cast<const Base*>(this),
                                   [](auto* self) { return self->Base::instruction(); });
  }
  std::vector<std::string> objects() const override {
    return CallMethod<std::vector<std::string>>(nb_trampoline, "objects",
                                                static_cast<const Base*>(this),
                                                [](auto* self) { return self->Base::objects(); });
  }

 private:
  template <class R, class Own>
  R Call(const char* name, Own own, const Scene& scene) {
    return CallMethod<R>(nb_trampoline, name, static_cast<Base*>(this), own, scene);
  }
};

template <class Base>
class PyExpertOf : public Base {
 public:
  NB_TRAMPOLINE(Base);
  void Begin(const Scene& scene, Rng& rng) override {
    CallWithRng<void>(
        nb_trampoline, "begin", static_cast<Base*>(this),
        [&](auto* self) { self->Base::Begin(scene, rng); }, rng, scene);
  }
  Action Act(const Scene& scene, Rng& rng) override {
    return CallWithRng<Action>(
        nb_trampoline, "act", static_cast<Base*>(this),
        [&](auto* self) { return self->Base::Act(scene, rng); }, rng, scene);
  }
  bool done() const override {
    return Ask<bool>("done", [](auto* self) { return self->Base::done(); });
  }
  std::string failure() const override {
    return Ask<std::string>("failure", [](auto* self) { return self->Base::failure(); });
  }
  int phase() const override {
    return Ask<int>("phase", [](auto* self) { return self->Base::phase(); });
  }
  std::vector<std::string> phase_names() const override {
    return Ask<std::vector<std::string>>("phase_names",
                                         [](auto* self) { return self->Base::phase_names(); });
  }

 private:
  template <class R, class Own>
  R Ask(const char* name, Own own) const {
    return CallMethod<R>(nb_trampoline, name, static_cast<const Base*>(this), own);
  }
};

// What sample() of `self` returned; TypeError for anything but an EpisodeStart or a Refusal.
SampleResult ToSampleResult(nb::handle self, nb::handle made);
// Samples without the GIL; Ctrl-C ends it. An EpisodeStart or a Refusal.
nb::object SampleForPython(const SampleRequest& request, PythonRng& rng,
                           const std::function<SampleResult(const SampleRequest&, Rng&)>& sample);

// A request for Python, which may keep it: what asks whether to stop is lent for the time of a
// call, and a copy that is kept says no when it is asked later.
class RequestLoan {
 public:
  explicit RequestLoan(const SampleRequest& request)
      : lent_(std::make_shared<const StopCheck*>(&request.stop)),
        request_{request.scene, request.episode, request.attempt,
                 [lent = lent_] { return *lent && ShouldStop(**lent); }} {}
  ~RequestLoan() { *lent_ = nullptr; }
  RequestLoan(const RequestLoan&) = delete;
  RequestLoan& operator=(const RequestLoan&) = delete;

  const SampleRequest& request() const { return request_; }

 private:
  std::shared_ptr<const StopCheck*> lent_;
  SampleRequest request_;
};

template <class Base>
class PySamplerOf : public Base {
 public:
  NB_TRAMPOLINE(Base);
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
    const RequestLoan asked(request);
    return ToSampleResult(nb_trampoline.base(),
                          nb_trampoline.base().attr(call.key)(asked.request(), loan.rng()));
  }
};

}  // namespace robocell::python
