#include "commands/build/key.hpp"

#include <elf.h>
#include <fmt/format.h>
#include <link.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "commands/cache.hpp"
#include "frontend/robot_file.hpp"

namespace dalembert {

namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) return {};  // whoever reads it says so
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

// The linker's hash of this program, or where it has none, its file.
std::string this_program() {
  std::string id;
  dl_iterate_phdr(
      [](dl_phdr_info* object, size_t, void* to) {
        for (int i = 0; i < object->dlpi_phnum; ++i) {
          const auto& header = object->dlpi_phdr[i];
          if (header.p_type != PT_NOTE) continue;
          const char* at = reinterpret_cast<const char*>(object->dlpi_addr + header.p_vaddr);
          const char* const end = at + header.p_memsz;
          while (at + sizeof(ElfW(Nhdr)) <= end) {
            const auto& note = *reinterpret_cast<const ElfW(Nhdr)*>(at);
            const char* const description = at + sizeof note + (note.n_namesz + 3u) / 4 * 4;
            if (note.n_type == NT_GNU_BUILD_ID) static_cast<std::string*>(to)->assign(description, note.n_descsz);
            at = description + (note.n_descsz + 3u) / 4 * 4;
          }
        }
        return 1;  // the first object is the program
      },
      &id);
  return id.empty() ? bytes_of("/proc/self/exe") : id;
}

// A program's file by its place, size and date: a compiler that is replaced has others.
std::string program(const std::string& word) {
  std::vector<fs::path> places{word};
  if (word.find('/') == word.npos) {
    places.clear();
    const char* const path = std::getenv("PATH");
    std::istringstream folders(path ? path : "/usr/bin:/bin");
    for (std::string folder; std::getline(folders, folder, ':');) places.push_back(fs::path(folder) / word);
  }
  for (const fs::path& place : places) {
    std::error_code error;
    const fs::path real = fs::canonical(place, error);
    struct stat is;
    if (!error && stat(real.c_str(), &is) == 0 && S_ISREG(is.st_mode))
      return fmt::format("{} {} {}.{}", real.string(), is.st_size, is.st_mtim.tv_sec, is.st_mtim.tv_nsec);
  }
  return word;
}

// What -march=native goes by.
std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  std::string text;
  for (std::string line; std::getline(file, line) && !line.empty();)
    for (const char* key : {"vendor_id", "cpu family", "model", "flags", "Features", "CPU "})
      if (line.starts_with(key)) text += line + "\n";
  return text;
}

// The runtime's headers by their text, Eigen by its version.
void add_headers(Hash& hash) {
  for (const fs::path folder : include_folders()) {
    hash.add("Eigen", bytes_of(folder / "Eigen/src/Core/util/Macros.h"));
    std::error_code error;
    std::vector<fs::path> files;
    for (const fs::directory_entry& at : fs::recursive_directory_iterator(folder / "dalembert", error))
      if (at.path().extension() == ".hpp") files.push_back(at.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) hash.add(file.lexically_relative(folder).string(), bytes_of(file));
  }
}

}  // namespace

std::string generator_id() {
  Hash hash;
  hash.add("program", this_program());
  add_headers(hash);
  return hash.digits();
}

std::string key_of(const Request& request, const CompilerOptions& options) {
  Hash hash;
  hash.add("generator", generator_id());
  for (const std::string& file : {request.robot, request.scene_file}) {
    hash.add("file", fs::path(file).filename().string());
    if (!file.empty()) hash.add("content", file == request.robot ? frontend::robot_text(file) : bytes_of(file));
  }
  for (const frontend::Setting& setting : request.settings) hash.add(setting.key, setting.text);
  hash.add("form", request.form);
  for (const std::string& pass : request.without) hash.add("without", pass);
  hash.add("name", request.name);
  for (const std::string& word : compiler_words(options)) hash.add("compiler", program(word));
  for (const std::string& word : compiler_and_flags(options)) hash.add("word", word);
  for (const char* variable : {"CPATH", "CPLUS_INCLUDE_PATH", "LIBRARY_PATH", "COMPILER_PATH", "GCC_EXEC_PREFIX"})
    if (const char* const value = std::getenv(variable)) hash.add(variable, value);
  hash.add("processor", processor());
  return hash.digits();
}

}  // namespace dalembert
