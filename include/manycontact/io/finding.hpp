#pragma once
// What reading a robot's file found odd but usable.

#include <string>

namespace manycontact {

/// Something odd but usable that a robot's file says, and how it is taken. Kinds: src/doc/scene_file.md.
struct Finding {
  std::string kind;  // "inertia", "limits", "unread", "mimic", "dynamics", "passive", "base", "consistent"
  std::string name;  // of the joint, link or other element; in a scene's list with the robot's: "herd/knee"
  std::string text;  // what it says and what was made of that
  std::string file;
  int line = 1;
};

}  // namespace manycontact
