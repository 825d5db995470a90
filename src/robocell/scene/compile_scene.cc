// CompileScene: turns a SceneSpec into a model.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/assets/model_files.h"
#include "robocell/assets/urdf.h"
#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/add_camera.h"
#include "robocell/scene/add_object.h"
#include "robocell/scene/add_robot.h"
#include "robocell/scene/compile_problem.h"
#include "robocell/scene/compiled_scene.h"
#include "robocell/scene/coupled_groups.h"
#include "robocell/scene/decorations.h"
#include "robocell/scene/entity_order.h"
#include "robocell/scene/inspection/robot_inspection.h"
#include "robocell/scene/label_unnamed.h"
#include "robocell/scene/options.h"
#include "robocell/scene/pool.h"
#include "robocell/scene/robot_base.h"
#include "robocell/scene/saved_scene.h"
#include "robocell/scene/scene_keys.h"
#include "robocell/scene/spec_tree.h"
#include "robocell/scene/validate_keyframes.h"
#include "robocell/scene/validate_model_file.h"
#include "robocell/scene/validate_robot.h"
#include "robocell/spec/validate.h"

namespace robocell::internal {
namespace {

constexpr const char* kBase = "base";  // its place in messages, and the field that names it

using ElementSet = std::set<std::pair<AttachKind, std::string>>;

void CollectNames(const mjSpec* spec, const std::string& prefix, ElementSet& out) {
  for (const AttachKind kind : {AttachKind::kBody, AttachKind::kSite, AttachKind::kFrame}) {
    for (const std::string& name : SpecNames(spec, ElementKindOf(kind)))
      out.emplace(kind, prefix + name);
  }
}

// The engine warns that files saved with an empty prefix may be wrong; MakeClassNamesUnique
// prevents that.
bool IsAboutEmptyPrefix(const std::string& warning) {
  return warning.find("empty prefix may prevent") != std::string::npos;
}

// Returns the guards that compiling applied: `written` is the Jacobian that the spec had before.
std::vector<std::string> GuardsSince(int written, const mjSpec* spec) {
  if (spec->option.jacobian == written) return {};
  return {std::string(kSparseNewton)};
}

}  // namespace

// Builds one CompiledScene; lives for one call.
class SceneCompiler {
 public:
  explicit SceneCompiler(const SceneSpec& spec)
      : context_("scene '" + spec.name + "'"), out_(new CompiledScene) {
    out_->scene_spec_ = spec;
  }

  std::shared_ptr<CompiledScene> Run() {
    RequireValid(spec(), context_);
    out_->sources_ = SourceFiles(spec());
    StartSpec();
    LoadParts();
    AddEntities();
    ValidateResistances(spec_.get(), log_);
    log_.Throw(spec().name);
    CompileModel();
    log_.Throw(spec().name);
    out_->warnings_.insert(out_->warnings_.begin(), log_.warnings().begin(), log_.warnings().end());
    out_->notes_ = log_.notes();
    out_->generation_ = CompiledScene::NextGeneration();
    return out_;
  }

  // Returns the model and the description of the file, instead of those compiled from the spec.
  static std::shared_ptr<CompiledScene> RunSaved(const SceneSpec& spec, const std::string& path) {
    std::shared_ptr<CompiledScene> scene = SceneCompiler(spec).Run();
    const std::string place = "scene '" + spec.name + "' / " + path;
    SpecPtr saved = ParseXmlFile(path, place);
    const int written = saved->option.jacobian;
    ModelPtr model = Compile(saved.get(), nullptr, place, nullptr, GuardOf(spec));
    RequireSavedNames(scene->model(), model.get(), place);
    if (scene->engine_guards_.empty()) scene->engine_guards_ = GuardsSince(written, saved.get());
    scene->spec_owner_ = std::move(saved);
    scene->model_owner_ = std::move(model);
    scene->model_ = scene->model_owner_.get();
    scene->jacobian_ = scene->model_->opt.jacobian;
    scene->home_key_ = mj_name2id(scene->model_, mjOBJ_KEY, "home");
    return scene;
  }

 private:
  const SceneSpec& spec() const { return out_->scene_spec_; }

  // Starts with the base, or an empty world, and the decorations.
  void StartSpec() {
    if (spec().base) {
      log_.Locate(kBase, spec().locations);
      Part base = LoadBase(log_);
      spec_ = std::move(base.spec);
      keys_ = std::move(base.keys);
      WarnReplacedOptions(spec_->option, spec(), log_);
    } else {
      spec_ = MakeSpec();
    }
    mjs_setString(spec_->modelname, spec().name.c_str());
    ValidateDecorations();
    log_.Throw(spec().name);
    AddDecorations(spec(), spec_.get());
  }

  Part LoadBase(CompileLog& log) const {
    const auto file = FindModel(*spec().base, spec().source_dir, kBase, kBase, log);
    log.Throw(spec().name);
    Part base{kBase, kBase, *file, nullptr, {}};
    try {
      if (IsUrdf(*file)) base.spec = ParseModel(*file, kBase, UrdfServos::kNone, log);
      RequireOnlyFiles(*file);
    } catch (const SpecError& error) {
      log.Thrown(kBase, error.what());
    }
    log.Throw(spec().name);
    if (!base.spec) base.spec = ParseBase(*file);
    LabelUnnamed(base.spec.get(), "body");
    base.keys = ReadKeys(base.spec.get(), kBase, kBase, *file);
    DropKeys(base.spec.get());
    MakeAssetPathsAbsolute(base.spec.get(), *file, kBase, kBase, log);
    return base;
  }

  SpecPtr ParseBase(const std::string& file) const {
    const std::string place = context_ + " / " + kBase;
    try {
      return ParseXmlFile(file, place);
    } catch (const SpecError&) {
      const std::string pointers = AdviceAboutPointers(file);
      if (pointers.empty()) throw;
      throw SpecError(place + ": " + pointers);
    }
  }

  void ValidateDecorations() {
    if (spec().add_floor.value_or(false) && FindSpecElement(spec_.get(), mjOBJ_GEOM, "floor")) {
      log_.Problem("", "add_floor: the base has a geom 'floor' already; set add_floor to false");
    }
  }

  void LoadParts() {
    robot_names_ = RobotNames(spec().robots, log_);
    for (size_t i = 0; i < spec().objects.size(); ++i) {
      const SceneObject& object = spec().objects[i];
      const std::string place = "object '" + object.name + "'";
      log_.Locate(place, Located("objects", i));
      Collect(place, [&] { objects_.push_back(LoadObject(object, spec(), log_)); });
    }
    for (size_t i = 0; i < spec().robots.size(); ++i) {
      robots_.emplace_back();  // stays empty if loading throws
      Collect(RobotPlace(robot_names_[i]), [&] { robots_[i] = LoadRobotAt(i); });
    }
    for (size_t i = 0; i < spec().cameras.size(); ++i) {
      log_.Locate("camera '" + spec().cameras[i].name + "'", Located("cameras", i));
    }
    log_.Throw(spec().name);
    for (const auto& robot : robots_) AddRobotFrames(robot->record);
  }

  std::optional<RobotPart> LoadRobotAt(size_t i) {
    const RobotSpec& robot = spec().robots[i];
    const std::string& name = robot_names_[i];
    if (robot.part_of.empty()) return LoadRobot(robot, name, Located("robots", i), spec(), log_);
    const size_t host = HostOf(i);
    if (host == i) {
      const std::vector<std::string> earlier(robot_names_.begin(), robot_names_.begin() + i);
      log_.Problem(RobotPlace(name),
                   "part_of: " + NoSuchName("", "earlier robot", robot.part_of, earlier),
                   "part_of");
    }
    if (host == i || !robots_[host]) return std::nullopt;
    if (robot.prefix != spec().robots[host].prefix) {
      log_.Problem(RobotPlace(name),
                   fmt::format("prefix: must be that of robot '{}', which it is part of: '{}'",
                               robot.part_of, spec().robots[host].prefix),
                   "prefix");
    }
    return LoadRobotIn(*robots_[host], robot, name, Located("robots", i), spec(), log_);
  }

  // Returns the robot whose model contains the i-th robot: the i-th itself, unless it has part_of.
  size_t HostOf(size_t i) const {
    const std::string& host = spec().robots[i].part_of;
    const auto end = robot_names_.begin() + i;
    const auto at = host.empty() ? end : std::find(robot_names_.begin(), end, host);
    return at - robot_names_.begin();
  }
  const Part& PartOf(size_t i) const { return robots_[HostOf(i)]->part; }

  // Returns the locations of the i-th entry of a list of the scene.
  Locations Located(const std::string& list, size_t i) const {
    return spec().locations.Below(fmt::format("{}[{}]", list, i));
  }

  // Turns an exception of a part into one of the problems.
  template <class Function>
  void Collect(const std::string& place, const Function& function) {
    try {
      function();
    } catch (const SpecError& error) {
      log_.Thrown(place, error.what());
    }
  }

  // Elements may be missing because only one of several root bodies of a model is attached.
  void ExplainOtherRoots(const mjModel* model, const RobotRecord& robot, const Part& part) {
    std::vector<std::string> left_out;
    const auto look = [&](mjtObj kind, const NameList& names) {
      for (const std::string& name : names) {
        if (FindId(model, kind, robot.prefix + name) < 0 &&
            FindSpecElement(part.spec.get(), kind, name))
          left_out.push_back(name);
      }
    };
    for (const auto& [name, group] : robot.config.move_groups.entries()) {
      look(mjOBJ_JOINT, group->joints);
      look(mjOBJ_ACTUATOR, group->actuators);
    }
    if (left_out.empty()) return;
    std::vector<std::string> roots;
    for (mjsElement* body : BodyElements(WorldBody(part.spec.get()), mjOBJ_BODY)) {
      if (robot.prefix + SpecName(body) != robot.root_body) roots.push_back(SpecName(body));
    }
    log_.Problem(
        RobotPlace(robot.name),
        fmt::format(
            "{} has {}, but not below the root body: a robot has one, and {} left out. Put "
            "all of them into one body in that file (`robocell init` makes such a file), or "
            "make a robot of each, with its own robot file and root_body",
            part.file, ListNames(left_out),
            ListNames(roots) + (roots.size() == 1 ? " is" : " are")),
        "root_body");
  }

  void AddRobotFrames(const RobotRecord& robot) {
    frames_[robot.name] = {robot.root_body, robot.attachment_site};
  }

  Entity ObjectEntity(size_t i) const {
    Entity entity{
        "object '" + spec().objects[i].name + "'", "objects", spec().objects[i].attach_to, "", {}};
    CollectNames(objects_[i]->part.spec.get(), objects_[i]->prefix, entity.elements);
    return entity;
  }

  Entity RobotEntity(size_t i) const {
    const RobotPart& robot = *robots_[i];
    if (const size_t host = HostOf(i); host != i)  // the host's model contains it
      return {robot.part.place, "robots", RobotBase(robot_names_[host]), robot.record.name, {}};
    Entity entity{robot.part.place, "robots", spec().robots[i].attach_to, robot.record.name, {}};
    CollectNames(robot.part.spec.get(), robot.record.prefix, entity.elements);
    if (const auto base = BaseBodyName(robot.record.base, robot.record.prefix))
      entity.elements.emplace(AttachKind::kBody, *base);
    return entity;
  }

  std::vector<Entity> Entities() const {
    std::vector<Entity> entities;
    for (size_t i = 0; i < objects_.size(); ++i) entities.push_back(ObjectEntity(i));
    for (size_t i = 0; i < robots_.size(); ++i) entities.push_back(RobotEntity(i));
    for (const CameraSpec& camera : spec().cameras) {
      entities.push_back({"camera '" + camera.name + "'", "cameras", camera.attach_to, "", {}});
    }
    return entities;
  }

  void AddEntities() {
    ElementSet base;
    CollectNames(spec_.get(), "", base);
    const std::vector<Entity> entities = Entities();
    for (const size_t i : BuildOrder(entities, base, log_)) {
      Collect(entities[i].place, [&] { AddEntity(i); });
    }
    AdoptAllKeys();
    for (const auto& object : objects_) out_->objects_.push_back(object->record);
    for (const auto& robot : robots_) out_->robots_.push_back(robot->record);
  }

  void AddEntity(size_t i) {
    if (i < objects_.size()) return AddObject(spec().objects[i], *objects_[i]);
    i -= objects_.size();
    if (i < robots_.size()) return AddRobot(spec().robots[i], *robots_[i]);
    AddSceneCamera(spec().cameras[i - robots_.size()]);
  }

  std::optional<Placement> PlaceIt(const AttachTarget& target, const Pose& pose,
                                   const std::string& place) {
    return Place(target, pose, spec_.get(), spec(), frames_, place, log_);
  }

  void AddObject(const SceneObject& object, ObjectPart& loaded) {
    const auto at = PlaceIt(object.attach_to, object.pose(), loaded.part.place);
    if (!at) return;
    AttachObject(object, loaded, *at, log_);
  }

  void AddRobot(const RobotSpec& robot, RobotPart& loaded) {
    if (!robot.part_of.empty()) return;
    const auto at = PlaceIt(robot.attach_to, robot.pose(), loaded.part.place);
    if (!at) return;
    AttachRobot(robot, loaded, *at, log_);
  }

  // Those of robots come first: their numbers stay when objects are added or removed.
  void AdoptAllKeys() {
    for (size_t i = 0; i < robots_.size(); ++i) {
      const RobotSpec& robot = spec().robots[i];
      if (robot.part_of.empty()) AdoptKeys(robots_[i]->part, robot.prefix, robot_names_[i]);
    }
    for (size_t i = 0; i < objects_.size(); ++i)
      AdoptKeys(objects_[i]->part, objects_[i]->prefix, spec().objects[i].name);
  }

  void AdoptKeys(const Part& part, const std::string& prefix, const std::string& name) {
    for (const auto& [own, full] : keys_.Adopt(part.keys, prefix, name)) {
      log_.Note(part.place, fmt::format("its keyframe '{}' is called '{}' in the scene, where "
                                        "another one is called '{}'",
                                        own, full, prefix + own));
    }
  }

  void AddSceneCamera(const CameraSpec& camera) {
    const std::string place = "camera '" + camera.name + "'";
    if (const auto at = PlaceIt(camera.attach_to, camera.pose(), place))
      AddCamera(camera, *at, spec().source_dir, spec().options, place, log_);
  }

  std::vector<RobotLimbs> Limbs() const {
    std::vector<RobotLimbs> limbs;
    for (size_t i = 0; i < robots_.size(); ++i) {
      limbs.push_back({robots_[i]->part.place, robots_[i]->record.prefix,
                       spec().robots[i].control_modes.has_value(), robots_[i]->limbs});
    }
    return limbs;
  }

  void CompileModel() {
    ApplyOptions(spec(), spec_.get(), log_);
    for (const RobotRecord& robot : out_->robots_) FitWeld(spec_.get(), robot);
    const std::vector<RobotLimbs> limbs = Limbs();
    AssignActuatorGroups(spec_.get(), limbs, log_);
    log_.Throw(spec().name);
    const std::vector<mjsKey*> keys = AddSceneKeys(spec_.get(), keys_.PresetNames());
    const int written = spec_->option.jacobian;
    try {
      out_->model_owner_ =
          Compile(spec_.get(), nullptr, context_, &out_->warnings_, GuardOf(spec()));
    } catch (const SpecError& error) {
      log_.Throw(spec().name);  // reports wrong options
      AttributeToPart(error.what());
      throw;
    }
    std::erase_if(out_->warnings_, IsAboutEmptyPrefix);
    mjModel* model = out_->model_ = out_->model_owner_.get();
    out_->engine_guards_ = GuardsSince(written, spec_.get());
    out_->jacobian_ = model->opt.jacobian;
    WarnWrongSolver(spec(), model, log_);
    for (size_t i = 0; i < robots_.size(); ++i) {
      const size_t before = log_.problem_count();
      ValidateRobot(model, out_->robots_[i], log_);
      if (log_.problem_count() > before) ExplainOtherRoots(model, out_->robots_[i], PartOf(i));
    }
    DropFollowers(model, out_->robots_, log_);
    const DataPtr reference = AtReference(model);
    ValidateGroups(model, reference.get(), out_->robots_, log_);
    ValidateKeyframes(model, keys_, out_->robots_, log_);
    ValidateToolPoints(model, reference.get(), out_->robots_, log_);
    FillPool(model);
    FillSceneKeys(model, keys, keys_, out_->robots_, log_);
    out_->home_key_ = mj_name2id(model, mjOBJ_KEY, "home");
    out_->key_owners_ = {{}};
    for (const auto& [name, key] : keys_.presets)
      out_->key_owners_.push_back({key.part, key.own_name});
    SwitchBesides(spec_.get(), model, reference.get(), limbs, log_);
    FillVelocityGains(model, out_->home_key_, limbs);
    for (size_t i = 0; i < robots_.size() && log_.ok(); ++i)
      InspectRobot({model, reference.get(), out_->home_key_, out_->robots_[i], PartOf(i)}, log_);
    FixVisibleRange(spec_.get(), model);
    out_->spec_owner_ = std::move(spec_);
  }

  // Parks the objects that are parked after a reset in the model and its key.
  void FillPool(mjModel* model) {
    for (size_t i = 0; i < objects_.size(); ++i) {
      if (!spec().objects[i].parked) continue;
      ObjectRecord& object = out_->objects_[i];
      object.pool = ReadPoolRecord(model, object, *spec().objects[i].parked);
      model->flg_gravcomp =
          true;  // even if none is parked yet: weights count alike before and after
      if (!object.pool->parked) continue;
      PooledObject(model, object, i).Switch(model, true);
      const FreeJointPos place = ParkingPlace(i);
      keys_.home.qpos[*object.free_joint] = {place.begin(), place.end()};
      for (auto& [name, key] : keys_.presets) {
        key.qpos.erase(*object.free_joint);
        key.joint_sources.erase(*object.free_joint);
      }
    }
  }

  // Duplicates among robots are reported earlier; here the name of the object can be changed.
  void ExplainRepeatedName(const std::string& text, const Part* base) {
    const std::optional<Repeated> repeated = RepeatedName(text);
    if (!repeated) return;
    std::vector<const Part*> owners;
    const auto look = [&](const Part& part, const std::string& prefix) {
      if (HasElement(part, prefix, *repeated)) owners.push_back(&part);
    };
    if (base) look(*base, "");
    for (const auto& robot : robots_) {
      if (robot->part.spec) look(robot->part, robot->record.prefix);
    }
    for (const auto& object : objects_) look(object->part, object->prefix);
    if (owners.size() < 2 || !owners.back()->place.starts_with("object ")) return;
    log_.Problem(owners.back()->place,
                 fmt::format("{0} '{1}' is in {2} already, and the object would bring another "
                             "one; give the object another name",
                             repeated->kind, repeated->name, owners.front()->place),
                 "name");
  }

  // Adds a problem for each file that is a pointer of Git LFS, and throws them: the engine reports
  // what its decoders make of it, if anything.
  void ValidateFiles(const Part* base) {
    const auto validate = [&](const Part& part) {
      std::vector<std::string> files;
      if (!part.file.empty()) files.push_back(part.file);
      for (const Part::Tool& tool : part.tools) files.push_back(tool.file);
      for (const std::string& file : files) {
        const std::string pointers = AdviceAboutPointers(file);
        if (!pointers.empty()) log_.Problem(part.place, pointers, part.field);
      }
    };
    if (base) validate(*base);
    for (const auto& robot : robots_) {
      if (robot->part.spec) validate(robot->part);
    }
    for (const auto& object : objects_) validate(object->part);
    log_.Throw(spec().name);
  }

  // The engine's text about an element of a part becomes a problem of that part's file.
  void AttributeToPart(const std::string& text) {
    // The base as its file describes it, without later attachments.
    std::optional<Part> base;
    if (spec().base) {
      CompileLog loading;  // log of loading it
      base = LoadBase(loading);
    }
    ValidateFiles(base ? &*base : nullptr);
    ExplainRepeatedName(text, base ? &*base : nullptr);
    const auto attribute = [&](const Part& part, const std::string& prefix) {
      if (const auto problem = CompileProblem(text, part, prefix))
        log_.Problem(part.place, *problem, part.field);
    };
    if (base) attribute(*base, "");
    for (const auto& robot : robots_) {
      if (robot->part.spec) attribute(robot->part, robot->record.prefix);
    }
    for (const auto& object : objects_) attribute(object->part, object->prefix);
    log_.Throw(spec().name);
  }

  std::string context_;
  std::shared_ptr<CompiledScene> out_;
  SpecPtr spec_;
  CompileLog log_;
  PartKeys keys_;
  std::vector<std::string> robot_names_;
  std::vector<std::optional<ObjectPart>> objects_;
  std::vector<std::optional<RobotPart>> robots_;
  RobotFrameMap frames_;
};

std::shared_ptr<CompiledScene> CompileSavedScene(const SceneSpec& spec, const std::string& path) {
  return SceneCompiler::RunSaved(spec, path);
}

}  // namespace robocell::internal

namespace robocell {

std::shared_ptr<CompiledScene> CompileScene(const SceneSpec& spec) {
  return internal::SceneCompiler(spec).Run();
}

}  // namespace robocell
