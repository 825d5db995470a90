// The Python class Rng: a stream of its own, or one that C++ lends to a Python function during a
// call. A lent stream that Python keeps raises an error when it is used later; it never dangles.
#pragma once

#include <memory>
#include <optional>

#include "bindings.h"
#include "robocell/base/rng.h"

namespace robocell::python {

class PythonRng {
 public:
  explicit PythonRng(Rng own) : own_(own) {}

  // Throws Error once the call that it was lent for is over.
  Rng& get();

 private:
  friend class RngLoan;
  explicit PythonRng(std::shared_ptr<Rng*> lent) : lent_(std::move(lent)) {}

  std::optional<Rng> own_;
  std::shared_ptr<Rng*> lent_;
};

// Lends a stream during its lifetime. Needs the GIL.
class RngLoan {
 public:
  explicit RngLoan(Rng& rng) : lent_(std::make_shared<Rng*>(&rng)) {}
  ~RngLoan() { *lent_ = nullptr; }
  RngLoan(const RngLoan&) = delete;
  RngLoan& operator=(const RngLoan&) = delete;

  // Returns the object that draws from the stream itself, for Python.
  PythonRng rng() const { return PythonRng(lent_); }

 private:
  std::shared_ptr<Rng*> lent_;
};

}  // namespace robocell::python
