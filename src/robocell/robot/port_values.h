// The target of a controller whose numbers may be in a port of the robot (Controller::UsePort).
#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace robocell {

class PortValues {
 public:
  explicit PortValues(std::vector<double> values) : own_(std::move(values)), at_(own_) {}
  PortValues(const PortValues&) = delete;
  PortValues& operator=(const PortValues&) = delete;

  // Moves the numbers to `port`, which has as many and outlives their use there; with an empty
  // port, back to a place of their own.
  bool MoveTo(std::span<double> port) {
    const std::span<double> to = port.empty() ? std::span<double>(own_) : port;
    if (to.data() != at_.data()) std::copy(at_.begin(), at_.end(), to.begin());
    at_ = to;
    return true;
  }

  std::span<double> get() const { return at_; }
  size_t size() const { return at_.size(); }
  double& operator[](size_t i) const { return at_[i]; }
  auto begin() const { return at_.begin(); }
  auto end() const { return at_.end(); }

 private:
  std::vector<double> own_;
  std::span<double> at_;
};

}  // namespace robocell
