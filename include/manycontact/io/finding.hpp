#pragma once

#include <string>

namespace manycontact {

/// A questionable but usable property of a robot's file, and how it is interpreted.
struct Finding {
  std::string
      kind;  // "inertia", "limits", "unread", "mimic", "dynamics", "passive", "base", "consistent", "pose", "rest"
  std::string name;  // name of the joint, link or other element; in a scene's list with the robot's name: "herd/knee"
  std::string text;  // description of the property, and how it is interpreted
  std::string file;
  int line = 1;
};

}  // namespace manycontact
