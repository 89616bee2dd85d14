// References are set from a configuration.

#include "manycontact/detail/contact/reference.hpp"

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
      EXPECT_EQ(std::string(error.what()), "resolve_references: q has " + std::to_string(size) +
                                               " numbers, expected " + std::to_string(s.scene.nq));
    }
    EXPECT_EQ(c.B.placement.p, before.p);
  }
}

TEST(ResolveReference, OfASceneIsThatOfEveryContact) {
  std::mt19937 rng(8);
  const RandomScene s = random_scene(rng);
  Scene all = s.scene;
  resolve_references(all, s.q);
  for (std::size_t c = 0; c < s.scene.contacts.size(); ++c) {
    Contact one = s.scene.contacts[c];
    resolve_reference(s.scene, s.q, true, true, one);
    EXPECT_NE(one.B.placement.p, s.scene.contacts[c].B.placement.p);
    EXPECT_EQ(all.contacts[c].B.placement.p, one.B.placement.p);
    EXPECT_EQ(all.contacts[c].B.placement.R, one.B.placement.R);
  }
  EXPECT_THROW(resolve_references(all, s.q.head(3)), std::invalid_argument);
}

}  // namespace
}  // namespace manycontact::test
