#pragma once
// Tasks given as text.

#include "manycontact/io/task_file.hpp"
#include "support/folder.hpp"

namespace manycontact::test {

inline const std::string kTasks = MANYCONTACT_SOURCE_DIR "/models/tasks/";

/// "0.1 0.1 0.1 ", for a number per coordinate.
inline std::string repeated(const std::string& number, int count) {
  std::string out;
  for (int i = 0; i < count; ++i) out += number + " ";
  return out;
}

/// A task of steps of 10 ms, `task` between its tags, on a scene; their files are gone afterwards.
inline TaskFile task_of(const std::string& name, const std::string& scene, const std::string& task,
                        const std::string& integrator = "euler") {
  const TemporaryFolder folder;
  (void)folder.write("scene.xml", scene);
  return read_task(folder.write("task.xml", "<task name='" + name + "' scene='scene.xml' step='0.01' integrator='" +
                                                integrator + "'>" + task + "</task>"));
}

}  // namespace manycontact::test
