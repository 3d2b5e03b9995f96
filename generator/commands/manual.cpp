#include "commands/manual.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>
#include <vector>

namespace dalembert {

namespace {

// As roff prints it: '-' and '\' are themselves, and no line begins with a request.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') out += "\\e";
    else if (c == '-') out += "\\-";
    else out += c;
  }
  if (!out.empty() && (out.front() == '.' || out.front() == '\'')) out.insert(0, "\\&");
  return out;
}

std::vector<const CLI::App*> shown_commands(const CLI::App& app) {
  std::vector<const CLI::App*> commands =
      app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
  return commands;
}

std::vector<const CLI::Option*> shown_options(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return !option->get_group().empty(); });
}

// "--out", "-o"; of what stands by its place, nothing.
std::vector<std::string> flags_of(const CLI::Option& option) {
  std::vector<std::string> flags;
  for (const std::string& name : option.get_snames()) flags.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) flags.push_back("--" + name);
  return flags;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

std::string options_roff(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* option : shown_options(app)) {
    std::vector<std::string> flags = flags_of(*option);
    for (std::string& flag : flags) flag = "\\fB" + roff(flag) + "\\fR";
    std::string head = flags.empty() ? "\\fI" + roff(option->get_name()) + "\\fR" : fmt::format("{}", fmt::join(flags, ", "));
    if (!flags.empty() && takes_value(*option)) head += " \\fI" + roff(option->get_type_name()) + "\\fR";
    text += fmt::format(".TP\n{}\n{}\n", head, roff(option->get_description()));
  }
  return text;
}

// What may stand behind an option, where its type is a list of words: "keep|lock".
std::vector<std::string> words_of(const CLI::Option& option) {
  std::vector<std::string> words;
  std::istringstream stream(option.get_type_name());
  for (std::string word; std::getline(stream, word, '|');) {
    const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
      return std::islower(c) || std::isdigit(c) || c == '_';
    });
    if (plain) words.push_back(word);
  }
  return words;
}

std::string case_of(const std::string& what, const std::vector<std::string>& words) {
  return fmt::format("    {}) COMPREPLY=($(compgen -W '{}' -- \"$word\")); return ;;\n", what, fmt::join(words, " "));
}

}  // namespace

std::string manual_page(const CLI::App& app, const std::string& version) {
  std::string text = fmt::format(
      ".TH DALEMBERT 1 \"\" \"dalembert {}\" \"User Commands\"\n.SH NAME\ndalembert \\- a dynamics compiler\n", version);
  text += ".SH SYNOPSIS\n";
  for (const CLI::App* command : shown_commands(app)) {
    text += fmt::format(".B dalembert {}\n", command->get_name());
    for (const CLI::Option* option : shown_options(*command)) {
      if (!option->get_required()) continue;
      const std::vector<std::string> flags = flags_of(*option);
      if (flags.empty()) text += fmt::format(".I {}\n", roff(option->get_name()));
      else text += fmt::format("{} \\fI{}\\fR\n", roff(flags.front()), roff(option->get_type_name()));
    }
    text += "[\\fIOPTION\\fR]...\n.br\n";
  }
  text += fmt::format(".SH DESCRIPTION\n{}\n.SH OPTIONS\n{}", roff(app.get_description()), options_roff(app));
  text += ".SH COMMANDS\n";
  for (const CLI::App* command : shown_commands(app))
    text += fmt::format(".SS {}\n{}.\n{}", command->get_name(), roff(command->get_description()), options_roff(*command));
  text += fmt::format(".SH EXIT STATUS\n{}\n", roff(app.get_footer()));
  text +=
      ".SH ENVIRONMENT\n"
      ".TP\n\\fBCXX\\fR\nThe C++ compiler of generated code, where \\-\\-compiler names none.\n"
      ".TP\n\\fBXDG_CACHE_HOME\\fR\nWhere compiled code is kept, in a folder dalembert; default ~/.cache.\n"
      ".TP\n\\fBDALEMBERT_INCLUDE\\fR\nFolders of the runtime's and Eigen's headers, separated by ':'.\n"
      ".SH SEE ALSO\nThe pages in /usr/share/doc/dalembert.\n";
  return text;
}

std::string bash_completion(const CLI::App& app) {
  std::vector<std::string> commands;
  std::string of_values, of_options;
  for (const CLI::App* command : shown_commands(app)) {
    commands.push_back(command->get_name());
    std::vector<std::string> all;
    for (const CLI::Option* option : shown_options(*command)) {
      const std::vector<std::string> flags = flags_of(*option);
      all.insert(all.end(), flags.begin(), flags.end());
      const std::vector<std::string> words = words_of(*option);
      for (const std::string& flag : flags) {
        const std::string both = command->get_name() + ":" + flag;
        if (!words.empty()) of_values += case_of(both, words);
        else if (option->get_type_name() == "DIR")
          of_values += fmt::format("    {}) COMPREPLY=($(compgen -d -- \"$word\")); return ;;\n", both);
        else if (takes_value(*option))
          of_values += fmt::format("    {}) COMPREPLY=($(compgen -f -- \"$word\")); return ;;\n", both);
      }
    }
    of_options += case_of(command->get_name(), all);
  }
  std::vector<std::string> own;
  for (const CLI::Option* option : shown_options(app))
    for (const std::string& flag : flags_of(*option)) own.push_back(flag);
  std::vector<std::string> first = commands;
  first.insert(first.end(), own.begin(), own.end());
  return fmt::format(
      "# bash completion for dalembert, written by `dalembert completion`.\n"
      "_dalembert() {{\n"
      "  local word=\"${{COMP_WORDS[COMP_CWORD]}}\" before=\"${{COMP_WORDS[COMP_CWORD-1]}}\" command=\"${{COMP_WORDS[1]}}\"\n"
      "  COMPREPLY=()\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      "    COMPREPLY=($(compgen -W '{}' -- \"$word\"))\n"
      "    return\n"
      "  fi\n"
      "  case \"$command:$before\" in\n{}  esac\n"
      "  case \"$word\" in\n"
      "    -*) ;;\n"
      "    *) COMPREPLY=($(compgen -f -- \"$word\")); return ;;\n"
      "  esac\n"
      "  case \"$command\" in\n{}  esac\n"
      "}}\n"
      "complete -o filenames -F _dalembert dalembert\n",
      fmt::join(first, " "), of_values, of_options);
}

}  // namespace dalembert
