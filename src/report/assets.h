// The parts of the page, as they stand in the files of the same names (cmake/EmbedText.cmake puts them here).
#pragma once

#include <string_view>

namespace pelage::report {

extern const std::string_view kPageHtml, kPageCss, kPageJs;
extern const std::string_view kPixelsJs, kPlotJs, kViewerJs, kCaseJs;  // parts of the script, in the order in which they run

}  // namespace pelage::report
