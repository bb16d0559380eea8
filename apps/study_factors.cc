#include "apps/study_factors.h"

#include "apps/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <set>

namespace apps {

namespace {

using Level = std::vector<std::string>; ///< a value of each key of a factor

/// Keys that change together, and the values that they take.
struct Factor {
  std::vector<std::string> keys;
  std::vector<Level> levels;
};

constexpr long most_levels = 10000;

std::optional<long> whole(const std::string& text)
{
  long number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number)
                                                                  : std::nullopt;
}

/// The numbers of "1..5"; the value itself if it is no such range.
std::vector<std::string> expanded(const std::string& value)
{
  const std::size_t dots = value.find("..");
  if (dots == std::string::npos)
    return {value};
  const std::optional<long> first = whole(trimmed(value.substr(0, dots)));
  const std::optional<long> last = whole(trimmed(value.substr(dots + 2)));
  if (!first || !last || *last < *first || *last - *first >= most_levels)
    return {value};
  std::vector<std::string> numbers;
  for (long k = *first; k <= *last; ++k)
    numbers.push_back(std::to_string(k));
  return numbers;
}

/// Values that hold commas themselves are separated by bars.
char separator_of(const std::string& values)
{
  return values.find('|') == std::string::npos ? ',' : '|';
}

std::vector<Level> levels_of(const std::string& values)
{
  std::vector<Level> levels;
  for (const std::string& each : split(values, separator_of(values)))
    if (each.find('&') == std::string::npos)
      for (const std::string& number : expanded(each))
        levels.push_back({number});
    else
      levels.push_back(split(each, '&'));
  return levels;
}

std::vector<Factor> factors_of(const std::string& vary, const std::string& values)
{
  std::vector<Factor> factors;
  for (const std::string& keys : split(vary, ';'))
    factors.push_back({split(keys, '&'), {}});
  const std::vector<std::string> lists = split(values, ';');
  for (std::size_t k = 0; k < std::min(lists.size(), factors.size()); ++k)
    factors[k].levels = levels_of(lists[k]);
  return factors;
}

std::string joined(const std::vector<std::string>& parts, const char* between)
{
  return fmt::format("{}", fmt::join(parts, between));
}

void check_keys(const std::vector<Factor>& factors, std::vector<std::string>& problems)
{
  std::set<std::string> seen;
  for (const Factor& factor : factors)
    for (const std::string& key : factor.keys)
      if (key.empty())
        problems.push_back("Vary: a key is missing beside '&' or ';'");
      else if (!seen.insert(key).second)
        problems.push_back(fmt::format("Vary: '{}' comes twice", key));
      else if (key.starts_with("Study/") || key == "Output/Folder")
        problems.push_back(fmt::format("Vary: '{}' cannot be varied", key));
}

void check_levels(const Factor& factor, std::vector<std::string>& problems)
{
  const std::string keys = joined(factor.keys, " & ");
  if (factor.levels.empty())
    problems.push_back(fmt::format("Values: there are none for '{}'", keys));
  std::set<Level> seen;
  for (const Level& level : factor.levels) {
    const std::string text = joined(level, " & ");
    if (std::ranges::find(level, "") != level.end())
      problems.push_back("Values: there is nothing between two separators");
    else if (level.size() != factor.keys.size())
      problems.push_back(fmt::format("Values: '{}' gives {} value{}, but '{}' is {} key{}", text,
                                     level.size(), level.size() == 1 ? "" : "s", keys,
                                     factor.keys.size(), factor.keys.size() == 1 ? "" : "s"));
    else if (!seen.insert(level).second)
      problems.push_back(fmt::format("Values: '{}' comes twice", text));
  }
}

/// The runs so far, each with every level of one more factor.
std::vector<StudyRun> with_factor(const std::vector<StudyRun>& runs, const Factor& factor)
{
  std::vector<StudyRun> all;
  for (const StudyRun& run : runs)
    for (const Level& level : factor.levels) {
      StudyRun next = run;
      const std::string text = joined(level, " & ");
      next.value += (next.value.empty() ? "" : ", ") + text;
      for (std::size_t k = 0; k < level.size(); ++k) {
        next.levels.emplace_back(factor.keys[k], level[k]);
        next.name += (next.name.empty() ? "" : "_") + as_folder_name(level[k]);
      }
      all.push_back(std::move(next));
    }
  return all;
}

} // namespace

std::vector<std::string> StudyRun::settings() const
{
  std::vector<std::string> texts;
  for (const auto& [key, level] : levels)
    texts.push_back(key + " = " + level);
  return texts;
}

std::vector<std::string> varied_keys(const std::string& vary)
{
  std::vector<std::string> keys;
  for (const Factor& factor : factors_of(vary, ""))
    keys.insert(keys.end(), factor.keys.begin(), factor.keys.end());
  return keys;
}

std::vector<std::string> factor_problems(const std::string& vary, const std::string& values)
{
  if (vary.empty() && values.empty())
    return {};
  if (vary.empty() || values.empty())
    return {"Vary: a study needs both Vary and Values"};
  std::vector<std::string> problems;
  const std::size_t n_lists = split(values, ';').size();
  const std::vector<Factor> factors = factors_of(vary, values);
  if (n_lists != factors.size())
    problems.push_back(fmt::format("Values: {} list{} separated by ';', but Vary names {} factor{}",
                                   n_lists, n_lists == 1 ? "" : "s", factors.size(),
                                   factors.size() == 1 ? "" : "s"));
  check_keys(factors, problems);
  double n_runs = 1;
  if (n_lists == factors.size())
    for (const Factor& factor : factors) {
      check_levels(factor, problems);
      n_runs *= double(factor.levels.size());
    }
  if (n_runs > double(most_levels))
    problems.push_back(
        fmt::format("Values: {:.0f} runs are more than {}, the most", n_runs, most_levels));
  return problems;
}

std::vector<StudyRun> combined_runs(const std::string& vary, const std::string& values)
{
  const std::vector<Factor> factors = factors_of(vary, values);
  if (factors.empty())
    return {};
  std::vector<StudyRun> runs{StudyRun{}};
  for (const Factor& factor : factors)
    runs = with_factor(runs, factor);
  constexpr std::size_t longest = 100; // of the name of a folder, which file systems limit
  std::set<std::string> names;
  for (StudyRun& run : runs) {
    run.name = run.name.substr(0, longest);
    while (!names.insert(run.name).second)
      run.name += "-";
  }
  return runs;
}

std::string as_folder_name(const std::string& value)
{
  std::string name;
  for (const char c : value)
    name += std::isalnum(static_cast<unsigned char>(c)) || c == '.' ? c : '-';
  const bool plain = !name.empty() && std::isalnum(static_cast<unsigned char>(name.front()));
  return plain ? name : "run" + name; // no hidden folders, none that looks like an option
}

} // namespace apps
