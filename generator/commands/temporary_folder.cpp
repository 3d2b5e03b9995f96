#include "commands/temporary_folder.hpp"

#include <stdlib.h>

#include <cstdlib>
#include <string>
#include <system_error>

#include "diagnostics.hpp"

namespace dalembert {

namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder() {
  std::error_code error;
  std::string pattern = (fs::temp_directory_path(error) / "dalembert.XXXXXX").string();
  if (error || !mkdtemp(pattern.data())) {
    const char* asked = std::getenv("TMPDIR");
    const std::string place = asked ? "TMPDIR=" + std::string(asked) : "temporary folder";
    throw InputError({Severity::error, "", place, "no folder can be made there for what is compiled",
                      "set TMPDIR to a folder that can be written"});
  }
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace dalembert
