// Real arms (hardware/), under Python's robocell.hardware. Ports may be written in Python.
#include <nanobind/nanobind.h>
#include <nanobind/trampoline.h>

#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "handles.h"
#include "python_owner.h"
#include "raised.h"
#include "returned.h"
#include "scene_cycles.h"
#include "signals.h"
#include "robocell/hardware/arm_link.h"
#include "robocell/hardware/arm_port.h"
#include "robocell/hardware/safety_gate.h"
#include "robocell/hardware/simulated_arm.h"
#include "robocell/hardware/udp_arm.h"
#include "robocell/hardware/udp_arm_server.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

using Unlocked = nb::call_guard<nb::gil_scoped_release>;
constexpr const char* kArraySig = "numpy.typing.NDArray[numpy.float64]";

std::optional<double> OpeningOf(double opening) {
  return std::isnan(opening) ? std::nullopt : std::optional(opening);
}

std::vector<double> RowOr(nb::handle values, const char* name, size_t otherwise) {
  return values.is_none() ? std::vector<double>(otherwise) : ToRow(values, name);
}

// A port whose methods are written in Python; each call takes the GIL.
class PyArmPort final : public ArmPort {
 public:
  NB_TRAMPOLINE(ArmPort, 8);

  std::string name() const override { return Attribute<std::string>("name"); }
  std::vector<std::string> joint_names() const override {
    return Attribute<std::vector<std::string>>("joint_names");
  }
  ArmLimits limits() const override { return Attribute<ArmLimits>("limits"); }
  bool Read(ArmMeasurement& out) override {
    const nb::gil_scoped_acquire gil;
    const nb::object read = Call("read");
    if (read.is_none()) return false;
    out = Returned<ArmMeasurement>(self(), "read", read);
    return true;
  }
  void Send(const ArmCommand& command) override {
    const nb::gil_scoped_acquire gil;
    Call("send", command);
  }
  void Hold() override {
    const nb::gil_scoped_acquire gil;
    Call("hold");
  }
  bool takes_forces() const override {
    const nb::gil_scoped_acquire gil;
    return nb::hasattr(self(), "takes_forces") && Attribute<bool>("takes_forces");
  }
  double now() const override {
    const nb::gil_scoped_acquire gil;
    if (!nb::hasattr(self(), "now")) return ArmPort::now();
    return Returned<double>(self(), "now", Call("now"));
  }
  void WaitUntil(double time) override {
    {
      const nb::gil_scoped_acquire gil;
      if (nb::hasattr(self(), "wait_until")) {
        Call("wait_until", time);
        return;
      }
    }
    ArmPort::WaitUntil(time);
  }

 private:
  nb::handle self() const { return nb_trampoline.base(); }
  template <class... Args>
  nb::object Call(const char* method, const Args&... args) const {
    if (!nb::hasattr(self(), method)) ThrowMissing(self(), method);
    return CallPython(self(), method, [&] { return nb::object(self().attr(method)(args...)); });
  }
  // An attribute or a property.
  template <class R>
  R Attribute(const char* attribute) const {
    const nb::gil_scoped_acquire gil;
    if (!nb::hasattr(self(), attribute)) ThrowMissing(self(), attribute);
    return Returned<R>(self(), attribute, nb::object(self().attr(attribute)));
  }
};

// Returns the port of an object. Throws for a driver that lacks a method: without hold(), say, an
// arm would stop nowhere.
std::shared_ptr<ArmPort> CheckedPort(nb::handle port) {
  for (const char* method : {"read", "send", "hold"})
    if (!nb::hasattr(port, method)) ThrowMissing(port, method);
  return Shared<ArmPort>(nb::borrow(port));
}

// A link and a server keep the Python object of their port (python_owner.h), which may refer to
// them. A cycle ends when the collector clears that object.
int VisitPort(const ArmPort& port, visitproc visit, void* arg) {
  const nb::object object = nb::find(port);
  Py_VISIT(object.ptr());
  return 0;
}
int VisitLink(const ArmLink& link, visitproc visit, void* arg) {
  return VisitPort(link.port(), visit, arg);
}
int VisitServer(const UdpArmServer& server, visitproc visit, void* arg) {
  return VisitPort(server.arm(), visit, arg);
}

// A property that is a list of numbers, one per joint.
template <class T>
void DefRow(nb::class_<T>& of, const char* name, std::vector<double> T::*values, const char* doc) {
  of.def_prop_rw(
      name, [values](const T& self) { return NewArray(self.*values); },
      [values, name](T& self, nb::handle row) { self.*values = ToRow(row, name); },
      nb::for_getter(nb::sig(("def " + std::string(name) + "(self) -> " + kArraySig).c_str())),
      doc);
}

void BindValues(nb::module_& m) {
  nb::class_<ArmLimits> limits(
      m, "ArmLimits",
      "Limits of an arm, one value per joint: positions (rad or m), velocities, accelerations and "
      "forces (N m or N). An empty list sets no limit of its own."
      "\n\nExamples:\n"
      "    >>> rc.hardware.ArmLimits(velocity=[0.5] * 7).velocity.shape\n"
      "    (7,)");
  limits.def(
      "__init__",
      [](ArmLimits* self, nb::handle lower, nb::handle upper, nb::handle velocity,
         nb::handle acceleration, nb::handle force) {
        new (self) ArmLimits{RowOr(lower, "lower", 0), RowOr(upper, "upper", 0),
                             RowOr(velocity, "velocity", 0), RowOr(acceleration, "acceleration", 0),
                             RowOr(force, "force", 0)};
      },
      nb::kw_only(), "lower"_a = nb::none(), "upper"_a = nb::none(), "velocity"_a = nb::none(),
      "acceleration"_a = nb::none(), "force"_a = nb::none());
  DefRow(limits, "lower", &ArmLimits::lower, "Lowest positions (n,).");
  DefRow(limits, "upper", &ArmLimits::upper, "Highest positions (n,).");
  DefRow(limits, "velocity", &ArmLimits::velocity, "Largest velocities (n,).");
  DefRow(limits, "acceleration", &ArmLimits::acceleration, "Largest accelerations (n,).");
  DefRow(limits, "force", &ArmLimits::force,
         "Largest measured forces (n,); beyond them the arm stops.");

  nb::class_<ArmMeasurement> measurement(
      m, "ArmMeasurement",
      "What an arm measured at a time of its own clock, seconds. `vel` and `force` are zero if it "
      "does not measure them; `opening` of its gripper is 0 (closed) to 1, None without one."
      "\n\nExamples:\n"
      "    >>> rc.hardware.ArmMeasurement(time=1.5, pos=[0.1, 0.2]).vel\n"
      "    array([0., 0.])");
  measurement
      .def(
          "__init__",
          [](ArmMeasurement* self, double time, nb::handle pos, nb::handle vel, nb::handle force,
             std::optional<double> opening) {
            const std::vector<double> at = ToRow(pos, "pos");
            new (self)
                ArmMeasurement{time, at, RowOr(vel, "vel", at.size()),
                               RowOr(force, "force", at.size()), opening.value_or(kNoOpening)};
          },
          "time"_a, "pos"_a, "vel"_a = nb::none(), "force"_a = nb::none(),
          "opening"_a.none() = nb::none())
      .def_ro("time", &ArmMeasurement::time, "Seconds of the arm's clock.")
      .def_prop_ro(
          "opening", [](const ArmMeasurement& a) { return OpeningOf(a.opening); },
          "Opening of the gripper, 0 (closed) to 1; None without one.");
  DefRow(measurement, "pos", &ArmMeasurement::pos, "Joint positions (n,), rad or m.");
  DefRow(measurement, "vel", &ArmMeasurement::vel, "Joint velocities (n,), rad/s or m/s.");
  DefRow(measurement, "force", &ArmMeasurement::force, "Joint torques or forces (n,), N m or N.");

  nb::class_<ArmCommand> command(
      m, "ArmCommand",
      "What is sent to an arm in one tick: within its limits, one tick after the last.");
  command.def_prop_ro(
      "opening", [](const ArmCommand& c) { return OpeningOf(c.opening); },
      "Opening of the gripper, 0 (closed) to 1; None to leave it as it is.");
  DefRow(command, "pos", &ArmCommand::pos, "Joint positions (n,), rad or m.");
  DefRow(command, "vel", &ArmCommand::vel, "Joint velocities (n,), rad/s or m/s.");
  DefRow(
      command, "force", &ArmCommand::force,
      "All joint torques or forces (n,), with those against gravity, N m or N; empty: the arm goes "
      "to `pos`.");
}

void BindOptions(nb::module_& m) {
  nb::class_<SafetyOptions>(
      m, "SafetyOptions",
      "How an arm is guarded; docs/hardware.md describes the stops.\n\n"
      "Args:\n"
      "    limits: Narrower limits than the arm's own.\n"
      "    speed: Share of the velocity limits that is used, above 0 to 1.\n"
      "    watchdog: Longest time without a good measurement, s.\n"
      "    slow_start: Time until full speed, s; it begins at a tenth.\n"
      "    dead_man: Longest time between two calls of `ArmLink.renew`, s; 0: no switch.\n"
      "    max_lead: Largest distance of the command from the measured joints, rad or m.\n"
      "    dry_run: Compute everything, send nothing."
      "\n\nExamples:\n"
      "    >>> rc.hardware.SafetyOptions(speed=0.2, dead_man=0.3).watchdog\n"
      "    0.2")
      .def(
          "__init__",
          [](SafetyOptions* self, const ArmLimits* limits, double speed, double watchdog,
             double slow_start, double dead_man, double max_lead, bool dry_run) {
            new (self) SafetyOptions{.limits = limits ? *limits : ArmLimits{},
                                     .speed = speed,
                                     .watchdog = watchdog,
                                     .slow_start = slow_start,
                                     .dead_man = dead_man,
                                     .max_lead = max_lead,
                                     .dry_run = dry_run};
          },
          nb::kw_only(), "limits"_a.none() = nb::none(), "speed"_a = 1.0, "watchdog"_a = 0.2,
          "slow_start"_a = 2.0, "dead_man"_a = 0.0, "max_lead"_a = 0.2, "dry_run"_a = false)
      .def_rw("limits", &SafetyOptions::limits, "Narrower limits than the arm's own.")
      .def_rw("speed", &SafetyOptions::speed, "Share of the velocity limits that is used.")
      .def_rw("watchdog", &SafetyOptions::watchdog, "Longest time without a good measurement, s.")
      .def_rw("slow_start", &SafetyOptions::slow_start, "Time until full speed, s.")
      .def_rw("dead_man", &SafetyOptions::dead_man,
              "Longest time between two calls of `renew`, s; 0: no switch.")
      .def_rw("max_lead", &SafetyOptions::max_lead,
              "Largest distance of the command from the measured joints, rad or m.")
      .def_rw("dry_run", &SafetyOptions::dry_run, "Compute everything, send nothing.");
  nb::class_<SafetyCounts>(m, "SafetyCounts", "What passed the guard of an arm so far.")
      .def_ro("accepted", &SafetyCounts::accepted, "Measurements.")
      .def_ro("stale", &SafetyCounts::stale,
              "Measurements that repeated, went back in time, or came too late.")
      .def_ro("damaged", &SafetyCounts::damaged,
              "Measurements with wrong sizes, values that are not finite, or jumps.")
      .def_ro("sent", &SafetyCounts::sent, "Commands.")
      .def_ro("limited", &SafetyCounts::limited, "Ticks in which a limit changed the command.");
  nb::class_<LinkFaults>(
      m, "LinkFaults",
      "Faults of a network, for trying programs: latency (s), and the shares of packets that are "
      "lost, damaged and repeated."
      "\n\nExamples:\n"
      "    >>> rc.hardware.LinkFaults(latency=0.02, drop=0.1).drop\n"
      "    0.1")
      .def(
          "__init__",
          [](LinkFaults* self, double latency, double drop, double damage, double repeat,
             uint64_t seed) {
            new (self) LinkFaults{latency, drop, damage, repeat, seed};
          },
          nb::kw_only(), "latency"_a = 0.0, "drop"_a = 0.0, "damage"_a = 0.0, "repeat"_a = 0.0,
          "seed"_a = 0)
      .def_rw("latency", &LinkFaults::latency, "Of every packet, in both directions, s.")
      .def_rw("drop", &LinkFaults::drop, "Share of the packets that are lost.")
      .def_rw("damage", &LinkFaults::damage, "Share in which a byte changes.")
      .def_rw("repeat", &LinkFaults::repeat, "Share that arrives twice, late.");
}

// Properties that ports of C++ have, and that those written in Python define.
template <class T>
void DefPort(nb::class_<T, ArmPort>& port) {
  port.def_prop_ro("name", &T::name, "Name for messages.")
      .def_prop_ro("joint_names", &T::joint_names, "Names of the joints, in order.")
      .def_prop_ro("limits", &T::limits, "Limits of the joints.")
      .def(
          "read",
          [](T& self) {
            ArmMeasurement measured;
            const bool found = self.Read(measured);
            return found ? std::optional(measured) : std::nullopt;
          },
          Unlocked(), "Returns the newest measurement; None if there is none since the last call.")
      .def(
          "send",
          [](T& self, nb::handle pos, nb::handle vel, std::optional<double> opening,
             nb::handle force) {
            ArmCommand command{.pos = ToRow(pos, "pos"), .opening = opening.value_or(kNoOpening)};
            command.vel = RowOr(vel, "vel", command.pos.size());
            command.force = RowOr(force, "force", 0);
            const nb::gil_scoped_release unlocked;
            self.Send(command);
          },
          "pos"_a, "vel"_a = nb::none(), "opening"_a.none() = nb::none(), "force"_a = nb::none(),
          "Commands the joints, past all guards. Programs use an `ArmLink`.")
      .def_prop_ro("takes_forces", &T::takes_forces, "True if it obeys commands of forces.")
      .def("hold", &T::Hold, Unlocked(), "Makes the arm hold where it is.")
      .def("now", &T::now, Unlocked(), "Returns the seconds of the port's clock.")
      .def("wait_until", &T::WaitUntil, "time"_a, Unlocked(),
           "Returns when the port's clock has reached a time.");
}

void BindPorts(nb::module_& m) {
  nb::class_<ArmPort, PyArmPort>(
      m, "ArmPort",
      "The interface that drivers of real arms implement, below `Robot`.\n\n"
      "To write a driver, subclass it, call `super().__init__()`, and define\n\n"
      "- `name` (str), `joint_names` (list of str) and `limits` (ArmLimits): attributes or "
      "properties;\n"
      "- `read() -> ArmMeasurement | None`: the newest measurement, None without a new one;\n"
      "- `send(command)`: commands the joints of an ArmCommand;\n"
      "- `hold()`: makes the arm hold where it is;\n"
      "- optionally `takes_forces = True`: `send` obeys `command.force` unless it is empty;\n"
      "- optionally `now()` and `wait_until(time)`: another clock than the computer's.\n\n"
      "None of them waits, except wait_until: a slow bus gets a thread of its own. What they raise "
      "stops the arm.")
      .def(nb::init<>());

  nb::class_<SimulatedArm, ArmPort> simulated(
      m, "SimulatedArm",
      "A robot of a scene as an arm to connect to. It moves in real time when it is read, and "
      "without `real_time` in wait_until. Its scene is its own: nobody else steps it.\n\n"
      "Args:\n"
      "    robot: The robot, with an arm that is driven by position servos.\n"
      "    limits: Narrower limits than the model's, which has 2 rad/s and 10 rad/s^2 (or m).\n"
      "    real_time: False to move in wait_until only.\n"
      "    noise: Standard deviation of measured positions, rad or m.\n"
      "    watchdog: Time without a command after which it holds, s.\n"
      "    seed: Seed of the noise.");
  simulated.def(
      "__init__",
      [](SimulatedArm* self, const Robot& robot, const ArmLimits* limits, bool real_time,
         double noise, double watchdog, uint64_t seed) {
        const nb::gil_scoped_release unlocked;
        new (self) SimulatedArm(robot, {.limits = limits ? *limits : ArmLimits{},
                                        .real_time = real_time,
                                        .noise = noise,
                                        .watchdog = watchdog,
                                        .seed = seed});
      },
      "robot"_a, nb::kw_only(), "limits"_a.none() = nb::none(), "real_time"_a = true,
      "noise"_a = 0.0, "watchdog"_a = 0.2, "seed"_a = 0);
  DefPort(simulated);

  nb::class_<UdpArm, ArmPort> udp(
      m, "UdpArm",
      "An arm that is reached by datagrams, as `UdpArmServer` offers it.\n\n"
      "Args:\n"
      "    address: As \"127.0.0.1:7071\".\n"
      "    timeout: For its first answer, s.\n"
      "    remote: Whether the address may be of another computer. Packets are not encrypted.\n"
      "    secret: The same as the server's.\n\n"
      "Raises:\n"
      "    IoError: Nothing answers.");
  udp.def(
      "__init__",
      [](UdpArm* self, const std::string& address, double timeout, bool remote,
         const std::string& secret) {
        const nb::gil_scoped_release unlocked;
        new (self) UdpArm(address, {timeout, remote, secret});
      },
      "address"_a, nb::kw_only(), "timeout"_a = 2.0, "remote"_a = false, "secret"_a = "");
  DefPort(udp);
  udp.def_prop_ro("dropped", &UdpArm::dropped, "Number of packets that were dropped.");

  nb::class_<UdpArmServer>(
      m, "UdpArmServer",
      "Offers an arm to one other program by datagrams; it holds when that is silent. Call `poll` "
      "often, or use `serving`.\n\n"
      "Args:\n"
      "    arm: The port of the arm.\n"
      "    address: Where to listen; port 0 is any free one.\n"
      "    rate: Measurements sent per second.\n"
      "    watchdog: Time without a command after which the arm holds, s.\n"
      "    remote: Whether other computers may reach it. Give a secret then.\n"
      "    secret: Key of the packets' checksums; the same as the arm's.\n"
      "    faults: Makes the network as bad as wanted.",
      nb::type_slots(kHandleSlots<UdpArmServer, &VisitServer>))
      .def(
          "__init__",
          [](UdpArmServer* self, nb::handle_t<ArmPort> arm, const std::string& address, double rate,
             double watchdog, bool remote, const std::string& secret, const LinkFaults* faults) {
            const std::shared_ptr<ArmPort> port = CheckedPort(arm);
            const nb::gil_scoped_release unlocked;
            new (self) UdpArmServer(port, address,
                                    {.rate = rate,
                                     .watchdog = watchdog,
                                     .remote = remote,
                                     .secret = secret,
                                     .faults = faults ? *faults : LinkFaults{}});
          },
          "arm"_a, "address"_a = "127.0.0.1:0", nb::kw_only(), "rate"_a = 250.0, "watchdog"_a = 0.2,
          "remote"_a = false, "secret"_a = "", "faults"_a.none() = nb::none())
      .def("poll", &UdpArmServer::Poll, Unlocked(),
           "Answers what arrived, and sends the state if it is due. Never waits.")
      .def_prop_ro("address", &UdpArmServer::address, "Where it listens.")
      .def_prop_ro("is_driven", &UdpArmServer::is_driven, "True while a program drives the arm.")
      .def_prop_ro("dropped", &UdpArmServer::dropped, "Number of packets that were dropped.");
}

void BindLink(nb::module_& m) {
  nb::class_<ArmLink> link(
      m, "ArmLink",
      "Ties a robot of a scene to a real arm: each step of the scene sends what the robot's "
      "controller commands, within the limits, and puts the measured joints into the "
      "simulation.\n\n"
      "Args:\n"
      "    robot: The robot.\n"
      "    port: The arm: an `ArmPort`.\n"
      "    safety: How the arm is guarded.\n"
      "    period: Seconds between two commands, rounded up to whole steps of the scene.\n"
      "    timeout: For the first measurement, s.\n"
      "    group: The arm, for robots with several; \"\" for the first.\n\n"
      "Raises:\n"
      "    ArgumentError: The arm has other joints, or the robot is linked already.\n"
      "    IoError: Nothing is measured in time.",
      nb::type_slots(kHandleSlots<ArmLink, &VisitLink>));
  GuardHandle<ArmLink>(
      link, [](const ArmLink& l, SceneClaims& claims) { claims.Add(l.robot().scene()); },
      [](const ArmLink& l) { l.robot().RequireOpen(); },
      {.always = {"renew", "stop"},
       .closed = {"close", "closed", "ok", "state", "reason", "counts", "measured", "command",
                  "limits", "robot", "__enter__", "__exit__"}});
  link.def(
          "__init__",
          [](ArmLink* self, const Robot& robot, nb::handle_t<ArmPort> port,
             const SafetyOptions* safety, double period, double timeout, const std::string& group) {
            const std::shared_ptr<ArmPort> shared = CheckedPort(port);
            const nb::gil_scoped_release unlocked;
            new (self) ArmLink(robot, shared,
                               {.safety = safety ? *safety : SafetyOptions{},
                                .period = period,
                                .timeout = timeout,
                                .group = group});
          },
          "robot"_a, "port"_a, nb::kw_only(), "safety"_a.none() = nb::none(), "period"_a = 0.004,
          "timeout"_a = 2.0, "group"_a = "")
      .def("close", &ArmLink::Close, Unlocked(),
           "Brakes and holds the arm, and unties the robot, which stays where it is. May be "
           "repeated.")
      .def_prop_ro("closed", &ArmLink::closed, "True after close().")
      .def_prop_ro("ok", &ArmLink::ok, "True while steps of the scene drive the arm.")
      .def_prop_ro(
          "state", [](const ArmLink& l) { return std::string(ToString(l.state())); },
          "\"waiting\", \"running\", \"holding\" (dead man's switch) or \"stopped\".")
      .def_prop_ro("reason", &ArmLink::reason, "Why it holds or has stopped; \"\" otherwise.")
      .def_prop_ro(
          "counts", [](const ArmLink& l) { return l.counts(); }, "What passed the guard so far.")
      .def_prop_ro(
          "measured", [](const ArmLink& l) { return l.measured(); }, "The last good measurement.")
      .def_prop_ro(
          "command", [](const ArmLink& l) { return l.command(); },
          "The last command, sent or, in a dry run, not.")
      .def_prop_ro(
          "limits", [](const ArmLink& l) { return l.limits(); }, "The limits that are kept.")
      .def_prop_ro("period", &ArmLink::period, "Seconds between two commands.")
      .def_prop_ro(
          "robot", [](const ArmLink& l) { return l.robot(); }, "The robot.")
      .def("renew", &ArmLink::Renew, Unlocked(),
           "The dead man's switch is pressed. Any thread may call it.")
      .def("stop", &ArmLink::Stop, "reason"_a = "stopped by the program", Unlocked(),
           "Brakes and holds at the next step, for good. Any thread may call it.")
      .def(
          "move_to",
          [](ArmLink& l, nb::handle q, double timeout) {
            const std::vector<double> goal = ToRow(q, "q");
            const nb::gil_scoped_release unlocked;
            return l.MoveTo(goal, timeout, [poll = SparsePoll()]() mutable { poll(); });
          },
          "q"_a, "timeout"_a = 30.0,
          "Commands the joints and steps the scene until they are measured there, within 0.01 rad "
          "or m. Returns False if that takes longer than `timeout` seconds, or the arm stops. "
          "Raises "
          "ArgumentError for a controller that takes no joint positions.")
      .def(
          "__enter__", [](nb::handle self) { return nb::borrow(self); },
          nb::sig("def __enter__(self) -> typing.Self"))
      .def(
          "__exit__",
          [](ArmLink& l, nb::handle, nb::handle, nb::handle) {
            const nb::gil_scoped_release unlocked;
            l.Close();
          },
          "kind"_a.none(), "error"_a.none(), "trace"_a.none())
      .def("__repr__", [](const ArmLink& l) {
        return "<ArmLink of '" + l.robot().name() + "', " + ToString(l.state()) + ">";
      });
}

}  // namespace

void BindHardware(nb::module_& m) {
  BindValues(m);
  BindOptions(m);
  BindPorts(m);
  BindLink(m);
}

}  // namespace robocell::python
