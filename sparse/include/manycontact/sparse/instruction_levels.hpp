#pragma once
// What sources that are compiled once per level of instructions (src/lanes.cmake) and those that choose among them
// share.

/// The name a level's object has: MANYCONTACT_OF_LEVEL(level_) is level_avx2 in the source compiled for avx2.
#define MANYCONTACT_PASTE(prefix, level) prefix##level
#define MANYCONTACT_PASTE_VALUES(prefix, level) MANYCONTACT_PASTE(prefix, level)
#define MANYCONTACT_OF_LEVEL(prefix) MANYCONTACT_PASTE_VALUES(prefix, MANYCONTACT_LEVEL)

/// The level as a string.
#define MANYCONTACT_QUOTE(level) #level
#define MANYCONTACT_QUOTE_VALUE(level) MANYCONTACT_QUOTE(level)
#define MANYCONTACT_LEVEL_NAME MANYCONTACT_QUOTE_VALUE(MANYCONTACT_LEVEL)

namespace manycontact::sparse {

/// Whether the processor at hand has what a level above the baseline is compiled with.
bool runs_avx2();
bool runs_avx512();

}  // namespace manycontact::sparse
