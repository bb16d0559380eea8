#include "apps/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <stdexcept>

namespace apps {

namespace {

double replace_cost(char a, char b)
{
  if (a == b)
    return 0;
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b))
             ? 0.5
             : 1;
}

/// Damerau-Levenshtein distance.
double typing_distance(const std::string& a, const std::string& b)
{
  std::vector<std::vector<double>> cost(a.size() + 1, std::vector<double>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        cost[i][j] = double(i + j);
        continue;
      }
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1,
                             cost[i - 1][j - 1] + replace_cost(a[i - 1], b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  return cost[a.size()][b.size()];
}

} // namespace

std::string trimmed(std::string_view text)
{
  const auto blank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  while (!text.empty() && blank(text.front()))
    text.remove_prefix(1);
  while (!text.empty() && blank(text.back()))
    text.remove_suffix(1);
  return std::string(text);
}

std::vector<std::string> split(std::string_view text, char separator)
{
  std::vector<std::string> parts;
  if (trimmed(text).empty())
    return parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(trimmed(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return parts;
}

std::string nearest(const std::string& word, const std::vector<std::string>& candidates)
{
  std::string best;
  double least = 0.5 * double(word.size()) + 0.5;
  for (const std::string& candidate : candidates)
    if (const double distance = typing_distance(word, candidate); distance < least) {
      least = distance;
      best = candidate;
    }
  return best;
}

std::string wrapped(std::string_view text, std::size_t width, const std::string& prefix)
{
  std::string result, line;
  const auto flush = [&] {
    result += prefix + line + '\n';
    line.clear();
  };
  for (const std::string& word : split(text, ' ')) {
    if (!line.empty() && prefix.size() + line.size() + 1 + word.size() > width)
      flush();
    line += (line.empty() ? "" : " ") + word;
  }
  if (!line.empty())
    flush();
  return result;
}

int count_or_auto(const std::string& option, const std::string& text, int most)
{
  if (text == "auto")
    return 0;
  int n = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (problem != std::errc() || end != text.data() + text.size() || n < 1 || n > most)
    throw std::invalid_argument(
        fmt::format("{}: '{}' is neither 'auto' nor a number from 1 to {}", option, text, most));
  return n;
}

} // namespace apps
