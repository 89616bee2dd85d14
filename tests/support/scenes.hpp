#pragma once
// Tests run on the scenes of models/ and ../shared/golden, and on smaller editions of large ones. Their states are
// moved off symmetry and rest, where accelerations vanish and relative errors are meaningless.

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "manycontact/analysis/load_scene.hpp"

namespace manycontact::test {

inline const std::string kModels = MANYCONTACT_SOURCE_DIR "/models/";

/// Returns paths of the *.xml in a folder, sorted; none if the folder does not exist.
std::vector<std::string> scene_files(const std::string& folder);
std::vector<std::string> model_scenes();
std::vector<std::string> golden_scenes();

/// Returns "herd" for ".../herd.xml".
std::string scene_name(const std::string& path);

/// Returns a test's name: letters, digits and underscores.
std::string readable(std::string name);
/// Returns the name of a test whose parameter is a scene's path.
std::string scene_title(const testing::TestParamInfo<std::string>& info);

struct Edit {
  std::string from, to;
};
/// Returns the scene of a file after replacing texts in it, each of which must occur. Paths of robots remain valid.
SceneFile load_edited(const std::string& path, const std::vector<Edit>& edits);

/// Returns a scene given as text; its paths are relative to models/.
SceneFile load_text(const std::string& xml);

/// Returns the scene with at most four copies of each robot, so that quadruple precision takes a second.
SceneFile load_small(const std::string& path);

/// Moves the state away from rest: q by about `size` in each coordinate, v random, u by up to 5 N m.
void disturb(SceneFile& file, std::mt19937& rng, double size = 0.05);

/// Multiplies all lengths of a scene of fixed arms on revolute joints by `unit`, with gravity and torques.
void scale_lengths(SceneFile& file, double unit);

/// Returns a planar four-bar whose second axis is tilted out of the plane by `tilt`; its pin is a point or a hinge.
SceneFile tilted_four_bar(double tilt, const std::string& type = "3d");

}  // namespace manycontact::test
