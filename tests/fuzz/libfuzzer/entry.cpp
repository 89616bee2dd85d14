// libFuzzer's entry. FUZZ_TARGET is one of targets.hpp.
#include "../targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  manycontact::fuzz::FUZZ_TARGET(data, size);  // a Finding ends the program, by std::terminate
  return 0;
}
