#include "commands/machine.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>
#include <vector>

namespace dalembert {
namespace {

struct Models {
  int first, last;
  const char* generation;
};

// Of families 23 (Zen, Zen 2), 25 (Zen 3, Zen 4) and 26 (Zen 5), as Linux tells them apart.
constexpr Models amd_23[] = {
    {0x00, 0x2f, "Zen"}, {0x50, 0x5f, "Zen"}, {0x30, 0x4f, "Zen 2"}, {0x60, 0x7f, "Zen 2"}, {0x90, 0xaf, "Zen 2"}};
constexpr Models amd_25[] = {{0x00, 0x0f, "Zen 3"}, {0x20, 0x5f, "Zen 3"}, {0x10, 0x1f, "Zen 4"}, {0x60, 0xaf, "Zen 4"}};
constexpr Models amd_26[] = {{0x00, 0x4f, "Zen 5"}, {0x60, 0x7f, "Zen 5"}};
// Of family 6. Skylake's servers, Cascade Lake and Cooper Lake share a number.
constexpr Models intel_6[] = {{0x2a, 0x2a, "Sandy Bridge"},   {0x2d, 0x2d, "Sandy Bridge"},   {0x3a, 0x3a, "Ivy Bridge"},
                              {0x3e, 0x3e, "Ivy Bridge"},     {0x3c, 0x3c, "Haswell"},        {0x3f, 0x3f, "Haswell"},
                              {0x45, 0x46, "Haswell"},        {0x3d, 0x3d, "Broadwell"},      {0x47, 0x47, "Broadwell"},
                              {0x4f, 0x4f, "Broadwell"},      {0x56, 0x56, "Broadwell"},      {0x4e, 0x4e, "Skylake"},
                              {0x5e, 0x5e, "Skylake"},        {0x55, 0x55, "Skylake-SP"},     {0x8e, 0x8e, "Kaby Lake"},
                              {0x9e, 0x9e, "Coffee Lake"},    {0xa5, 0xa6, "Comet Lake"},     {0x66, 0x66, "Cannon Lake"},
                              {0x6a, 0x6a, "Ice Lake-SP"},    {0x6c, 0x6c, "Ice Lake-SP"},    {0x7d, 0x7e, "Ice Lake"},
                              {0xa7, 0xa7, "Rocket Lake"},    {0x8c, 0x8d, "Tiger Lake"},     {0x8f, 0x8f, "Sapphire Rapids"},
                              {0xcf, 0xcf, "Emerald Rapids"}, {0xad, 0xae, "Granite Rapids"}, {0x97, 0x97, "Alder Lake"},
                              {0x9a, 0x9a, "Alder Lake"},     {0xb7, 0xb7, "Raptor Lake"},    {0xba, 0xba, "Raptor Lake"},
                              {0xbf, 0xbf, "Raptor Lake"},    {0xaa, 0xaa, "Meteor Lake"},    {0xac, 0xac, "Meteor Lake"},
                              {0xaf, 0xaf, "Sierra Forest"},  {0xbd, 0xbd, "Lunar Lake"},     {0xb5, 0xb5, "Arrow Lake"},
                              {0xc5, 0xc6, "Arrow Lake"}};
// ARM's own cores, by "CPU part".
constexpr Models arm_parts[] = {{0xd07, 0xd07, "Cortex-A57"},   {0xd08, 0xd08, "Cortex-A72"},  {0xd0b, 0xd0b, "Cortex-A76"},
                                {0xd0c, 0xd0c, "Neoverse N1"},  {0xd40, 0xd40, "Neoverse V1"}, {0xd41, 0xd41, "Cortex-A78"},
                                {0xd42, 0xd42, "Cortex-A78AE"}, {0xd49, 0xd49, "Neoverse N2"}, {0xd4f, 0xd4f, "Neoverse V2"}};

template <size_t n>
std::string named(const Models (&list)[n], int model) {
  for (const Models& m : list)
    if (model >= m.first && model <= m.last) return m.generation;
  return "";
}

// A field of the first processor; empty: it has none such.
std::string field(const std::string& cpuinfo, const std::string& name) {
  std::istringstream lines(cpuinfo);
  for (std::string line; std::getline(lines, line);) {
    const size_t colon = line.find(':');
    if (colon == line.npos || line.substr(0, line.find_last_not_of(" \t", colon - 1) + 1) != name) continue;
    const size_t value = line.find_first_not_of(" \t", colon + 1);
    return value == line.npos ? "" : line.substr(value);
  }
  return "";
}

struct Processor {
  explicit Processor(const std::string& cpuinfo)
      : name(field(cpuinfo, "model name")),
        vendor(field(cpuinfo, "vendor_id")),
        family(number(cpuinfo, "cpu family")),
        model(number(cpuinfo, "model")),
        part(number(cpuinfo, "CPU part")) {
    std::istringstream words(field(cpuinfo, "flags") + " " + field(cpuinfo, "Features"));
    flags.assign(std::istream_iterator<std::string>(words), {});
  }
  static int number(const std::string& cpuinfo, const char* name) {
    const std::string text = field(cpuinfo, name);
    return text.empty() ? -1 : static_cast<int>(std::strtol(text.c_str(), nullptr, 0));
  }
  bool has(const char* flag) const { return std::find(flags.begin(), flags.end(), flag) != flags.end(); }

  std::string generation() const {
    if (vendor == "AuthenticAMD" && family == 23) return named(amd_23, model);
    if (vendor == "AuthenticAMD" && family == 25) return named(amd_25, model);
    if (vendor == "AuthenticAMD" && family == 26) return named(amd_26, model);
    if (vendor == "GenuineIntel" && family == 6) return named(intel_6, model);
    return part >= 0 && family < 0 ? named(arm_parts, part) : "";
  }

  std::string name, vendor;
  int family, model, part;
  std::vector<std::string> flags;
};

// What the units that work on several numbers are, and how wide where that is known: Zen 4 does in two halves what Zen 5 and
// Intel's do at once, and of Zen 5 so do those for laptops (models 0x20 to 0x3f and 0x60 to 0x6f).
std::string vectors(const Processor& p) {
  const std::string generation = p.generation();
  if (p.has("avx512f")) {
    const bool halves =
        generation == "Zen 4" ||
        (generation == "Zen 5" && ((p.model >= 0x20 && p.model <= 0x3f) || (p.model >= 0x60 && p.model <= 0x6f)));
    return generation.empty() ? "AVX-512" : fmt::format("AVX-512 on units of {} bits", halves ? 256 : 512);
  }
  if (p.has("avx2"))
    return generation.empty() ? "AVX2" : fmt::format("AVX2 on units of {} bits", generation == "Zen" ? 128 : 256);
  if (p.has("avx")) return "AVX";
  if (p.has("sse2")) return "SSE2";
  if (p.has("sve")) return "SVE";
  return p.has("asimd") || p.has("neon") ? "NEON, units of 128 bits" : "";
}

// "32K" to "32 kB", "1024K" to "1 MB".
std::string size(const std::string& text) {
  char* unit = nullptr;
  const long number = std::strtol(text.c_str(), &unit, 10);
  if (number <= 0) return "";
  if (*unit == 'M') return fmt::format("{} MB", number);
  return number % 1024 == 0 ? fmt::format("{} MB", number / 1024) : fmt::format("{} kB", number);
}

std::string joined(const std::vector<std::string>& parts, const char* between) {
  std::vector<std::string> there;
  std::copy_if(parts.begin(), parts.end(), std::back_inserter(there), [](const std::string& part) { return !part.empty(); });
  return fmt::format("{}", fmt::join(there, between));
}

std::string first_line(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

// Of the first processor: of data (or of all that is read), of the level. Some virtual machines hide the folders; there the
// processor itself is asked, which is `otherwise`.
std::string cache(const char* level, int otherwise) {
  for (int i = 0; i < 8; ++i) {
    const std::string folder = fmt::format("/sys/devices/system/cpu/cpu0/cache/index{}/", i);
    if (first_line(folder + "level") == level && first_line(folder + "type") != "Instruction")
      return first_line(folder + "size");
  }
  const long bytes = otherwise < 0 ? 0 : sysconf(otherwise);
  return bytes > 0 ? fmt::format("{}K", bytes / 1024) : "";
}

// glibc's names, where the C library is that.
#ifdef _SC_LEVEL1_DCACHE_SIZE
constexpr int first_level = _SC_LEVEL1_DCACHE_SIZE, second_level = _SC_LEVEL2_CACHE_SIZE;
#else
constexpr int first_level = -1, second_level = -1;
#endif

}  // namespace

Machine machine_of(const MachineFacts& facts) {
  const Processor p(facts.cpuinfo);
  const std::string first = size(facts.first_level_data), second = size(facts.second_level), generation = p.generation();
  // The kernel's name of a generation that is not known here is all that tells it from others.
  const std::string which = p.part >= 0     ? fmt::format("part {:#x}", p.part)
                            : p.family >= 0 ? fmt::format("family {}, model {}", p.family, p.model)
                                            : "";
  std::string name = p.name.empty() ? (p.part >= 0 ? "ARM" : "unknown processor") : p.name;
  Machine machine;
  machine.kind = joined({joined({name, generation.empty() ? which : generation}, ", "),
                         joined({first.empty() ? "" : "L1d " + first, second.empty() ? "" : "L2 " + second}, ", "), vectors(p)},
                        "; ");
  const double highest = std::strtod(facts.highest_clock.c_str(), nullptr) / 1e6,
               nominal = std::strtod(field(facts.cpuinfo, "cpu MHz").c_str(), nullptr) / 1e3;
  machine.details = joined({generation.empty() ? "" : which, fmt::format("{} core{}", facts.cores, facts.cores == 1 ? "" : "s"),
                            highest > 0   ? fmt::format("up to {:.1f} GHz", highest)
                            : nominal > 0 ? fmt::format("{:.1f} GHz", nominal)
                                          : ""},
                           "; ");
  return machine;
}

Machine this_machine() {
  std::ifstream file("/proc/cpuinfo");
  MachineFacts facts;
  facts.cpuinfo.assign(std::istreambuf_iterator<char>(file), {});
  facts.first_level_data = cache("1", first_level);
  facts.second_level = cache("2", second_level);
  facts.highest_clock = first_line("/sys/devices/system/cpu/cpu0/cpufreq/cpuinfo_max_freq");
  facts.cores = std::thread::hardware_concurrency();
  return machine_of(facts);
}

}  // namespace dalembert
