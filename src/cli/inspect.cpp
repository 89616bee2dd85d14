#include "command.hpp"
namespace manycontact::cli {
const Command& inspect_command() { static const Command c{"inspect","SCENE","",{},"",nullptr}; return c; }
}
