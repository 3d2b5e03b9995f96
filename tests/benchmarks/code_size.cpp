#include "code_size.hpp"

#include <cstdio>
#include <memory>
#include <sstream>
#include <stdexcept>

namespace dalembert::benchmarks {

CodeSize code_size(const std::string& archive) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(("size -A '" + archive + "'").c_str(), "r"), pclose);
  if (!pipe) throw std::runtime_error("cannot run size(1) on " + archive);
  CodeSize total;
  bool counted = true;
  char buffer[512];
  while (std::fgets(buffer, sizeof buffer, pipe.get())) {
    const std::string line = buffer;  // "dynamics.cpp.o   (ex lib.a):" or "section  size  address"
    if (line.find("(ex ") != std::string::npos) counted = line.rfind("c_api", 0) != 0 && line.rfind("self_test", 0) != 0;
    std::string section;
    long bytes = 0;
    if (!counted || !(std::istringstream(line) >> section >> bytes)) continue;
    if (section.rfind(".text", 0) == 0) total.text += bytes;
    if (section.rfind(".rodata", 0) == 0) total.tables += bytes;
  }
  return total;
}

}  // namespace dalembert::benchmarks
