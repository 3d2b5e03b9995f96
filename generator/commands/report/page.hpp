// The page that draws a report: one file that needs nothing else.
#pragma once

#include <string>
#include <string_view>

namespace dalembert::reporting {

// HTML with its style, its script, the plotting library and the rows in it.
std::string page(const std::string& robot, const std::string& csv);

// Parts of the page as the build found them: templates/report/ and the library (D3, BSD-3-Clause).
std::string_view page_frame();
std::string_view page_style();
std::string_view page_script();
std::string_view plot_library();

}  // namespace dalembert::reporting
