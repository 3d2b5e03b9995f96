// `dalembert report`: error against time, stability and forms of a robot's generated code, as a table and as a page.
#pragma once

#include <string>

#include "commands/compiler.hpp"
#include "pipeline.hpp"

namespace dalembert {

struct ReportOptions {
  std::string folder;  // made when missing
  bool quick = false;  // fewer variants and states: under a minute where the whole takes up to ten
};

struct ReportSummary {
  std::string text;  // the verdict, and where the files are
  bool passed = true;
};

// Measures, and writes report.csv (columns section,case,quantity,variant,metric,value,unit) and index.html, which shows what
// is in it. Says on stderr how far it is. Both files are written at the end, each under a temporary name first: whoever
// interrupts finds what was there before. Passes when no case goes badly in double. Throws InputError when the generated code
// cannot be compiled or the folder not be written.
ReportSummary write_report(const Model& model, const CompilerOptions& compiler, const ReportOptions& options);

}  // namespace dalembert
