#include "run_dalembert.hpp"

#include <stdlib.h>
#include <sys/wait.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace dalembert::test {

namespace {
// Appends the text as one word of a shell's command line.
void append_word(std::string& command, const std::string& text) {
  command += " '";
  for (char c : text) {
    if (c == '\'') command += "'\\''";
    else command += c;
  }
  command += '\'';
}
}  // namespace

Outcome run_dalembert(const std::vector<std::string>& arguments, const std::string& folder, const std::string& input) {
  const TemporaryFolder streams;
  const std::string in = streams.path() + "/in", out = streams.path() + "/out", err = streams.path() + "/err";
  write_text(in, input);
  std::string command = "cd";
  append_word(command, folder);
  command += " &&";
  append_word(command, DALEMBERT_EXECUTABLE);
  for (const std::string& argument : arguments) append_word(command, argument);
  command += " <";
  append_word(command, in);
  command += " >";
  append_word(command, out);
  command += " 2>";
  append_word(command, err);
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(out), text_of(err)};
}

std::string dalembert_path() { return DALEMBERT_EXECUTABLE; }

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "dalembert_test.XXXXXX").string();
  if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_text(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

}  // namespace dalembert::test
