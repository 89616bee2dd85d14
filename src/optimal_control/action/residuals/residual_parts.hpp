#pragma once

#include "manycontact/action/residual.hpp"

namespace manycontact::internal {

template <class State>
const State& given(const std::shared_ptr<State>& state) {
  require(state != nullptr, "ResidualModel", "a state is expected, not a null pointer");
  return *state;
}

inline std::size_t nu_or_default(const std::shared_ptr<StateAbstract>& state, std::size_t nu) {
  const std::size_t nv = given(state).get_nv();
  return nu == kDefaultNu ? nv : nu;
}

/// Casts the state to StateMultibody. This is valid for residuals whose constructor takes a StateMultibody.
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

/// Casts the data of a residual to the class Data, which the residual's createData creates.
template <class Data>
Data& own(ResidualDataAbstract& data) {
  return static_cast<Data&>(data);
}

/// Throws std::invalid_argument unless the collector has robots.
inline void expect_motion(const char* who, const DataCollector* shared) {
  require(shared && shared->scene.nrobots() > 0, who,
          "the collector has no motion, a collector of a MultibodyData or of an action model is expected");
}

/// Throws std::invalid_argument in standalone evaluation, where the dynamics are not solved.
inline void expect_dynamics(const char* who, const DataCollector* shared) {
  expect_motion(who, shared);
  require(!shared->whole, who, "the residual needs the solved dynamics, data of an action model are expected");
}

}  // namespace manycontact::internal
