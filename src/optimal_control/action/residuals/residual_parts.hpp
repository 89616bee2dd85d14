#pragma once
// Helpers of the residuals' sources.

#include "manycontact/action/residual.hpp"

namespace manycontact::internal {

template <class State>
const State& given(const std::shared_ptr<State>& state) {
  require(state != nullptr, "ResidualModel", "a state is expected, not a null pointer");
  return *state;
}

/// The state of a residual whose constructor takes a StateMultibody.
inline const StateMultibody& multibody(const std::shared_ptr<StateAbstract>& state) {
  return static_cast<const StateMultibody&>(*state);
}

inline const Multibody::BodyFrame& body_frame(const char* who, const StateMultibody& state, FrameIndex id) {
  const std::vector<Multibody::BodyFrame>& frames = state.get_model()->frames;
  require(id < frames.size(), who,
          "frame " + std::to_string(id) + " does not exist, a number below " + std::to_string(frames.size()) +
              " is expected");
  return frames[id];
}

/// Throws std::invalid_argument where there are no robots to look at.
inline void expect_motion(const char* who, const DataCollector* shared) {
  require(shared && shared->scene.nrobots() > 0, who,
          "the collector has no motion, one of a MultibodyData or of an action model is expected");
}

/// Throws std::invalid_argument in standalone use, where the dynamics are not solved.
inline void expect_dynamics(const char* who, const DataCollector* shared) {
  expect_motion(who, shared);
  require(!shared->whole, who, "it needs the solved dynamics, and so an action model's data");
}

/// first, first + 1, ... (n numbers).
inline std::vector<int> range(int first, int n) {
  std::vector<int> numbers(n);
  for (int i = 0; i < n; ++i) numbers[i] = first + i;
  return numbers;
}

/// A row r = x_i + const. or u_i + const.
inline void add_coordinate(int row, const std::vector<int>& xcols, const std::vector<int>& ucols,
                           ResidualDataAbstract& data) {
  ResidualBlock& block = data.blocks.emplace_back(std::vector<int>{row}, xcols, ucols);
  block.Rx.setOnes();
  block.Ru.setOnes();
  block.constant = true;
}

/// One block per control, 1 x 1: of r = u - uref.
inline void lay_out_controls(std::size_t nu, ResidualDataAbstract& data) {
  data.blocks.clear();
  data.blocks.reserve(nu);
  for (int i = 0; i < static_cast<int>(nu); ++i) add_coordinate(i, {}, {i}, data);
}

}  // namespace manycontact::internal
