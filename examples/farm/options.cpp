#include "options.hpp"

#include <cerrno>
#include <cstdlib>
#include <set>

#include "error.hpp"

namespace farm {

const char* usage() {
  return "mpirun -np RANKS farm sweep    --states N --out FILE.h5 [--seed S] [--block N] [--results-only]\n"
         "mpirun -np RANKS farm identify --candidates N --recording FILE.h5 --out FILE.h5 [--seed S] [--block N]\n"
         "farm record --out FILE.h5 [--steps N]\n"
         "\n"
         "  sweep     forward dynamics of MAHRU's right arm at N states drawn at random\n"
         "  identify  N loads of its hand drawn at random: how far is each one's motion from the recorded one?\n"
         "  record    simulates a recording to try with\n"
         "\n"
         "  --block   items that are handed out together, a multiple of 1024; 65536 without\n"
         "  --seed    of what is drawn; 1 without\n"
         "  --results-only   states that were drawn are not kept\n"
         "\n"
         "FILE.h5 appears when all is computed; until then FILE.h5.work holds what there is. Whoever is killed: start again.\n";
}

namespace {

std::uint64_t number(const std::string& option, const std::string& text, std::uint64_t least, std::uint64_t most) {
  char* end = nullptr;
  errno = 0;
  const unsigned long long value = std::strtoull(text.c_str(), &end, 10);
  const bool is_one = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
  if (!is_one || errno == ERANGE || value < least || value > most)
    throw Error(option + ": '" + text + "' is no whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return value;
}

struct Known {
  const char *option, *commands;
};
constexpr Known all[] = {{"--states", "sweep"},        {"--candidates", "identify"},      {"--recording", "identify"},
                         {"--seed", "sweep identify"}, {"--block", "sweep identify"},     {"--results-only", "sweep"},
                         {"--steps", "record"},        {"--out", "sweep identify record"}};
const Known* known(const std::string& option) {
  for (const Known& one : all)
    if (option == one.option) return &one;
  return nullptr;
}

}  // namespace

Options read_options(int count, char** words) {
  Options options;
  std::set<std::string> given;
  constexpr std::uint64_t most = std::uint64_t{1} << 53;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--help" || word == "-h") {
      options.help = true;
      return options;
    }
    if (word.rfind("--", 0) != 0) {
      if (!options.command.empty()) throw Error("'" + word + "': one command only, and '" + options.command + "' is one");
      options.command = word;
      continue;
    }
    if (!known(word)) throw Error("'" + word + "': no such option; 'farm --help' lists them");
    if (!given.insert(word).second) throw Error(word + ": is given twice");
    if (word == "--results-only") {
      options.results_only = true;
      continue;
    }
    if (i + 1 == count) throw Error(word + ": has no value");
    const std::string value = words[++i];
    if (word == "--states" || word == "--candidates") options.items = number(word, value, 1, most);
    if (word == "--seed") options.seed = number(word, value, 0, ~std::uint64_t{0});
    if (word == "--steps") options.steps = number(word, value, 1, 1000000);
    if (word == "--block") {
      options.block = number(word, value, 1024, std::uint64_t{1} << 30);
      if (options.block % 1024 != 0)
        throw Error("--block: " + value + " is no multiple of 1024, and two ranks would write to one page; take " +
                    std::to_string((options.block / 1024 + 1) * 1024));
    }
    if (word == "--out") options.out = value;
    if (word == "--recording") options.recording = value;
  }
  const bool sweep = options.command == "sweep", identify = options.command == "identify";
  if (!sweep && !identify && options.command != "record")
    throw Error(options.command.empty() ? "no command; 'farm --help' lists them"
                                        : "'" + options.command + "': no such command; there are sweep, identify and record");
  for (const std::string& option : given)
    if (std::string(known(option)->commands).find(options.command) == std::string::npos)
      throw Error(option + ": is no option of '" + options.command + "'; 'farm --help' says whose it is");
  if (options.out.empty()) throw Error(options.command + ": needs --out FILE.h5");
  if ((sweep || identify) && options.items == 0)
    throw Error(options.command + (sweep ? ": needs --states N" : ": needs --candidates N"));
  if (identify && options.recording.empty())
    throw Error("identify: needs --recording FILE.h5; 'farm record' makes one to try with");
  return options;
}

}  // namespace farm
