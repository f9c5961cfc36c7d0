// Results of a campaign for people and for programs. Any thread.
#pragma once

#include <ostream>
#include <string>

#include "campaign/results/reader.h"

namespace campaign {

// Rates, expectations that were not met, measures; a table for each parameter in `by`.
void print_tables(std::ostream& out, const Results& results, const std::vector<std::string>& by);
// One line for each row, with all parameters and measures. RFC 4180.
void print_csv(std::ostream& out, const Results& results);
// Pages of failed rows (`rtse sweep --page`) are named as attachments, if they are in `runs`, the folder that the sweep kept files in.
Result<void> write_junit(const Results& results, const std::string& file, const std::string& runs);
// One page that needs no other file. Pictures of failed rows are taken from `runs`, the folder that the sweep kept files in, and from
// nowhere else: it may be no link.
Result<void> write_html(const Results& results, const std::string& file, const std::string& runs);

// What runs a row again.
std::string command_again(const Results& results, const ResultRow& row);

}  // namespace campaign
