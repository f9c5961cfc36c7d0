// Files and texts of worlds as XML documents: read with limits, common mistakes corrected, every element marked with its line. Any thread.
#pragma once

#include <filesystem>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "base/result.h"
#include "world/complaints.h"

namespace sim {

// The whole file. Fails for what is no regular file and for files that are larger than any world.
base::Result<std::string> read_file(const std::filesystem::path& path);

// What git leaves in place of a large file when its LFS content has not been fetched: three lines of text.
bool is_lfs_pointer(std::string_view text);
bool is_lfs_pointer_file(const std::filesystem::path& path);
inline constexpr std::string_view lfs_pointer_fault = "is a Git LFS pointer in place of the file (fetch it with: git lfs pull)";

// Fails for what is not XML (after repairing quotes and stray end tags), too deep, or has too many elements. Entities of a document type
// are not expanded.
base::Result<pugi::xml_document> parse_xml(const std::string& text, const std::string& file_name, Complaints& complaints);

// The element and all in it as one line of XML. Without the marks it is the text that libsdformat gets and by which equal models are known.
std::string to_xml(pugi::xml_node node, bool with_marks);

// First child element of that name along a path: "surface/friction/ode".
pugi::xml_node child_at(pugi::xml_node node, std::string_view path);
// Trimmed text of the element.
std::string text_of(pugi::xml_node node);

}  // namespace sim
