// A user's first program: includes, links, and finds the built-in models.
#include <iostream>

#include "robocell/assets/resolve.h"
#include "robocell/base/version.h"
#include "robocell/math/pose.h"

int main() {
  const robocell::Pose there(Eigen::Vector3d(1, 2, 3));
  const robocell::Pose back = there * there.inverse();
  std::cout << robocell::Version() << ' ' << robocell::assets::ModelsRoot() << ' '
            << back.translation().norm() << '\n';
}
