// Scene: life cycle and stepping. Frames, reset, contacts and files are in their own files.
#include "robocell/scene/scene.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/mujoco/engine_defects.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/owners.h"
#include "robocell/mujoco/step.h"
#include "robocell/scene/options.h"
#include "robocell/scene/placement.h"
#include "robocell/scene/scene_state.h"

namespace robocell {
namespace {

DataHandle MakeOwnData(CompiledScene& compiled) {
  std::shared_ptr<mjData> data(MakeData(compiled.model()).release(), DataDeleter());
  return {data.get(), data};
}

// Notifies the gates that let a step go that it is over, also after an exception.
class StepEnd {
 public:
  explicit StepEnd(std::span<internal::StepGate* const> gates) : gates_(gates) {}
  ~StepEnd() {
    for (internal::StepGate* gate : gates_.first(let_go)) gate->EndStep();
  }
  StepEnd(const StepEnd&) = delete;
  StepEnd& operator=(const StepEnd&) = delete;

  size_t let_go = 0;

 private:
  std::span<internal::StepGate* const> gates_;
};

// Cameras and lights follow their places in the model, also those on bodies that sleep or never move,
// which the engine leaves out once something sleeps. Bodies stay as they are.
void UpdateCamerasAndLights(const mjModel* model, mjData* data) {
  if (!(model->opt.enableflags & mjENBL_SLEEP)) return mj_camlight(model, data);
  mjModel view = *model;  // shallow
  view.opt.enableflags &= ~mjENBL_SLEEP;
  mj_camlight(&view, data);
}

}  // namespace

Scene Scene::Build(const SceneSpec& spec, const DataFactory& factory) {
  return FromCompiled(CompileScene(spec), factory);
}

Scene Scene::FromCompiled(std::shared_ptr<CompiledScene> compiled, const DataFactory& factory) {
  auto state = std::make_shared<State>(compiled->spec().name);
  state->claim = compiled->Claim();
  state->factory = factory ? factory : MakeOwnData;
  state->data = state->factory(*compiled);
  state->compiled = std::move(compiled);
  state->Show();
  state->BindPool();
  auto kept = std::make_shared<Kept>();
  state->kept = kept;
  Scene scene(std::move(state), std::move(kept));
  scene.Reset();
  return scene;
}

void Scene::State::Show() {
  now = {compiled->model(), data.data, compiled->generation()};
  solver = now.model->opt.solver;
}

void Scene::State::WarnOfSolver() {
  solver = now.model->opt.solver;
  if (internal::GuardOf(compiled->spec()) == JacobianGuard::kOff || !NeedsJacobianGuard(now.model))
    return;
  LogWarn(fmt::format(
      "{}: its solver became Newton after the scene was compiled, with a sparse Jacobian of {} "
      "degrees of freedom: MuJoCo {} can then return wrong accelerations (`robocell doctor` lists "
      "known defects). Write `options: {{solver: newton}}` into the scene, or set the model's "
      "opt.jacobian to dense (0) too",
      context, now.model->nv, mj_versionString()));
}

Scene::Weak::Weak(const Scene& scene)
    : state_(scene.state_),
      kept_(scene.kept_ ? std::weak_ptr<Kept>(scene.kept_) : scene.state_->kept) {}

Scene::Scene(std::shared_ptr<State> state, std::shared_ptr<Kept> kept)
    : state_(std::move(state)), now_(&state_->now), kept_(std::move(kept)) {}

void Scene::ThrowClosed() const { throw ClosedError(state_->context + " is closed"); }

Scene::State& Scene::open() const {
  if (closed()) ThrowClosed();
  return *state_;
}

double Scene::time() const { return open().data.data->time; }

double Scene::timestep() const { return open().model()->opt.timestep; }

StepResult Scene::StepN(int n) {
  State& s = open();
  if (n < 0) {
    throw ArgumentError("scene '" + name() + "': cannot step " + std::to_string(n) +
                        " times; time only goes forward, reset() starts again");
  }
  s.LookAtSolver();
  const auto gate = s.gate.lock();
  if (gate || !s.links.empty()) return s.StepThrough(gate.get(), n);
  return robocell::Step(s.now.model, s.now.data, n, s.context);
}

StepResult Scene::State::StepThrough(internal::StepGate* gate_now, int n) {
  std::vector<std::shared_ptr<internal::StepGate>> linked;  // kept until all steps are made
  for (const auto& link : links) {
    if (auto here = link.lock()) linked.push_back(std::move(here));
  }
  if (linked.size() < links.size())
    std::erase_if(links, [](const auto& link) { return link.expired(); });
  std::vector<internal::StepGate*> asked;
  if (gate_now) asked.push_back(gate_now);
  for (const auto& link : linked) asked.push_back(link.get());
  StepResult result;
  result.time = now.data->time;
  int steps = 0;
  while (steps < n && now.data) {  // a gate may close the scene
    {
      StepEnd end(asked);
      internal::StepGate::Answer answer = internal::StepGate::kGo;
      for (internal::StepGate* each : asked) {
        answer = each->BeforeStep();
        if (answer == internal::StepGate::kStop) result.message = each->StopReason();
        if (answer != internal::StepGate::kGo || !now.data) break;
        ++end.let_go;
      }
      if (answer == internal::StepGate::kStop) result.status = StepResult::kStopped;
      if (answer != internal::StepGate::kGo || !now.data) break;
      result = robocell::Step(now.model, now.data, 1, context);
    }
    ++steps;
    if (!result.ok()) break;
    for (auto each = asked.rbegin(); each != asked.rend() && now.data; ++each) (*each)->AfterStep();
  }
  result.steps = steps;
  return result;
}

void Scene::Forward() {
  State& s = open();
  s.LookAtSolver();
  robocell::Forward(s.model(), s.data.data, s.context);
  if (s.model()->opt.enableflags & mjENBL_SLEEP)
    internal::Guarded(s.context, s.data.data,
                      [&] { UpdateCamerasAndLights(s.model(), s.data.data); });
  s.poses_at = s.data.data->time;
  for (size_t i = 0; i < s.observers.size(); ++i) {  // a copy would allocate
    if (const auto observer = s.observers[i].observer.lock()) observer->OnForward();
  }
}

void Scene::SyncPoses() const {
  State& s = open();
  const mjModel* model = s.now.model;
  mjData* data = s.now.data;
  if (data->time == s.poses_at) return;
  internal::Guarded(s.context, data, [&] {
    mj_kinematics(model, data);
    mj_comPos(model, data);
    UpdateCamerasAndLights(model, data);
  });
  s.poses_at = data->time;
}

void Scene::PosesChanged() { open().poses_at = -1; }

Pose Scene::root_frame_to_world() const {
  return internal::RootFrameToWorld(open().compiled->spec());
}

Pose Scene::shared_base_frame_to_world() const {
  return internal::SharedBaseFrameToWorld(open().compiled->spec());
}

const std::string& Scene::name() const { return state_->name; }

SceneUse& Scene::use() const { return state_->use; }

const SceneSpec& Scene::spec() const { return open().compiled->spec(); }

const std::shared_ptr<CompiledScene>& Scene::compiled() const { return open().compiled; }

mjModel* Scene::mutable_model() { return open().compiled->mutable_model(); }

const std::shared_ptr<void>& Scene::data_keeper() const { return open().data.keeper; }

void Scene::AddObserver(std::weak_ptr<SceneObserver> observer, const std::string& key) {
  auto& observers = open().observers;
  std::erase_if(observers, [](const auto& watch) { return watch.observer.expired(); });
  std::erase_if(open().links, [](const auto& link) { return link.expired(); });
  const std::shared_ptr<SceneObserver> added = observer.lock();
  if (const auto link = std::dynamic_pointer_cast<internal::StepLink>(added)) {
    open().links.push_back(link);
  } else if (const auto gate = std::dynamic_pointer_cast<internal::StepGate>(added)) {
    open().gate = gate;
  }
  observers.push_back({key, std::move(observer)});
}

void Scene::KeepObserver(std::shared_ptr<SceneObserver> observer, const std::string& key) {
  const std::shared_ptr<Kept> kept = kept_ ? kept_ : state_->kept.lock();
  if (!kept) {
    throw Error(open().context +
                ": only inner handles are left, and nothing is kept through these alone");
  }
  AddObserver(observer, key);
  kept->push_back(std::move(observer));
}

Scene Scene::inner() const { return Scene(state_, nullptr); }

Scene Scene::outer() const { return Scene(state_, kept_ ? kept_ : state_->kept.lock()); }

std::optional<Scene> Scene::Weak::lock() const {
  auto kept = kept_.lock();
  if (!kept) return std::nullopt;
  return Scene(state_.lock(), std::move(kept));
}

const std::vector<std::shared_ptr<SceneObserver>>& Scene::kept_observers() const {
  static const Kept none;
  return kept_ ? *kept_ : none;
}

void Scene::ForgetKeptObservers() {
  if (!kept_) return;
  const Kept forgotten = std::move(*kept_);  // destroyed after it can no longer be found there
  kept_->clear();
}

std::shared_ptr<SceneObserver> Scene::FindObserver(const std::string& key) const {
  for (const auto& watch : open().observers) {
    if (watch.key != key || key.empty()) continue;
    if (auto observer = watch.observer.lock()) return observer;
  }
  return nullptr;
}

std::vector<std::shared_ptr<SceneObserver>> Scene::FindObservers(std::string_view key_begin) const {
  std::vector<std::shared_ptr<SceneObserver>> found;
  for (const auto& watch : open().observers) {
    if (!watch.key.starts_with(key_begin)) continue;
    if (auto observer = watch.observer.lock()) found.push_back(std::move(observer));
  }
  return found;
}

void Scene::Close() {
  if (state_->closed) return;
  const auto observers = std::move(state_->observers);
  for (const auto& watch : observers) {
    if (const auto observer = watch.observer.lock()) observer->OnClose();
  }
  state_->closed = true;
  state_->now = {};
  state_->hooks.clear();
  ForgetKeptObservers();
  state_->data = {};
  state_->claim.reset();
  state_->compiled.reset();
}

}  // namespace robocell
