// A folder for what is compiled or read once.
#pragma once

#include <sys/types.h>

#include <filesystem>

namespace dalembert {

// Made empty, under $TMPDIR or where the system has such folders; removed with all that is in it at the end, however this
// program ends.
class TemporaryFolder {
 public:
  TemporaryFolder();  // throws InputError when none can be made
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  pid_t keeper_ = 0;  // removes the folder when this program has died; waits for the end of a pipe
  int alive_ = -1;    // the pipe's other end
};

}  // namespace dalembert
