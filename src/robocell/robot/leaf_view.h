// Where the leaf of a group is and how its joints move it, as the engine has it: views of its
// numbers, in the axes of the world, good until poses are computed anew.
//
// Plain numbers only; this header is included by code for every instruction set.
#pragma once

namespace robocell {

struct LeafView {
  int n = 0;                     // joints of one degree of freedom each
  const int* joints = nullptr;   // their ids
  const char* slides = nullptr;  // of them, else they turn
  // Of each joint of the model, by its id: three numbers.
  const double* axes = nullptr;
  const double* anchors = nullptr;
  // Of leaf and robot base; rotations row by row.
  const double* leaf_position = nullptr;
  const double* leaf_rotation = nullptr;
  const double* base_position = nullptr;
  const double* base_rotation = nullptr;
};

}  // namespace robocell
