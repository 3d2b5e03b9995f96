// The manual page and bash's completion, written from the tables that --help is printed from.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace dalembert {

// dalembert(1) in roff's man macros. Commands and options without a group are hidden, here as in --help.
std::string manual_page(const CLI::App& app, const std::string& version);

// A script for bash: commands, their options, options' words, and files.
std::string bash_completion(const CLI::App& app);

}  // namespace dalembert
