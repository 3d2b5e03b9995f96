#include "commands/generate.hpp"

#include <fmt/format.h>

namespace dalembert {

std::string generate(const Model& model, const std::string& folder) {
  backend::check_folder(folder);  // before minutes of work
  const std::vector<backend::OutputFile> files = compile(model);
  backend::write_files(folder, files);
  size_t bytes = 0;
  for (const backend::OutputFile& file : files) bytes += file.text.size();
  return fmt::format("{}: {} files, {} kB, in {}\n", model.name, files.size(), (bytes + 999) / 1000, folder);
}

}  // namespace dalembert
