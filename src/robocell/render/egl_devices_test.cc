#include "robocell/render/egl_devices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

const EglDevice kMesa{.vendor = "Mesa Project", .software = true};
const EglDevice kIntel{.vendor = "Mesa Project"};

EglDevice Nvidia(int cuda) { return {.vendor = "NVIDIA", .cuda = cuda}; }

using Devices = std::vector<EglDevice>;

TEST(EglDeviceOrder, HardwareComesBeforeSoftwareInAnyVendorOrder) {
  EXPECT_THAT(OrderEglDevices(Devices{kMesa, Nvidia(0)}, {}), ElementsAre(1, 0));
  EXPECT_THAT(OrderEglDevices(Devices{Nvidia(0), kMesa}, {}), ElementsAre(0, 1));
  EXPECT_THAT(OrderEglDevices(Devices{kMesa, kIntel, {}}, {}), ElementsAre(1, 2, 0));
  EXPECT_THAT(OrderEglDevices(Devices{kMesa}, {}), ElementsAre(0));
  EXPECT_TRUE(OrderEglDevices({}, {}).empty());
}

TEST(EglDeviceOrder, DevicesOfOneKindKeepEglsOrder) {
  EXPECT_THAT(OrderEglDevices(Devices{{}, kMesa, {}, kMesa, kIntel}, {}),
              ElementsAre(0, 2, 4, 1, 3));
}

TEST(EglDeviceOrder, CudaNumbersOrderTheDevicesThatReportThem) {
  EXPECT_THAT(OrderEglDevices(Devices{kMesa, Nvidia(2), Nvidia(0), Nvidia(1)}, {}),
              ElementsAre(2, 3, 1, 0));
  EXPECT_THAT(OrderEglDevices(Devices{Nvidia(4), Nvidia(2), Nvidia(0)}, {.cuda_visible = "2,4"}),
              ElementsAre(1, 0, 2));
  EXPECT_THAT(OrderEglDevices(Devices{kMesa, Nvidia(1), Nvidia(0)}, {.cuda_visible = "GPU-8932f"}),
              ElementsAre(2, 1, 0))
      << "a UUID says nothing of numbers";
  EXPECT_THAT(OrderEglDevices(Devices{Nvidia(0), Nvidia(0)}, {.cuda_visible = "0"}),
              ElementsAre(0, 1))
      << "numbers told twice say nothing";
}

TEST(EglDeviceOrder, WorkersTakeTheCardsInTurn) {
  const Devices devices = {kMesa, Nvidia(2), Nvidia(0), Nvidia(1), kIntel};
  const auto first = [&](int turn, const std::string& visible) {
    return OrderEglDevices(devices, {.cuda_visible = visible, .turn = turn}).front();
  };
  EXPECT_THAT((std::vector{first(0, ""), first(1, ""), first(2, ""), first(3, "")}),
              ElementsAre(2, 3, 1, 2))
      << "neither another kind of card nor software";
  EXPECT_THAT((std::vector{first(0, "2,1"), first(1, "2,1"), first(2, "2,1")}),
              ElementsAre(1, 3, 1));
  EXPECT_THAT((std::vector{first(0, "1"), first(1, "1")}), ElementsAre(3, 3));
  EXPECT_THAT(OrderEglDevices(devices, {.cuda_visible = "0,1", .turn = 1}),
              ElementsAre(3, 2, 1, 4, 0))
      << "the others follow, for a card that does not work";
  EXPECT_THAT(OrderEglDevices(devices, {.mujoco_device = "0", .turn = 1}), ElementsAre(2))
      << "a chosen device is that of all workers";
  EXPECT_THAT(OrderEglDevices(Devices{kMesa, kMesa}, {.turn = 1}), ElementsAre(0, 1));
  EXPECT_THAT(OrderEglDevices(Devices{{}, kMesa, {}}, {.turn = 1}), ElementsAre(2, 0, 1));
  EXPECT_TRUE(OrderEglDevices({}, {.turn = 1}).empty());
}

// For random machines: who has the same turn has the same card, and each card its share.
TEST(EglDeviceOrder, TurnsAreThoseOfCards) {
  Rng rng = Rng::Stream(1, "machines");
  for (int machine = 0; machine < 200; ++machine) {
    const int cards = 1 + static_cast<int>(rng.UniformInt(5));
    Devices devices;
    for (int card = 0; card < cards; ++card) devices.push_back(Nvidia(card));
    if (rng.UniformInt(2) == 0) devices.push_back(kMesa);
    rng.Shuffle(devices);
    std::map<int, std::set<size_t>> cards_of_turn;
    std::map<size_t, int> workers;
    for (int worker = 0; worker < 3 * cards; ++worker) {
      const EglDeviceChoice choice{.turn = worker};
      const size_t device = OrderEglDevices(devices, choice).front();
      cards_of_turn[TurnAmongCards(choice, static_cast<size_t>(cards))].insert(device);
      ++workers[device];
    }
    EXPECT_EQ(cards_of_turn.size(), cards);
    for (const auto& [turn, of] : cards_of_turn) EXPECT_EQ(of.size(), 1) << "turn " << turn;
    for (const auto& [device, count] : workers) EXPECT_EQ(count, 3);
  }
}

TEST(EglDeviceOrder, TurnsFollowTheVisibleCards) {
  EXPECT_EQ(TurnAmongCards({.cuda_visible = "4,7", .turn = 3}, 8), 1);
  EXPECT_EQ(TurnAmongCards({.cuda_visible = "4", .turn = 3}, 8), 0);
  EXPECT_EQ(TurnAmongCards({.mujoco_device = "1", .turn = 3}, 8), 0);
  EXPECT_EQ(TurnAmongCards({.turn = 9}, 8), 1);
  EXPECT_EQ(TurnAmongCards({.turn = 9}, 0), 0) << "no card";
}

// The cases of MuJoCo 4.0's own test of its choice.
TEST(EglDeviceChoices, AMujocoDeviceHasTheMeaningOfMujoco) {
  const Devices three = {Nvidia(2), Nvidia(1), Nvidia(0), kMesa};
  EXPECT_THAT(OrderEglDevices(three, {.mujoco_device = "2"}), ElementsAre(0)) << "a CUDA number";
  const Devices two = {Nvidia(2), Nvidia(0)};
  EXPECT_THAT(OrderEglDevices(two, {.mujoco_device = "0", .cuda_visible = "2"}), ElementsAre(0))
      << "a position in CUDA_VISIBLE_DEVICES";
  const Devices counted = {Nvidia(0), Nvidia(1), {}};
  EXPECT_THAT(OrderEglDevices(counted, {.mujoco_device = "0", .cuda_visible = "1,2"}),
              ElementsAre(0))
      << "devices counted from 0 in a container";
  const Devices hidden = {{}, Nvidia(0), kMesa};
  EXPECT_THAT(OrderEglDevices(hidden, {.mujoco_device = "2", .cuda_visible = "2"}), ElementsAre(1))
      << "the number of the machine outside of the container";
  EXPECT_THAT(OrderEglDevices(Devices{{}, {}, {}}, {.mujoco_device = "1"}), ElementsAre(1))
      << "an index where no device tells a CUDA number";
  EXPECT_THAT(OrderEglDevices(Devices{kMesa, {}}, {.mujoco_device = "0"}), ElementsAre(0))
      << "the device that was asked for, software or not";
}

TEST(EglDeviceChoices, TheRobocellVariableUsesEglNumbersAndTakesPrecedence) {
  const Devices devices = {kMesa, Nvidia(1), Nvidia(0)};
  EXPECT_THAT(OrderEglDevices(devices, {.robocell_device = "0", .mujoco_device = "1"}),
              ElementsAre(0));
  EXPECT_THAT(OrderEglDevices(devices, {.robocell_device = "2", .cuda_visible = "1"}),
              ElementsAre(2));
}

TEST(EglDeviceChoices, RejectsAMissingDeviceAndListsTheDevices) {
  const Devices devices = {kMesa, Nvidia(0)};
  const std::string list =
      " chooses none of the 2 EGL devices of this machine: device 0 (Mesa Project, software), "
      "device 1 (NVIDIA). Give one of their numbers, or unset the variable";
  for (const char* wrong : {"2", "-1", "one", "0x1", "1.0"}) {
    ExpectThrow<ArgumentError>([&] { OrderEglDevices(devices, {.robocell_device = wrong}); },
                               std::string("ROBOCELL_EGL_DEVICE=") + wrong + list);
    ExpectThrow<ArgumentError>([&] { OrderEglDevices(devices, {.mujoco_device = wrong}); },
                               std::string("MUJOCO_EGL_DEVICE_ID=") + wrong + list);
  }
}

TEST(SoftwareRenderers, AreKnownByTheirNames) {
  for (const char* name :
       {"llvmpipe (LLVM 15.0.6, 256 bits)", "softpipe", "Software Rasterizer", "swrast",
        "zink Vulkan 1.3(llvmpipe (LLVM 15.0.6, 256 bits) (MESA_LLVMPIPE))"})
    EXPECT_TRUE(IsSoftwareRenderer(name)) << name;
  for (const char* name : {"NVIDIA H100 80GB HBM3/PCIe/SSE2", "Mesa Intel(R) UHD Graphics 620",
                           "AMD Radeon RX 7900 XTX (radeonsi, navi31)", "virgl"})
    EXPECT_FALSE(IsSoftwareRenderer(name)) << name;
}

}  // namespace
}  // namespace robocell
