#pragma once
// Functions of any bytes are fuzzed. They return, or throw Finding, or a sanitizer ends the program. libfuzzer.cpp
// makes a fuzzer of each; fuzz_test.cpp runs the corpus through them in every build.

#include <cstddef>
#include <cstdint>
#include <stdexcept>

namespace manycontact::fuzz {

/// A fault: a wrong number with a good status, or an exception that is not documented.
struct Finding : std::logic_error {
  using std::logic_error::logic_error;
};

/// Reads the text of a URDF, or refuses it in one line. A model that was read is solved.
void fuzz_urdf(const std::uint8_t* data, std::size_t size);
/// Reads the text of a scene file, next to the robots of models/.
void fuzz_scene(const std::uint8_t* data, std::size_t size);
/// Reads the text of a task file, next to two scenes, "scene.xml" and "herd.xml".
void fuzz_task(const std::uint8_t* data, std::size_t size);
/// Makes a scene and its state of the bytes (scene_of_bytes.hpp), and compares every method with the dense reference.
void fuzz_solve(const std::uint8_t* data, std::size_t size);

}  // namespace manycontact::fuzz
