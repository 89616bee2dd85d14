#pragma once
// What is fuzzed: functions of any bytes. They return, or throw Finding, or a sanitizer ends the program. libfuzzer.cpp
// makes a fuzzer of each, fuzz_test.cpp runs the corpus through them in every build.

#include <cstddef>
#include <cstdint>
#include <stdexcept>

namespace manycontact::fuzz {

/// Something wrong: a number with a good status, an exception that is none of the documented ones.
struct Finding : std::logic_error {
  using std::logic_error::logic_error;
};

/// The text of a URDF: read or refused by one line. What was read is solved.
void fuzz_urdf(const std::uint8_t* data, std::size_t size);
/// The text of a scene file, beside the robots of models/.
void fuzz_scene(const std::uint8_t* data, std::size_t size);
/// The text of a task file, beside two scenes, "scene.xml" and "herd.xml".
void fuzz_task(const std::uint8_t* data, std::size_t size);
/// A scene in code and its state, made of the bytes (scene_of_bytes.hpp): every method against the oracle.
void fuzz_solve(const std::uint8_t* data, std::size_t size);

}  // namespace manycontact::fuzz
