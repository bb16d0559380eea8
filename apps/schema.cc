#include "apps/schema.h"

#include "apps/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <memory>

namespace apps {

namespace {

/// A pattern of deal.II whose rule is a function.
class CheckedText : public dealii::Patterns::PatternBase {
public:
  CheckedText(std::function<std::string(const std::string&)> check, std::string description)
      : check_(std::move(check)), description_(std::move(description))
  {
  }
  bool match(const std::string& text) const override { return check_(text).empty(); }
  std::string description(const OutputStyle) const override { return description_; }
  std::unique_ptr<PatternBase> clone() const override
  {
    return std::make_unique<CheckedText>(*this);
  }

private:
  std::function<std::string(const std::string&)> check_;
  std::string description_;
};

std::string path_of(const std::string& section, const std::string& key)
{
  return section.empty() ? key : section + "/" + key;
}

/// SI unit of the same dimension, by the units the scenes use.
std::string si_unit_of(const std::string& unit)
{
  static const std::map<std::string, std::string> table{
      {"mm", "m"},    {"kPa", "Pa"},       {"degC", "K"}, {"%", "1"},     {"s", "s"},
      {"N/m", "N/m"}, {"N s/m", "N s/m"},  {"N", "N"},    {"1/s", "1/s"}, {"kg/m^3", "kg/m^3"},
      {"K", "K"},     {"kJ/mol", "J/mol"}, {"Hz", "Hz"},  {"1", "1"}};
  return table.at(unit);
}

std::string range_text(const std::string& unit, const Bounds& bounds)
{
  const std::string range = unit == "1" ? "a number" : "in " + unit;
  return bounds.text().empty() ? range : range + ", " + bounds.text();
}

/// True if a number in a list, or in a list of pairs, comes without a unit.
bool has_bare_number(const std::string& text)
{
  for (const std::string& part : split(text, ','))
    for (const std::string& number : split(part, ':'))
      if (is_bare_number(number))
        return true;
  return false;
}

/// The name that was probably meant, or all there are.
std::string suggestion(const std::string& close, const std::string& introduction,
                       const std::vector<std::string>& names)
{
  if (!close.empty())
    return fmt::format("did you mean '{}'?", close);
  return introduction + fmt::format("{}", fmt::join(names, ", "));
}

} // namespace

bool Bounds::contain(double value) const
{
  return (low_allowed ? value >= low : value > low) &&
         (high_allowed ? value <= high : value < high);
}

std::string Bounds::text() const
{
  const bool has_low = std::isfinite(low), has_high = std::isfinite(high);
  if (has_low && has_high && low_allowed && high_allowed)
    return fmt::format("{} to {}", shortest(low), shortest(high));
  std::string result;
  if (has_low)
    result = fmt::format("{} {}", low_allowed ? ">=" : ">", shortest(low));
  if (has_high)
    result += fmt::format("{}{} {}", result.empty() ? "" : " and ", high_allowed ? "<=" : "<",
                          shortest(high));
  return result;
}

void Schema::section(const std::string& name, const std::string& text)
{
  section_ = name;
  sections_.emplace_back(name, text);
}

void Schema::declare(const std::string& key, const std::string& initial, const std::string& text,
                     const std::string& range, const Check& check, const Action& action)
{
  keys_.push_back({section_, key, initial, text, range});
  checks_[path_of(section_, key)] = check;
  if (!section_.empty())
    handler_.enter_subsection(section_);
  handler_.declare_entry(key, initial, CheckedText(check, range), text);
  handler_.add_action(key, action); // is called at once with the default
  if (!section_.empty())
    handler_.leave_subsection();
}

/// Units that convert, but to something else than is meant.
void Schema::refuse_odd_unit(const std::string& text, const std::string& unit) const
{
  const std::string typed = unit_part(text);
  if (unit == "1" && !typed.empty() && typed != "%")
    throw std::invalid_argument(fmt::format("a plain number is expected, without '{}'", typed));
  if (unit == "K" && !typed.empty() && units_.convert(0, typed, unit) != 0)
    throw std::invalid_argument(fmt::format("a difference of temperatures is expected, '{}' is a "
                                            "temperature: write K",
                                            trimmed(text)));
}

double Schema::checked(const std::string& text, const std::string& unit, const Bounds& bounds,
                       const std::string& si_unit) const
{
  refuse_odd_unit(text, unit);
  const double value = units_.parse(text, unit, unit);
  if (!bounds.contain(value))
    throw std::invalid_argument(fmt::format("'{}' is out of range, allowed: {}{}", trimmed(text),
                                            bounds.text(), unit == "1" ? "" : " " + unit));
  return units_.convert(value, unit, si_unit);
}

/// A key whose text is turned into a value by a function that throws if it cannot.
template <typename Value, typename Parse>
void Schema::declare_parsed(const std::string& key, Value& target, const std::string& initial,
                            const std::string& text, const std::string& range, const Parse& parse)
{
  declare(
      key, initial, text, range,
      [parse](const std::string& typed) -> std::string {
        try {
          parse(typed);
        } catch (const std::invalid_argument& error) {
          return error.what();
        }
        return {};
      },
      [parse, &target](const std::string& typed) { target = parse(typed); });
}

void Schema::optional_quantity(const std::string& key, std::optional<double>& target,
                               const std::string& absent, const std::string& unit,
                               const std::string& initial, const Bounds& bounds,
                               const std::string& text)
{
  const std::string si = si_unit_of(unit);
  if (unit != "1")
    default_units_[path_of(section_, key)] = unit;
  declare_parsed(key, target, initial, text, range_text(unit, bounds) + ", or '" + absent + "'",
                 [=, this](const std::string& typed) -> std::optional<double> {
                   if (typed == absent)
                     return std::nullopt;
                   return checked(typed, unit, bounds, si);
                 });
}

void Schema::quantity(const std::string& key, double& target, const std::string& unit,
                      const std::string& initial, const Bounds& bounds, const std::string& text)
{
  const std::string si = si_unit_of(unit);
  if (unit != "1")
    default_units_[path_of(section_, key)] = unit;
  declare_parsed(key, target, initial, text, range_text(unit, bounds),
                 [=, this](const std::string& typed) { return checked(typed, unit, bounds, si); });
}

void Schema::optional_quantities(const std::string& key, std::vector<std::optional<double>>& target,
                                 const std::string& absent, const std::string& unit,
                                 const std::string& initial, const Bounds& bounds,
                                 const std::string& text)
{
  const std::string si = si_unit_of(unit);
  default_units_[path_of(section_, key)] = unit;
  declare_parsed(key, target, initial, text,
                 "list, each " + range_text(unit, bounds) + ", or '" + absent + "'",
                 [=, this](const std::string& typed) {
                   std::vector<std::optional<double>> result;
                   for (const std::string& part : split(typed, ','))
                     if (part == absent)
                       result.emplace_back();
                     else
                       result.emplace_back(checked(part, unit, bounds, si));
                   return result;
                 });
}

void Schema::quantities(const std::string& key, std::vector<double>& target,
                        const std::string& unit, const std::string& initial, const Bounds& bounds,
                        const std::string& text)
{
  const std::string si = si_unit_of(unit);
  if (unit != "1")
    default_units_[path_of(section_, key)] = unit;
  declare_parsed(key, target, initial, text,
                 "list, each " + range_text(unit, bounds) + "; or 'none'",
                 [=, this](const std::string& typed) {
                   std::vector<double> result;
                   for (const std::string& part : split(typed, ','))
                     if (part != "none")
                       result.push_back(checked(part, unit, bounds, si));
                   return result;
                 });
}

void Schema::pairs(const std::string& key, std::vector<std::pair<double, double>>& target,
                   const std::string& first_unit, const std::string& second_unit,
                   const std::string& initial, const std::string& text)
{
  if (first_unit != "1" || second_unit != "1")
    default_units_[path_of(section_, key)] = first_unit + " and " + second_unit;
  declare_parsed(
      key, target, initial, text,
      fmt::format("list of pairs 'a: b', {} and {}", range_text(first_unit, any()),
                  range_text(second_unit, any())),
      [=, this](const std::string& typed) {
        std::vector<std::pair<double, double>> result;
        for (const std::string& part : split(typed, ',')) {
          const std::vector<std::string> two = split(part, ':');
          if (two.size() != 2)
            throw std::invalid_argument(fmt::format("'{}' is not of the form 'a: b'", part));
          const double first = checked(two[0], first_unit, any(), si_unit_of(first_unit));
          const double second = checked(two[1], second_unit, any(), si_unit_of(second_unit));
          result.emplace_back(first, second);
        }
        return result;
      });
}

void Schema::number(const std::string& key, double& target, const std::string& initial,
                    const Bounds& bounds, const std::string& text)
{
  quantity(key, target, "1", initial, bounds, text);
}

void Schema::integer(const std::string& key, long& target, const std::string& initial,
                     const Bounds& bounds, const std::string& text)
{
  declare_parsed(key, target, initial, text,
                 "a whole number" + (bounds.text().empty() ? "" : ", " + bounds.text()),
                 [=, this](const std::string& typed) {
                   const double read = checked(typed, "1", bounds, "1");
                   if (read != std::floor(read) || std::abs(read) > 9e15)
                     throw std::invalid_argument(fmt::format("'{}' is not a whole number", typed));
                   return long(read);
                 });
}

void Schema::flag(const std::string& key, bool& target, const std::string& initial,
                  const std::string& text)
{
  choice<bool>(key, target, {{"true", true}, {"false", false}}, initial, text);
}

void Schema::words(const std::string& key, std::string& target, const std::string& initial,
                   const std::string& text)
{
  declare(
      key, initial, text, "text", [](const std::string&) { return std::string(); },
      [&target](const std::string& typed) { target = typed; });
}

void Schema::declare_choice(const std::string& key, const std::vector<std::string>& names,
                            const std::string& initial, const std::string& text,
                            const std::function<void(std::size_t)>& select)
{
  std::string all;
  for (const std::string& name : names)
    all += (all.empty() ? "" : " | ") + name;
  const auto index = [names](const std::string& typed) {
    return std::size_t(std::find(names.begin(), names.end(), typed) - names.begin());
  };
  declare(
      key, initial, text, all,
      [names, all, index](const std::string& typed) -> std::string {
        if (index(typed) < names.size())
          return {};
        const std::string close = nearest(typed, names);
        return fmt::format("'{}' is not one of: {}{}", typed, all,
                           close.empty() ? "" : fmt::format("; did you mean '{}'?", close));
      },
      [index, select](const std::string& typed) { select(index(typed)); });
}

std::string Schema::unknown_section(const std::string& section) const
{
  std::vector<std::string> names;
  for (const auto& known : sections_)
    names.push_back(known.first);
  if (std::find(names.begin(), names.end(), section) != names.end())
    return {};
  names.erase(names.begin()); // the top level
  return fmt::format("there is no section '{}'; {}", section,
                     suggestion(nearest(section, names), "sections are: ", names));
}

std::string Schema::unknown_key(const SceneEntry& entry) const
{
  const std::string section = entry.section();
  std::vector<std::string> here, elsewhere;
  for (const Key& key : keys_) {
    if (key.section == section)
      here.push_back(key.name);
    if (key.name == entry.key)
      elsewhere.push_back(path_of(key.section, key.name));
  }
  const std::string close = elsewhere.empty() ? nearest(entry.key, here) : elsewhere.front();
  if (section.empty())
    return fmt::format("there is no key '{}'; {}", entry.key,
                       suggestion(close, "keys outside of sections are: ", here));
  return fmt::format("there is no key '{}' in section '{}'; {}", entry.key, section,
                     suggestion(close, "its keys are: ", here));
}

std::vector<Diagnostic> Schema::apply(const std::vector<SceneEntry>& entries)
{
  std::vector<Diagnostic> diagnostics;
  std::set<std::string> unknown_sections;
  const auto file_of = [](const std::string& place) { return place.substr(0, place.rfind(':')); };
  for (const SceneEntry& entry : entries) {
    const auto tell = [&](Diagnostic::Kind kind, const std::string& message) {
      diagnostics.push_back({kind, entry.place, message});
    };
    const std::string path = entry.path();
    if (const std::string problem = unknown_section(entry.section()); !problem.empty()) {
      if (unknown_sections.insert(entry.section()).second) // not again for each key in it
        tell(Diagnostic::Kind::error, problem);
      continue;
    }
    const auto check = checks_.find(path);
    if (check == checks_.end()) {
      tell(Diagnostic::Kind::error, unknown_key(entry));
      continue;
    }
    const auto before = set_keys_.find(path);
    if (before != set_keys_.end() && entry.place != "--set" &&
        file_of(before->second) == file_of(entry.place))
      tell(Diagnostic::Kind::error,
           fmt::format("'{}' is set twice, first at {}", entry.key, before->second));
    if (const std::string problem = check->second(entry.value); !problem.empty()) {
      const auto key = std::find_if(keys_.begin(), keys_.end(), [&](const Key& k) {
        return path_of(k.section, k.name) == path;
      });
      const bool says_range = problem.find("allowed") != std::string::npos ||
                              problem.find("not one of") != std::string::npos;
      tell(Diagnostic::Kind::error,
           fmt::format("{} = {}: {}{}", entry.key, entry.value, problem,
                       says_range ? "" : fmt::format("; expected: {}", key->range)));
      continue;
    }
    if (const auto unit = default_units_.find(path);
        unit != default_units_.end() && has_bare_number(entry.value))
      tell(Diagnostic::Kind::note, fmt::format("{} = {}: no unit given, taken as {}", entry.key,
                                               entry.value, unit->second));
    for (const std::string& section : entry.sections)
      handler_.enter_subsection(section);
    handler_.set(entry.key, entry.value);
    for (std::size_t k = 0; k < entry.sections.size(); ++k)
      handler_.leave_subsection();
    set_keys_[path] = entry.place;
  }
  return diagnostics;
}

bool Schema::is_default(const std::string& path) const
{
  const auto key = std::find_if(keys_.begin(), keys_.end(),
                                [&](const Key& k) { return path_of(k.section, k.name) == path; });
  std::vector<std::string> sections;
  if (!key->section.empty())
    sections.push_back(key->section);
  return handler_.get(sections, key->name) == key->initial;
}

} // namespace apps
