// Embeds commands.txt, the parts of the page in src/program/view/page, and three.js. CMake defines their paths.

#include <stdexcept>

#include "page.hpp"

#define EMBED(NAME, FILE)                                                                                           \
  asm(".section .rodata\n" #NAME "_begin:\n.incbin \"" FILE "\"\n" #NAME "_end:\n.byte 0\n.previous\n.globl " #NAME \
      "_begin\n.globl " #NAME "_end");                                                                              \
  extern "C" const char NAME##_begin[], NAME##_end[]

EMBED(manycontact_commands_text, MANYCONTACT_COMMANDS);
EMBED(manycontact_page_html, MANYCONTACT_PAGE_HTML);
EMBED(manycontact_page_css, MANYCONTACT_PAGE_CSS);
EMBED(manycontact_page_script, MANYCONTACT_PAGE_SCRIPT);
#ifdef MANYCONTACT_THREE
EMBED(manycontact_three, MANYCONTACT_THREE);
#endif

namespace manycontact::cli {

std::string_view commands_text() { return {manycontact_commands_text_begin, manycontact_commands_text_end}; }

PageParts page_parts() {
  return {{manycontact_page_html_begin, manycontact_page_html_end},
          {manycontact_page_css_begin, manycontact_page_css_end},
          {manycontact_page_script_begin, manycontact_page_script_end},
#ifdef MANYCONTACT_THREE
          {manycontact_three_begin, manycontact_three_end}
#else
          {}
#endif
  };
}

void check_page_parts() {
  if (page_parts().three.empty())
    throw std::runtime_error(
        "a view needs three.js, which was not found when this program was built: install libjs-three (its name in "
        "Debian) and build again; `./run build` does both");
}

}  // namespace manycontact::cli
