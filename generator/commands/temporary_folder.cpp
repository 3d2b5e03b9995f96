#include "commands/temporary_folder.hpp"

#include <stdlib.h>

#include <string>
#include <system_error>

#include "diagnostics.hpp"

namespace dalembert {

namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (fs::temp_directory_path() / "dalembert.XXXXXX").string();
  if (!mkdtemp(pattern.data()))
    throw InputError(
        {Severity::error, "", "C++ compiler", "no temporary folder can be made", "set TMPDIR to a folder that can be written"});
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace dalembert
