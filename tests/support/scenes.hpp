#pragma once
// The scenes tests run on: those of models/ and of ../shared/golden, smaller editions of large ones, and their states
// moved off symmetry and rest, where accelerations vanish and relative errors mean nothing.

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "manycontact/analysis/load_scene.hpp"

namespace manycontact::test {

inline const std::string kModels = MANYCONTACT_SOURCE_DIR "/models/";

/// Paths of the *.xml in a folder, sorted; none when the folder does not exist.
std::vector<std::string> scene_files(const std::string& folder);
std::vector<std::string> model_scenes();
std::vector<std::string> golden_scenes();

/// "herd" of ".../herd.xml".
std::string scene_name(const std::string& path);

/// As a test's name: letters, digits and underscores.
std::string readable(std::string name);
/// Of a test whose parameter is a scene's path.
std::string scene_title(const testing::TestParamInfo<std::string>& info);

struct Edit {
  std::string from, to;
};
/// The scene of a file after replacing texts in it, each of which must be there. Robots are still found.
SceneFile load_edited(const std::string& path, const std::vector<Edit>& edits);

/// A scene given as text; its paths count from models/.
SceneFile load_text(const std::string& xml);

/// The same with at most four copies of each robot: truth in quadruple precision takes a second then.
SceneFile load_small(const std::string& path);

/// The same state away from rest: q moved by about `size` in each coordinate, v random, u moved by up to 5 N m.
void disturb(SceneFile& file, std::mt19937& rng, double size = 0.05);

/// The scene of fixed arms on revolute joints with all lengths times `unit`, gravity and torques with them.
void scale_lengths(SceneFile& file, double unit);

/// A plane four-bar whose second axis is tilted out of the plane by so much, its pin a point (3d) or a hinge (5d).
SceneFile tilted_four_bar(double tilt, const std::string& type = "3d");

}  // namespace manycontact::test
