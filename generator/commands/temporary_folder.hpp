// A folder for what is compiled or read once.
#pragma once

#include <filesystem>

namespace dalembert {

// Made empty, under $TMPDIR or where the system has such folders; removed with all that is in it at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();  // throws InputError when none can be made
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace dalembert
