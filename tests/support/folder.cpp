#include "support/folder.hpp"

#include <stdlib.h>  // NOLINT: mkdtemp is POSIX

#include <cerrno>
#include <fstream>
#include <system_error>

namespace fs = std::filesystem;

namespace manycontact::test {

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "manycontact_XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::system_error(errno, std::generic_category(), name);
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string TemporaryFolder::write(const std::string& name, const std::string& text) const {
  const fs::path file = path_ / name;
  fs::create_directories(file.parent_path());
  if (!(std::ofstream(file, std::ios::binary) << text)) throw std::runtime_error("cannot write " + file.string());
  return file.string();
}

}  // namespace manycontact::test
