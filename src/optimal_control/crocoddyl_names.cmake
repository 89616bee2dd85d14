# Writes OUTPUT, manycontact/crocoddyl/names.hpp: a using-declaration in namespace crocoddyl of every name that headers
# in the folders INCLUDE declare in namespace manycontact. It relies on their format: such a declaration begins in the first column.
cmake_minimum_required(VERSION 3.22)
set(roots manycontact/action.hpp manycontact/control.hpp manycontact/manycontact.hpp)
# Names that crocoddyl.hpp defines. They are left out, so that `using namespace crocoddyl` makes no name ambiguous.
set(own CostModelSum ConstraintModelManager ContactModelMultiple ImpulseModelMultiple)
list(TRANSFORM own APPEND Tpl OUTPUT_VARIABLE own_templates)

set(open ${roots})
set(read manycontact/detail/spatial/pack.hpp)  # it has numbers of SIMD batches alone
set(names)
while(open)
  list(POP_FRONT open header)
  set(file)
  foreach(folder IN LISTS INCLUDE)
    if(NOT file AND EXISTS ${folder}/${header})
      set(file ${folder}/${header})
    endif()
  endforeach()
  if(header IN_LIST read OR NOT file)
    continue()
  endif()
  list(APPEND read ${header})
  file(READ ${file} text)
  string(REGEX MATCHALL "#include \"[^\"]+" included "${text}")
  list(TRANSFORM included REPLACE "#include \"" "")
  list(APPEND open ${included})

  string(REGEX REPLACE "(^|\n)(namespace manycontact {|}  // namespace manycontact)\n" "\n" text "${text}")
  string(REGEX REPLACE "//[^\n]*" "" text "${text}")
  string(REGEX REPLACE "#ifdef MANYCONTACT_[^#]*" "" text "${text}")  # declarations for kernels and tests
  string(REGEX REPLACE "template <([^<>\n]|<[^<>\n]*>)*> |\\[\\[[^]]*]] " "" text "${text}")
  string(REGEX MATCHALL "\nenum [A-Za-z]+ {[^}]*" enumerations "${text}")
  foreach(enumeration IN LISTS enumerations)
    string(REGEX REPLACE ".*{" "" enumerators "${enumeration}")
    string(REGEX MATCHALL "[A-Za-z_][A-Za-z0-9_]*" enumerators "${enumerators}")
    list(APPEND names ${enumerators})
  endforeach()
  while(text MATCHES "{[^{}]*}")  # only declarations of the namespace remain
    string(REGEX REPLACE "{[^{}]*}" "" text "${text}")
  endwhile()

  string(REGEX MATCHALL "\n[A-Za-z][^\n(=;[]*" declarations "${text}")
  list(FILTER declarations EXCLUDE REGEX "^\n(namespace|template)")
  foreach(declaration IN LISTS declarations)
    if(declaration MATCHES "^\n(class|struct|enum class|enum) ([A-Za-z0-9_]+)")
      list(APPEND names ${CMAKE_MATCH_2})
    elseif(declaration MATCHES "[ *&]([A-Za-z_][A-Za-z0-9_]*) ?$")
      list(APPEND names ${CMAKE_MATCH_1})
    endif()
  endforeach()
endwhile()

list(REMOVE_DUPLICATES names)
list(REMOVE_ITEM names ${own} ${own_templates})
list(SORT names)
list(JOIN roots "\"\n#include \"" includes)
list(JOIN names ";\nusing manycontact::" names)
file(WRITE ${OUTPUT} "#pragma once
// The library's names for programs written for Crocoddyl. The build has written this header from the others.

#include \"${includes}\"

namespace crocoddyl {
namespace names {

using manycontact::${names};

}  // namespace names
}  // namespace crocoddyl
")
