// The page of report_page.html as text; made by CMake.
#pragma once

namespace campaign {

extern const char* const report_page;

}  // namespace campaign
