// What a report says, as rows: the only thing its page is drawn from.
#pragma once

#include <string>
#include <vector>

namespace dalembert::reporting {

struct Row {
  std::string section;   // rounding, stability, form, …
  std::string subject;   // the column `case`: which states, which robot, which segment
  std::string quantity;  // mass_matrix, …; `all`: the scene's outputs together; empty: none
  std::string variant;   // who computed it, and how
  std::string metric;
  std::string value;
  std::string unit;
};

class Rows {
 public:
  // The number with as many digits as it takes to read it back.
  void number(std::string section, std::string subject, std::string quantity, std::string variant, std::string metric,
              double value, std::string unit);
  void text(std::string section, std::string subject, std::string quantity, std::string variant, std::string metric,
            std::string value);

  const std::vector<Row>& all() const { return rows_; }

  // A header and a line per row, as RFC 4180 has it but for lines that end as here.
  std::string csv() const;

 private:
  std::vector<Row> rows_;
};

}  // namespace dalembert::reporting
