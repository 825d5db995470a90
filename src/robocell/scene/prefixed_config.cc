#include "robocell/scene/prefixed_config.h"

namespace robocell {
namespace {

class Prefixer {
 public:
  explicit Prefixer(const std::string& prefix) : prefix_(prefix) {}

  void Add(std::string& name) const {
    if (!name.empty()) name.insert(0, prefix_);
  }
  void Add(NameList& list) const {
    for (std::string& name : list.names) Add(name);
  }
  void Add(ElementRef& ref) const {
    Add(ref.name);
    Add(ref.body);
  }
  void Add(std::vector<ElementRef>& refs) const {
    for (ElementRef& ref : refs) Add(ref);
  }
  template <class T>
  void Add(std::optional<T>& name) const {
    if (name) Add(*name);
  }
  void Add(MoveGroupConfig& group) const {
    Add(group.joints);
    Add(group.actuators);
    Add(group.root);
    Add(group.leaf);
    Add(group.fingers);
  }
  // The sensor keeps its own name, which is no element's.
  void Add(ForceTorqueSensorSpec& sensor) const {
    sensor.force_sensor = prefix_ + sensor.force();
    sensor.torque_sensor = prefix_ + sensor.torque();
    Add(sensor.frame_site);
  }

 private:
  const std::string& prefix_;
};

}  // namespace

RobotConfig WithPrefix(RobotConfig config, const std::string& prefix) {
  if (prefix.empty()) return config;
  const Prefixer prefixer(prefix);
  prefixer.Add(config.root_body);
  for (const auto& [name, group] : config.move_groups.entries()) prefixer.Add(*group);
  prefixer.Add(config.attachment_site);
  prefixer.Add(config.collision_geoms);
  for (ForceTorqueSensorSpec& sensor : config.ft_sensors) prefixer.Add(sensor);
  return config;
}

}  // namespace robocell
