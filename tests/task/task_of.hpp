#pragma once
// Reads tasks given as text.

#include "manycontact/io/task_file.hpp"
#include "support/folder.hpp"

namespace manycontact::test {

inline const std::string kTasks = MANYCONTACT_SOURCE_DIR "/models/tasks/";

/// Returns "0.1 0.1 0.1 ", a number per coordinate.
inline std::string repeated(const std::string& number, int count) {
  std::string out;
  for (int i = 0; i < count; ++i) out += number + " ";
  return out;
}

/// Reads a task with steps of 10 ms, `task` between its tags, on a scene; their files are removed afterwards.
inline TaskFile task_of(const std::string& name, const std::string& scene, const std::string& task,
                        const std::string& integrator = "euler") {
  const TemporaryFolder folder;
  (void)folder.write("scene.xml", scene);
  return read_task(folder.write("task.xml", "<task name='" + name + "' scene='scene.xml' step='0.01' integrator='" +
                                                integrator + "'>" + task + "</task>"));
}

}  // namespace manycontact::test
