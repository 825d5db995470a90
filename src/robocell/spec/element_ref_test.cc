#include "robocell/spec/element_ref.h"

#include <gtest/gtest.h>

namespace robocell {
namespace {

TEST(ElementRef, IsDescribedByNameOrPlace) {
  EXPECT_EQ(Describe({.kind = ElementKind::kSite, .name = "tcp"}), "site 'tcp'");
  EXPECT_EQ(Describe({.name = "tcp"}), "element 'tcp'");
  EXPECT_EQ(Describe({.kind = ElementKind::kGeom, .body = "pad", .index = 3}),
            "geom 3 of body 'pad'");
}

}  // namespace
}  // namespace robocell
