// Names of MuJoCo's types for headers that only pass pointers around, so that they need not include
// <mujoco/mujoco.h>.
#pragma once

struct mjModel_;
struct mjData_;
struct mjSpec_;
struct mjVFS_;
typedef struct mjModel_ mjModel;
typedef struct mjData_ mjData;
typedef struct mjSpec_ mjSpec;
typedef struct mjVFS_ mjVFS;
