// Random chains in which joints follow others, for the tests of this folder.
#pragma once

#include <fmt/format.h>

#include <numeric>
#include <string>
#include <vector>

#include "robocell/kinematics/testing/models.h"

namespace robocell {

// Writes the MJCF of a random chain "base" -> site "tip" whose joints j0, j1, ... are coupled by
// affine and bending polynomials; followers may be led by others, and come before their leaders.
inline std::string CoupledChainXml(Rng* rng, int joints) {
  std::string xml =
      RandomChainXml(rng, {.joints = joints, .slide_share = 0.25, .limited_share = 1}).Write();
  // The reference position of a slide may be far beyond its limits, and its coupling begins there.
  for (std::size_t at = 0; (at = xml.find("type='slide'", at)) != std::string::npos; ++at) {
    const std::size_t ref = xml.find(" ref='", at), end = xml.find('>', at);
    if (ref < end) xml.erase(ref, xml.find('\'', ref + 6) + 1 - ref);
  }
  std::vector<int> order(static_cast<std::size_t>(joints));
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = order.size() - 1; i > 0; --i)
    std::swap(order[i], order[rng->UniformInt(i + 1)]);
  std::string equalities;
  std::vector<bool> follows(order.size(), false);
  for (std::size_t k = 1; k < order.size(); ++k) {
    if (k > 1 && rng->Uniform() < 0.55) continue;
    const std::size_t leader = rng->UniformInt(k);
    const bool bends = !follows[leader] && rng->Uniform() < 0.5;
    // A slide moves by tenths of a metre where a hinge turns by a radian: slopes stay small, so
    // that the limits of all can be met.
    const double slope = (rng->Uniform() < 0.5 ? -1 : 1) * rng->Uniform(0.02, 0.06);
    const double cubic = bends ? slope * rng->Uniform(0.05, 0.2) : 0;
    const double square = bends ? 0.5 * std::abs(slope) * rng->Uniform(-0.2, 0.2) : 0;
    equalities +=
        fmt::format("<joint joint1='j{}' joint2='j{}' polycoef='{} {} {} {} 0'/>", order[k],
                    order[leader], rng->Uniform(-0.02, 0.02), slope, square, cubic);
    // A follower of this one must not bend.
    follows[k] = true;
  }
  const std::size_t end = xml.rfind("</mujoco>");
  return xml.insert(end, "<equality>" + equalities + "</equality>");
}

}  // namespace robocell
