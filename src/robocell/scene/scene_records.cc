#include "robocell/scene/scene_records.h"

#include <optional>
#include <string>

#include "robocell/scene/add_robot.h"

namespace robocell {
namespace {

using nlohmann::json;

json Or(const std::optional<std::string>& text) { return text ? json(*text) : json(nullptr); }

std::optional<std::string> Optional(const json& value) {
  if (value.is_null()) return std::nullopt;
  return value.get<std::string>();
}

}  // namespace

json ToJson(const std::vector<RobotRecord>& robots) {
  json all = json::array();
  for (const RobotRecord& robot : robots) {
    all.push_back({{"name", robot.name},
                   {"base_kind", static_cast<int>(robot.base.kind)},
                   {"top_body", robot.top_body},
                   {"root_body", robot.root_body},
                   {"mocap_body", Or(robot.mocap_body)},
                   {"pedestal_height", robot.pedestal_height},
                   {"attachment_site", Or(robot.attachment_site)},
                   {"tcp_site", Or(robot.tcp_site)},
                   {"base_body", robot.base_body}});
  }
  return all;
}

json ToJson(const std::vector<ObjectRecord>& objects) {
  json all = json::array();
  for (const ObjectRecord& object : objects) {
    all.push_back({{"name", object.name},
                   {"root_body", object.root_body},
                   {"free_joint", Or(object.free_joint)}});
    if (!object.pool) continue;
    all.back()["pool"] = {{"parked", object.pool->parked},
                          {"contype", object.pool->contype},
                          {"conaffinity", object.pool->conaffinity},
                          {"gravcomp", object.pool->gravcomp}};
  }
  return all;
}

std::vector<RobotRecord> RobotsFromJson(const SceneSpec& spec, const json& robots) {
  std::vector<RobotRecord> records;
  for (size_t i = 0; i < robots.size(); ++i) {
    const json& said = robots[i];
    RobotRecord record = RecordOf(spec.robots[i], said.at("name"));
    record.base.kind = static_cast<BaseKind>(said.at("base_kind").get<int>());
    record.top_body = said.at("top_body");
    record.root_body = said.at("root_body");
    record.mocap_body = Optional(said.at("mocap_body"));
    record.pedestal_height = said.at("pedestal_height");
    record.attachment_site = Optional(said.at("attachment_site"));
    record.tcp_site = Optional(said.at("tcp_site"));
    record.base_body = said.at("base_body");
    records.push_back(std::move(record));
  }
  return records;
}

std::vector<ObjectRecord> ObjectsFromJson(const json& objects) {
  std::vector<ObjectRecord> records;
  for (const json& said : objects) {
    records.push_back({.name = said.at("name"),
                       .root_body = said.at("root_body"),
                       .free_joint = Optional(said.at("free_joint"))});
    if (!said.contains("pool")) continue;
    const json& pool = said.at("pool");
    records.back().pool = PoolRecord{.parked = pool.at("parked"),
                                     .contype = pool.at("contype"),
                                     .conaffinity = pool.at("conaffinity"),
                                     .gravcomp = pool.at("gravcomp")};
  }
  return records;
}

}  // namespace robocell
