#pragma once
// Tasks given as text.

#include "manycontact/io/task_file.hpp"
#include "support/folder.hpp"

namespace manycontact::test {

/// A task of steps of 10 ms, `task` between its tags, on a scene; their files are gone afterwards.
inline TaskFile task_of(const std::string& name, const std::string& scene, const std::string& task,
                        const std::string& integrator = "euler") {
  const TemporaryFolder folder;
  (void)folder.write("scene.xml", scene);
  return read_task(folder.write("task.xml", "<task name='" + name + "' scene='scene.xml' step='0.01' integrator='" +
                                                integrator + "'>" + task + "</task>"));
}

}  // namespace manycontact::test
