#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace apps {

std::string trimmed(std::string_view text);

/// Parts between separators, trimmed. An empty text has no parts.
std::vector<std::string> split(std::string_view text, char separator);

/// The candidate with the fewest typing mistakes (insert, delete, replace, swap; case counts half),
/// or an empty text if all are too far away.
std::string nearest(const std::string& word, const std::vector<std::string>& candidates);

/// The number of an option that is 'auto' (0) or a whole number from 1 to `most`.
/// \throws std::invalid_argument naming the option
int count_or_auto(const std::string& option, const std::string& text, int most);

/// Text wrapped to a width, each line behind a prefix.
std::string wrapped(std::string_view text, std::size_t width, const std::string& prefix);

} // namespace apps
