#pragma once
#include <memory>
#include <string>
#include <string_view>

struct ut_system;

namespace apps {

/// The units of UDUNITS-2: "kPa", "N s/m", "degC", "1/s"; and "deg" for degrees of angle.
class Units {
public:
  Units();
  ~Units();
  Units(const Units&) = delete;

  /// Whether a text is a unit.
  bool knows(const std::string& unit) const;

  /// A number in one unit, in another. Temperatures convert with their offset; a reciprocal (s for
  /// Hz) is another dimension.
  /// \throws std::invalid_argument if a unit is unknown or the dimensions differ
  double convert(double value, const std::string& from, const std::string& to) const;

  /// A quantity as text ("400 kPa"; a bare number is in `default_unit`), in `unit`.
  /// "inf" and "nan" are not numbers here.
  /// \throws std::invalid_argument saying what is wrong with the text
  double parse(std::string_view text, const std::string& unit,
               const std::string& default_unit) const;

private:
  struct Free {
    void operator()(ut_system* system) const;
  };
  std::unique_ptr<ut_system, Free> system_;
};

/// What follows the number in a quantity: "kPa" of "400 kPa", nothing of "400".
/// \throws std::invalid_argument if the text does not begin with a number
std::string unit_part(std::string_view text);

/// True if the text is a number without a unit.
bool is_bare_number(std::string_view text);

/// A number with as few digits as give it back exactly.
std::string shortest(double value);

} // namespace apps
