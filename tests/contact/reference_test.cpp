// References taken from a configuration.

#include "manycontact/contact/reference.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "support/random.hpp"

namespace manycontact::test {
namespace {

TEST(ResolveReference, RefusesAConfigurationOfAnotherSize) {
  std::mt19937 rng(7);
  const RandomScene s = random_scene(rng);
  Contact c = s.scene.contacts.at(0);
  const SE3<double> before = c.B.placement;
  for (const int size : {0, s.scene.nq - 1, s.scene.nq + 1, s.scene.nv}) {
    if (size == s.scene.nq) continue;
    try {
      resolve_reference(s.scene, Eigen::VectorXd::Zero(size), true, true, c);
      ADD_FAILURE() << "a q of " << size << " numbers was taken";
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()), "resolve_reference: q has " + std::to_string(size) +
                                               " numbers, the scene expects " + std::to_string(s.scene.nq));
    }
    EXPECT_EQ(c.B.placement.p, before.p);
  }
}

}  // namespace
}  // namespace manycontact::test
