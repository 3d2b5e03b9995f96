// The executable as a user runs it.
#pragma once

#include <string>
#include <vector>

namespace dalembert::test {

struct Outcome {
  int status = -1;
  std::string out;  // stdout
  std::string err;  // stderr
};

// Runs `dalembert` with the arguments in the folder, with `input` on its standard input.
Outcome run_dalembert(const std::vector<std::string>& arguments, const std::string& folder, const std::string& input = "");

// The executable's path.
std::string dalembert_path();

// A folder that is removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// The file's text; empty when there is none.
std::string text_of(const std::string& path);
void write_text(const std::string& path, const std::string& text);

}  // namespace dalembert::test
