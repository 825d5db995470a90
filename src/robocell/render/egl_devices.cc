#include "robocell/render/egl_devices.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <map>
#include <numeric>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell {
namespace {

using Indices = std::vector<size_t>;
using CudaMap = std::map<int, size_t>;  // CUDA number: index of the device

std::string Variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

std::optional<int> WholeNumber(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())))
    text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())))
    text.remove_suffix(1);
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

// Returns an empty list if there is none, or for anything but numbers (CUDA takes UUIDs too), which
// say nothing here.
std::vector<int> CudaNumbers(std::string_view list) {
  std::vector<int> numbers;
  while (!list.empty()) {
    const std::string_view item = list.substr(0, list.find(','));
    list.remove_prefix(std::min(list.size(), item.size() + 1));
    if (item.find_first_not_of(" \t") == std::string_view::npos) continue;
    const std::optional<int> number = WholeNumber(item);
    if (!number || *number < 0) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

// Returns an empty map if no device reports its number, or two report the same.
CudaMap MapOfCuda(std::span<const EglDevice> devices) {
  CudaMap map;
  for (size_t i = 0; i < devices.size(); ++i) {
    if (devices[i].cuda && !map.emplace(*devices[i].cuda, i).second) return {};
  }
  return map;
}

// Returns the devices that CUDA_VISIBLE_DEVICES lists, in its order. A container may count them
// from 0 although the list has the numbers of the machine outside.
Indices VisibleDevices(const CudaMap& map, const std::vector<int>& visible) {
  if (map.empty() || visible.empty()) return {};
  Indices devices;
  for (const int number : visible) {
    if (map.contains(number)) devices.push_back(map.at(number));
  }
  if (devices.size() == visible.size()) return devices;
  devices.clear();
  for (int number = 0; number < static_cast<int>(visible.size()); ++number) {
    if (!map.contains(number)) return {};
    devices.push_back(map.at(number));
  }
  return devices;
}

Indices InCudaOrder(std::span<const EglDevice> devices, const CudaMap& map,
                    const Indices& visible) {
  Indices order = visible;
  if (order.empty()) {
    for (const auto& [number, index] : map) order.push_back(index);
  }
  const size_t first = order.size();
  for (size_t i = 0; i < devices.size(); ++i) {
    const auto end = order.begin() + static_cast<std::ptrdiff_t>(first);
    if (std::find(order.begin(), end, i) == end) order.push_back(i);
  }
  return order;
}

std::optional<size_t> MujocoChoice(int number, const Indices& order, const CudaMap& map,
                                   const Indices& visible, const std::vector<int>& numbers) {
  if (number < 0) return std::nullopt;
  if (number < static_cast<int>(visible.size())) return visible[number];
  const auto physical = std::find(numbers.begin(), numbers.end(), number);
  if (!visible.empty() && physical != numbers.end()) return visible[physical - numbers.begin()];
  if (map.contains(number)) return map.at(number);
  if (number >= static_cast<int>(order.size())) return std::nullopt;
  return order[number];
}

// Puts the device first whose turn it is, among those that workers take in turn: the visible ones,
// otherwise the cards of the first one's kind.
void TakeTurn(std::span<const EglDevice> devices, const Indices& visible, int turn,
              Indices* order) {
  const auto takes_part = [&](size_t i) {
    const EglDevice &device = devices[i], &first = devices[order->front()];
    if (device.software) return false;
    if (!visible.empty()) return std::ranges::find(visible, i) != visible.end();
    return device.vendor == first.vendor && device.cuda.has_value() == first.cuda.has_value();
  };
  const auto end = std::ranges::find_if_not(*order, takes_part);
  if (const auto cards = end - order->begin(); cards > 1)
    std::rotate(order->begin(), order->begin() + turn % cards, end);
}

[[noreturn]] void ThrowNoDevice(const char* variable, const std::string& value,
                                std::span<const EglDevice> devices) {
  std::vector<std::string> names;
  for (size_t i = 0; i < devices.size(); ++i) names.push_back(DescribeEglDevice(devices, i));
  throw ArgumentError(
      fmt::format("{}={} chooses none of the {} EGL devices of this machine: {}. "
                  "Give one of their numbers, or unset the variable",
                  variable, value, devices.size(), ListNames(names)));
}

}  // namespace

EglDeviceChoice EglDeviceChoice::FromEnvironment() {
  return {.robocell_device = Variable("ROBOCELL_EGL_DEVICE"),
          .mujoco_device = Variable("MUJOCO_EGL_DEVICE_ID"),
          .cuda_visible = Variable("CUDA_VISIBLE_DEVICES"),
          .turn = std::max(0, WholeNumber(Variable("ROBOCELL_EGL_TURN")).value_or(0))};
}

std::string DescribeEglDevice(std::span<const EglDevice> devices, size_t index) {
  const EglDevice& device = devices[index];
  std::string what = device.vendor;
  if (device.software) what += what.empty() ? "software" : ", software";
  return fmt::format("device {}{}", index, what.empty() ? "" : " (" + what + ")");
}

std::vector<size_t> OrderEglDevices(std::span<const EglDevice> devices,
                                    const EglDeviceChoice& choice) {
  if (!choice.robocell_device.empty()) {
    const std::optional<int> index = WholeNumber(choice.robocell_device);
    if (!index || *index < 0 || *index >= static_cast<int>(devices.size()))
      ThrowNoDevice("ROBOCELL_EGL_DEVICE", choice.robocell_device, devices);
    return {static_cast<size_t>(*index)};
  }
  const std::vector<int> numbers = CudaNumbers(choice.cuda_visible);
  const CudaMap map = MapOfCuda(devices);
  const Indices visible = VisibleDevices(map, numbers);
  Indices order = InCudaOrder(devices, map, visible);
  if (!choice.mujoco_device.empty()) {
    const std::optional<int> number = WholeNumber(choice.mujoco_device);
    const auto index = number ? MujocoChoice(*number, order, map, visible, numbers) : std::nullopt;
    if (!index) ThrowNoDevice("MUJOCO_EGL_DEVICE_ID", choice.mujoco_device, devices);
    return {*index};
  }
  std::stable_partition(order.begin(), order.end(), [&](size_t i) { return !devices[i].software; });
  TakeTurn(devices, visible, choice.turn, &order);
  return order;
}

int TurnAmongCards(const EglDeviceChoice& choice, size_t cards) {
  if (!choice.robocell_device.empty() || !choice.mujoco_device.empty()) return 0;
  const std::vector<int> visible = CudaNumbers(choice.cuda_visible);
  const size_t count = std::max<size_t>(1, visible.empty() ? cards : visible.size());
  return choice.turn % static_cast<int>(count);
}

bool IsSoftwareRenderer(std::string_view renderer) {
  std::string name(renderer);
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  for (const char* part : {"llvmpipe", "softpipe", "swrast", "software", "swr "}) {
    if (name.find(part) != std::string::npos) return true;
  }
  return false;
}

}  // namespace robocell
