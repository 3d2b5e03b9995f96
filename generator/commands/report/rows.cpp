#include "commands/report/rows.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace dalembert::reporting {
namespace {

std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return text;
  std::string quoted = "\"";
  for (char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace

void Rows::number(std::string section, std::string subject, std::string quantity, std::string variant, std::string metric,
                  double value, std::string unit) {
  rows_.push_back({std::move(section), std::move(subject), std::move(quantity), std::move(variant), std::move(metric),
                   std::isnan(value) ? "nan" : fmt::format("{}", value), std::move(unit)});
}

void Rows::text(std::string section, std::string subject, std::string quantity, std::string variant, std::string metric,
                std::string value) {
  rows_.push_back({std::move(section), std::move(subject), std::move(quantity), std::move(variant), std::move(metric),
                   std::move(value), ""});
}

std::string Rows::csv() const {
  std::string text = "section,case,quantity,variant,metric,value,unit\n";
  for (const Row& row : rows_) {
    const std::string* cells[] = {&row.section, &row.subject, &row.quantity, &row.variant, &row.metric, &row.value, &row.unit};
    for (size_t i = 0; i < std::size(cells); ++i) {
      text += cell(*cells[i]);
      text += i + 1 < std::size(cells) ? ',' : '\n';
    }
  }
  return text;
}

}  // namespace dalembert::reporting
