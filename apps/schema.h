#pragma once
#include "apps/quantity.h"
#include "apps/scene_text.h"

#include <deal.II/base/parameter_handler.h>

#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace apps {

/// Allowed values of a number, in the unit of its key.
struct Bounds {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_allowed = true, high_allowed = true;

  bool contain(double value) const;
  std::string text() const; ///< "> 0", "0 to 1"; empty if all values are allowed
};

inline Bounds above(double low)
{
  return {low, std::numeric_limits<double>::infinity(), false, true};
}
inline Bounds at_least(double low)
{
  return {low};
}
inline Bounds between(double low, double high)
{
  return {low, high};
}
inline Bounds any()
{
  return {};
}

/// The keys of a scene: each declaration binds name, variable, unit, default, range and text.
///
/// Declarations go to a deal.II ParameterHandler, which checks and stores values and prints
/// templates. `apply` sets the bound variables from a scene text and reports everything that is
/// wrong at once.
class Schema {
public:
  explicit Schema(const Units& units) : units_(units) {}
  Schema(const Schema&) = delete;

  /// Keys that follow belong to this section; "" is the top level.
  void section(const std::string& name, const std::string& text);

  /// A quantity; the default is a text with a unit.
  void quantity(const std::string& key, double& target, const std::string& unit,
                const std::string& initial, const Bounds& bounds, const std::string& text);

  /// A quantity or the word `absent`.
  void optional_quantity(const std::string& key, std::optional<double>& target,
                         const std::string& absent, const std::string& unit,
                         const std::string& initial, const Bounds& bounds, const std::string& text);

  /// Quantities separated by commas; may be empty.
  void quantities(const std::string& key, std::vector<double>& target, const std::string& unit,
                  const std::string& initial, const Bounds& bounds, const std::string& text);

  /// Quantities, or the word `absent`, separated by commas; may be empty.
  void optional_quantities(const std::string& key, std::vector<std::optional<double>>& target,
                           const std::string& absent, const std::string& unit,
                           const std::string& initial, const Bounds& bounds,
                           const std::string& text);

  /// Pairs "a: b" separated by commas.
  void pairs(const std::string& key, std::vector<std::pair<double, double>>& target,
             const std::string& first_unit, const std::string& second_unit,
             const std::string& initial, const std::string& text);

  void number(const std::string& key, double& target, const std::string& initial,
              const Bounds& bounds, const std::string& text);
  void integer(const std::string& key, long& target, const std::string& initial,
               const Bounds& bounds, const std::string& text);
  void flag(const std::string& key, bool& target, const std::string& initial,
            const std::string& text);
  void words(const std::string& key, std::string& target, const std::string& initial,
             const std::string& text);

  template <typename Choice>
  void choice(const std::string& key, Choice& target,
              const std::vector<std::pair<std::string, Choice>>& options,
              const std::string& initial, const std::string& text)
  {
    std::vector<std::string> names;
    for (const auto& option : options)
      names.push_back(option.first);
    declare_choice(key, names, initial, text,
                   [&target, options](std::size_t k) { target = options[k].second; });
  }

  /// Sets variables in the order of the entries; later ones win, but twice in one file is an error.
  /// \return everything wrong, and notes about bare numbers
  std::vector<Diagnostic> apply(const std::vector<SceneEntry>& entries);

  /// Keys that were set, with the place of the last setting.
  const std::map<std::string, std::string>& set_keys() const { return set_keys_; }

  /// Whether a key has its default, typed or not.
  bool is_default(const std::string& path) const;

  /// The scene with all keys and their present values, as a scene file. With `comments`: what each
  /// key means, its unit, range and default.
  std::string print(bool comments) const;

  /// All keys with default, allowed values and meaning: a Markdown table for each section.
  std::string reference() const;

private:
  struct Key {
    std::string section, name;
    std::string initial, text, range;
  };

  using Check = std::function<std::string(const std::string&)>;
  using Action = std::function<void(const std::string&)>;

  void declare(const std::string& key, const std::string& initial, const std::string& text,
               const std::string& range, const Check& check, const Action& action);
  template <typename Value, typename Parse>
  void declare_parsed(const std::string& key, Value& target, const std::string& initial,
                      const std::string& text, const std::string& range, const Parse& parse);
  void declare_choice(const std::string& key, const std::vector<std::string>& names,
                      const std::string& initial, const std::string& text,
                      const std::function<void(std::size_t)>& select);
  double checked(const std::string& text, const std::string& unit, const Bounds& bounds,
                 const std::string& si_unit) const;
  void refuse_odd_unit(const std::string& text, const std::string& unit) const;
  std::string unknown_section(const std::string& section) const;
  std::string unknown_key(const SceneEntry& entry) const;

  const Units& units_;
  dealii::ParameterHandler handler_;
  std::string section_;
  std::vector<std::pair<std::string, std::string>> sections_; ///< name and text, in order
  std::vector<Key> keys_;
  std::map<std::string, Check> checks_;              ///< by path
  std::map<std::string, std::string> default_units_; ///< of bare numbers, by path
  std::map<std::string, std::string> set_keys_;
};

} // namespace apps
